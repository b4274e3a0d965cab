// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/radar/dbscan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <vector>

#include "daemon/common/base/random.h"

namespace v2vouch {
namespace {

Reflection At(double x_m, double y_m, double rate_mps = 5.0, bool is_standing = false) {
  return {.range_m = std::hypot(x_m, y_m),
          .azimuth_rad = std::atan2(y_m, x_m),
          .x_m = x_m,
          .y_m = y_m,
          .ground_rate_mps = rate_mps,
          .is_standing = is_standing};
}

using Clusters = std::set<std::set<int>>;

Clusters ClustersOf(const std::vector<Reflection>& reflections,
                    const Neighbourhood& neighbourhood) {
  std::vector<int> members(reflections.size());
  std::iota(members.begin(), members.end(), 0);
  Dbscan dbscan;
  const auto ends = dbscan.Run(reflections, neighbourhood, members);
  Clusters clusters;
  std::size_t from = 0;
  for (const std::size_t to : ends) {
    EXPECT_TRUE(std::is_sorted(members.begin() + static_cast<std::ptrdiff_t>(from),
                               members.begin() + static_cast<std::ptrdiff_t>(to)));
    clusters.insert({members.begin() + static_cast<std::ptrdiff_t>(from),
                     members.begin() + static_cast<std::ptrdiff_t>(to)});
    from = to;
  }
  return clusters;
}

const Neighbourhood kPlain = {.eps_m = 1.0, .eps_per_m = 0.0, .eps_speed_mps = 1.0};

TEST(Dbscan, ChainsNeighboursAndKeepsStrangersApart) {
  EXPECT_EQ(ClustersOf({At(10.0, 0), At(10.9, 0), At(11.8, 0), At(13.0, 0)}, kPlain),
            (Clusters{{0, 1, 2}, {3}}));
  EXPECT_TRUE(ClustersOf({}, kPlain).empty());
}

TEST(Dbscan, DopplerSeparatesWhatDistanceDoesNot) {
  EXPECT_EQ(ClustersOf({At(10.0, 0, 5.0), At(10.1, 0, 7.0)}, kPlain), (Clusters{{0}, {1}}));
  // Distance and Doppler add up: 0.8 and 0.8 of a radius make 1.13.
  EXPECT_EQ(ClustersOf({At(10.0, 0, 5.0), At(10.8, 0, 5.8)}, kPlain), (Clusters{{0}, {1}}));
  EXPECT_EQ(ClustersOf({At(10.0, 0, 5.0), At(10.6, 0, 5.6)}, kPlain), (Clusters{{0, 1}}));
}

TEST(Dbscan, StandingAndMovingNeverMix) {
  EXPECT_EQ(ClustersOf({At(10.0, 0, 0.5, true), At(10.1, 0, 0.7, false)}, kPlain),
            (Clusters{{0}, {1}}));
}

TEST(Dbscan, RadiusGrowsWithRange) {
  Neighbourhood growing = kPlain;
  growing.eps_per_m = 0.02;  // 1.2 m at 10 m, 3 m at 100 m.
  EXPECT_EQ(ClustersOf({At(10.0, 0), At(12.0, 0), At(100.0, 0), At(102.0, 0)}, growing),
            (Clusters{{0}, {1}, {2, 3}}));
}

TEST(Dbscan, ThinPointsAreNoiseAndBorderPointsJoinTheNearestCore) {
  Neighbourhood dense = kPlain;
  dense.min_points = 4;
  // Two groups of four with a border point between, nearer to the second; a loner at the end.
  const std::vector<Reflection> reflections = {At(10.0, 0),  At(10.1, 0), At(10.2, 0), At(10.4, 0),
                                               At(11.35, 0), At(12.2, 0), At(12.4, 0), At(12.5, 0),
                                               At(12.6, 0),  At(20.0, 0)};
  EXPECT_EQ(ClustersOf(reflections, dense), (Clusters{{0, 1, 2, 3}, {4, 5, 6, 7, 8}}));
}

// The definition, literally: clusters are the connected parts of the core points' neighbour graph.
Clusters Reference(const std::vector<Reflection>& r, const Neighbourhood& n) {
  const int count = static_cast<int>(r.size());
  const auto distance2 = [&](int i, int j) {
    const Reflection& a = r[static_cast<std::size_t>(i)];
    const Reflection& b = r[static_cast<std::size_t>(j)];
    if (a.is_standing != b.is_standing) return 1e9;
    const double radius = n.scale * (n.eps_m + n.eps_per_m * 0.5 * (a.range_m + b.range_m));
    return std::pow(std::hypot(a.x_m - b.x_m, a.y_m - b.y_m) / radius, 2) +
           std::pow((a.ground_rate_mps - b.ground_rate_mps) / n.eps_speed_mps, 2);
  };
  std::vector<int> cores;
  for (int i = 0; i < count; ++i) {
    int neighbours = 0;
    for (int j = 0; j < count; ++j) neighbours += distance2(i, j) <= 1.0 ? 1 : 0;
    if (neighbours >= n.min_points) cores.push_back(i);
  }
  Clusters clusters;
  std::set<int> left(cores.begin(), cores.end());
  std::vector<std::set<int>> groups;
  while (!left.empty()) {
    std::vector<int> open = {*left.begin()};
    left.erase(left.begin());
    std::set<int> group;
    while (!open.empty()) {
      const int i = open.back();
      open.pop_back();
      group.insert(i);
      for (auto it = left.begin(); it != left.end();) {
        if (distance2(i, *it) <= 1.0) {
          open.push_back(*it);
          it = left.erase(it);
        } else {
          ++it;
        }
      }
    }
    groups.push_back(group);
  }
  const std::set<int> all_cores(cores.begin(), cores.end());
  for (int i = 0; i < count; ++i) {
    if (all_cores.contains(i)) continue;
    double best = 1.0;
    int nearest = -1;
    for (const int core : cores) {
      if (distance2(i, core) < best || (nearest < 0 && distance2(i, core) <= 1.0)) {
        best = distance2(i, core);
        nearest = core;
      }
    }
    for (auto& group : groups) {
      if (nearest >= 0 && group.contains(nearest)) group.insert(i);
    }
  }
  return {groups.begin(), groups.end()};
}

TEST(DbscanProperty, AgreesWithItsDefinition) {
  Random random(11);
  std::size_t clusters = 0;
  for (int trial = 0; trial < 400; ++trial) {
    std::vector<Reflection> reflections;
    const int count = static_cast<int>(random.Uniform(0.0, 60.0));
    for (int i = 0; i < count; ++i) {
      reflections.push_back(At(random.Uniform(1.0, 25.0), random.Uniform(-8.0, 8.0),
                               random.Uniform(-2.0, 2.0), random.Bernoulli(0.3)));
    }
    std::sort(reflections.begin(), reflections.end(),
              [](const auto& a, const auto& b) { return a.range_m < b.range_m; });
    Neighbourhood n = {.eps_m = 1.5, .eps_per_m = 0.02, .eps_speed_mps = 1.5};
    n.min_points = 1 + trial % 4;
    n.scale = trial % 3 == 0 ? 0.6 : 1.0;
    const Clusters expected = Reference(reflections, n);
    ASSERT_EQ(ClustersOf(reflections, n), expected) << "trial " << trial;
    clusters += expected.size();
  }
  EXPECT_GT(clusters, 2000U);
}

}  // namespace
}  // namespace v2vouch
