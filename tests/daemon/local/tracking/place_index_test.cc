// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/place_index.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "daemon/common/base/random.h"

namespace v2vouch {
namespace {

TEST(PlaceIndexProperty, FindsAllThatIsNear) {
  Random random(20241122);
  PlaceIndex index;
  for (int trial = 0; trial < 100; ++trial) {
    std::vector<Eigen::Vector2d> points;
    index.Clear();
    const double spread = random.Uniform(1.0, 500.0);
    for (std::size_t i = 0; i < 200; ++i) {
      points.emplace_back(random.Normal(0.0, spread), random.Normal(0.0, 20.0));
      index.Add(points.back(), i);
    }
    index.Sort();
    const Eigen::Vector2d p(random.Normal(0.0, spread), random.Normal(0.0, 20.0));
    const double reach = random.Uniform(0.0, 40.0);
    std::multiset<std::size_t> found;
    index.ForEachNear(p, reach, [&](std::size_t i) { found.insert(i); });
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_LE(found.count(i), 1u);
      const bool is_near = (points[i] - p).lpNorm<Eigen::Infinity>() <= reach;
      EXPECT_GE(found.count(i), is_near ? 1u : 0u);
    }
  }
}

TEST(PlaceIndex, DoesNotTouchWhatIsFar) {
  PlaceIndex index;
  for (std::size_t i = 0; i < 1000; ++i) index.Add({0.0, 20.0 * static_cast<double>(i)}, i);
  index.Sort();
  int visits = 0;
  index.ForEachNear({0.0, 10'000.0}, 30.0, [&](std::size_t) { ++visits; });
  EXPECT_GE(visits, 3);
  EXPECT_LE(visits, 5);
}

TEST(PlaceIndex, AbsurdPlacesAreNeverFoundAndDoNoHarm) {
  PlaceIndex index;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  index.Add({nan, 0.0}, 0);
  index.Add({1e300, 0.0}, 1);
  index.Add({3.0, 4.0}, 2);
  index.Sort();
  std::vector<std::size_t> found;
  const auto visit = [&](std::size_t i) { found.push_back(i); };
  index.ForEachNear({0.0, 0.0}, std::numeric_limits<double>::infinity(), visit);
  EXPECT_EQ(found, std::vector<std::size_t>{2});
  index.ForEachNear({nan, 0.0}, 10.0, visit);
  index.ForEachNear({1e300, 0.0}, 10.0, visit);
  EXPECT_EQ(found.size(), 1u);
}

}  // namespace
}  // namespace v2vouch
