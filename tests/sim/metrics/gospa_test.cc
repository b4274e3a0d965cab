// SPDX-License-Identifier: Apache-2.0
#include "sim/metrics/gospa.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "daemon/common/base/random.h"
#include "tests/sim/metrics/vectors.h"

namespace v2vouch::evaluation {
namespace {

constexpr double kTolerance = 1e-9;  // As the vectors' own description states.

class ReferenceVectors : public testing::Test {
 protected:
  void SetUp() override {
    vectors_ = LoadVectors();
    if (!vectors_) GTEST_SKIP() << "SKIPPED: gospa_vectors.json is not there (V2VOUCH_DATA)";
  }
  std::optional<nlohmann::json> vectors_;
};

using GospaVectors = ReferenceVectors;

TEST_F(GospaVectors, EveryCaseAgreesInTotalPartsCountsAndAssignment) {
  const auto& cases = vectors_->at("gospa");
  ASSERT_EQ(cases.size(), 504u);
  for (const auto& item : cases) {
    SCOPED_TRACE("case " + item.at("id").dump());
    const double p = item.at("p").get<double>();
    Gospa gospa({.cutoff_m = item.at("c").get<double>(), .order = p});
    const auto& result =
        gospa.FromPoints(PointsFrom(item.at("truths")), PointsFrom(item.at("tracks")));
    EXPECT_LT(RelativeError(result.gospa, item.at("gospa").get<double>()), kTolerance);
    for (const auto& [power, name] :
         {std::pair{result.localisation_pow, "localisation"},
          std::pair{result.missed_pow, "missed"}, std::pair{result.false_pow, "false"}}) {
      const std::string key(name);
      EXPECT_LT(RelativeError(power, item.at(key + "_pow").get<double>()), kTolerance) << key;
      EXPECT_LT(RelativeError(Root(power, p), item.at(key + "_root").get<double>()), kTolerance);
    }
    EXPECT_EQ(result.num_missed, item.at("num_missed").get<int>());
    EXPECT_EQ(result.num_false, item.at("num_false").get<int>());
    EXPECT_EQ(result.num_assigned, item.at("num_assigned").get<int>());
    if (item.at("assignment_unique").get<bool>()) {
      EXPECT_EQ(result.assignment, item.at("assignment").get<std::vector<int>>());
    }
  }
}

TEST_F(GospaVectors, EveryCaseWithAlphaOneAgreesInTotal) {
  const auto& cases = vectors_->at("gospa_alpha1");
  ASSERT_EQ(cases.size(), 60u);
  for (const auto& item : cases) {
    Gospa gospa({.cutoff_m = item.at("c").get<double>(),
                 .order = item.at("p").get<double>(),
                 .alpha = item.at("alpha").get<double>()});
    const auto& result =
        gospa.FromPoints(PointsFrom(item.at("truths")), PointsFrom(item.at("tracks")));
    EXPECT_LT(RelativeError(result.gospa, item.at("gospa").get<double>()), kTolerance)
        << "case " << item.at("id");
  }
}

TEST_F(GospaVectors, EverySequenceAgreesInSwitchesPenaltyAndTotal) {
  const auto& cases = vectors_->at("switching_sequences");
  ASSERT_EQ(cases.size(), 50u);
  for (const auto& item : cases) {
    const double p = item.at("p").get<double>();
    const double penalty = item.at("switching_penalty").get<double>();
    Gospa gospa({.cutoff_m = item.at("c").get<double>(), .order = p});
    SwitchCounter counter;
    for (const auto& step : item.at("steps")) {
      SCOPED_TRACE("case " + item.at("id").dump() + " step " + step.at("t").dump());
      std::vector<Eigen::Vector2d> truths, tracks;
      for (const auto& truth : step.at("truths")) truths.push_back(PointFrom(truth.at("pos")));
      for (const auto& track : step.at("tracks")) tracks.push_back(PointFrom(track.at("pos")));
      const auto& result = gospa.FromPoints(truths, tracks);
      EXPECT_LT(RelativeError(result.gospa, step.at("gospa").get<double>()), kTolerance);

      std::vector<SwitchCounter::Held> held;
      for (std::size_t i = 0; i < truths.size(); ++i) {
        const int j = result.assignment[i];
        const auto track =
            j < 0 ? SwitchCounter::kNoTrack
                  : step.at("tracks").at(static_cast<std::size_t>(j)).at("id").get<std::int64_t>();
        held.push_back({step.at("truths").at(i).at("id").get<std::int64_t>(), track});
      }
      const double switches = counter.Step(held);
      EXPECT_DOUBLE_EQ(switches, step.at("num_switches").get<double>());
      const double switching_pow = std::pow(penalty, p) * switches;
      EXPECT_LT(RelativeError(Root(switching_pow, p), step.at("switching").get<double>()),
                kTolerance);
      EXPECT_LT(
          RelativeError(Root(result.power + switching_pow, p), step.at("sgospa").get<double>()),
          kTolerance);
    }
  }
}

// The paper's table decodes with c = 30 and p = 2: notes in the paper's own units.
TEST(Gospa, ThePapersMissedAndFalseErrorsAreRootsOfWholeCounts) {
  Gospa gospa({.cutoff_m = 30.0});
  const Eigen::Vector2d far(1000.0, 0.0);
  const std::vector<Eigen::Vector2d> two = {{0.0, 0.0}, {100.0, 0.0}};
  const std::vector<Eigen::Vector2d> five(5, far);
  const auto& local = gospa.FromPoints(two, five);
  EXPECT_NEAR(local.gospa, 56.12, 0.005);
  EXPECT_NEAR(Root(local.missed_pow, 2.0), 30.0, 1e-9);
  EXPECT_NEAR(Root(local.false_pow, 2.0), 47.43, 0.005);
}

std::vector<Eigen::Vector2d> RandomSet(Random& random, int at_most) {
  std::vector<Eigen::Vector2d> points;
  const auto count = static_cast<int>(random.Bits() % static_cast<std::uint64_t>(at_most + 1));
  for (int k = 0; k < count; ++k) {
    points.emplace_back(random.Uniform(-20.0, 20.0), random.Uniform(-20.0, 20.0));
  }
  return points;
}

TEST(GospaProperty, IsAMetric) {
  Random random(20240611);
  for (int trial = 0; trial < 3000; ++trial) {
    Gospa gospa({.cutoff_m = random.Uniform(1.0, 30.0),
                 .order = trial % 2 == 0 ? 2.0 : 1.0,
                 .alpha = trial % 3 == 0 ? 1.0 : 2.0});
    const auto x = RandomSet(random, 6);
    const auto y = RandomSet(random, 6);
    const auto z = RandomSet(random, 6);
    const double xy = gospa.FromPoints(x, y).gospa;
    const double yx = gospa.FromPoints(y, x).gospa;
    const double yz = gospa.FromPoints(y, z).gospa;
    const double xz = gospa.FromPoints(x, z).gospa;
    EXPECT_GE(xy, 0.0);
    EXPECT_NEAR(gospa.FromPoints(x, x).gospa, 0.0, 1e-12);
    EXPECT_NEAR(xy, yx, 1e-9) << "symmetry, trial " << trial;
    EXPECT_LE(xz, xy + yz + 1e-9) << "triangle inequality, trial " << trial;
    if (x.size() != y.size()) {
      EXPECT_GT(xy, 0.0);
    }
  }
}

TEST(GospaProperty, OrderOfTheSetsDoesNotMatterAndPartsAddUp) {
  Random random(7);
  for (int trial = 0; trial < 500; ++trial) {
    Gospa gospa({.cutoff_m = 10.0});
    auto truths = RandomSet(random, 7);
    auto tracks = RandomSet(random, 7);
    const GospaResult before = gospa.FromPoints(truths, tracks);
    EXPECT_NEAR(before.power, before.localisation_pow + before.missed_pow + before.false_pow, 1e-9);
    EXPECT_EQ(before.num_assigned + before.num_missed, static_cast<int>(truths.size()));
    EXPECT_EQ(before.num_assigned + before.num_false, static_cast<int>(tracks.size()));
    std::reverse(truths.begin(), truths.end());
    std::rotate(tracks.begin(), tracks.begin() + (tracks.empty() ? 0 : 1), tracks.end());
    EXPECT_NEAR(gospa.FromPoints(truths, tracks).gospa, before.gospa, 1e-9);
  }
}

TEST(SwitchCounter, CountsHalvesForLossAndReturnAndWholeForAnotherTrack) {
  SwitchCounter counter;
  const auto step = [&](std::int64_t track) {
    const SwitchCounter::Held held{1, track};
    return counter.Step({&held, 1});
  };
  EXPECT_EQ(step(SwitchCounter::kNoTrack), 0.0);
  EXPECT_EQ(step(10), 0.0);  // The first track ever.
  EXPECT_EQ(step(10), 0.0);
  EXPECT_EQ(step(SwitchCounter::kNoTrack), 0.5);
  EXPECT_EQ(step(10), 0.5);
  EXPECT_EQ(step(11), 1.0);
}

}  // namespace
}  // namespace v2vouch::evaluation
