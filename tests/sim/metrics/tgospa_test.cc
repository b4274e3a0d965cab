// SPDX-License-Identifier: Apache-2.0
#include "sim/metrics/tgospa.h"

#include <gtest/gtest.h>

#include <cmath>

#include "daemon/common/base/random.h"
#include "sim/metrics/gospa.h"
#include "tests/sim/metrics/vectors.h"

namespace v2vouch::evaluation {
namespace {

std::vector<Trajectory> TrajectoriesFrom(const nlohmann::json& list, std::size_t steps) {
  std::vector<Trajectory> out;
  for (const auto& item : list) {
    Trajectory trajectory(steps, Absent());
    std::size_t t = item.at("start").get<std::size_t>();
    for (const auto& xy : item.at("points")) trajectory.at(t++) = PointFrom(xy);
    out.push_back(std::move(trajectory));
  }
  return out;
}

TEST(TrajectoryGospaVectors, EverySequenceAgrees) {
  const auto vectors = LoadVectors();
  if (!vectors) GTEST_SKIP() << "SKIPPED: gospa_vectors.json is not there (V2VOUCH_DATA)";
  const auto& cases = vectors->at("tgospa");
  ASSERT_EQ(cases.size(), 60u);
  double beam_excess = 0.0;
  for (const auto& item : cases) {
    SCOPED_TRACE("case " + item.at("id").dump());
    const auto steps = item.at("T").get<std::size_t>();
    const auto truths = TrajectoriesFrom(item.at("truths"), steps);
    const auto tracks = TrajectoriesFrom(item.at("tracks"), steps);
    TrajectoryGospaParameters parameters{.cutoff_m = item.at("c").get<double>(),
                                         .order = item.at("p").get<double>(),
                                         .switch_m = item.at("gamma").get<double>(),
                                         .base = BaseDistance::kOrderNorm};
    const auto result = TrajectoryGospa(truths, tracks, parameters);
    EXPECT_TRUE(result.is_exact);
    // Two linear-programming solvers stand behind these figures: 1e-6 relative.
    EXPECT_LT(RelativeError(result.tgospa, item.at("tgospa").get<double>()), 1e-6);
    EXPECT_LT(RelativeError(result.localisation_pow, item.at("localisation_pow").get<double>()),
              1e-6);
    EXPECT_LT(RelativeError(result.missed_pow, item.at("missed_pow").get<double>()), 1e-6);
    EXPECT_LT(RelativeError(result.false_pow, item.at("false_pow").get<double>()), 1e-6);
    EXPECT_LT(RelativeError(result.switch_pow, item.at("switch_pow").get<double>()), 1e-6);

    parameters.exact_states = 0;  // The same cases through the beam: never below, and close.
    const auto beam = TrajectoryGospa(truths, tracks, parameters);
    EXPECT_GE(beam.power, result.power - 1e-9);
    beam_excess = std::max(beam_excess, beam.tgospa / std::max(result.tgospa, 1e-9) - 1.0);
  }
  EXPECT_LT(beam_excess, 0.02);
}

TEST(TrajectoryGospaProperty, IsAMetricOnRandomTrajectories) {
  Random random(11);
  const auto random_set = [&] {
    std::vector<Trajectory> set(random.Bits() % 4);
    for (auto& trajectory : set) {
      Eigen::Vector2d p(random.Uniform(-8.0, 8.0), random.Uniform(-8.0, 8.0));
      for (int t = 0; t < 6; ++t) {
        trajectory.push_back(p);
        p += Eigen::Vector2d(random.Uniform(-2.0, 2.0), random.Uniform(-2.0, 2.0));
      }
    }
    return set;
  };
  for (int trial = 0; trial < 300; ++trial) {
    const TrajectoryGospaParameters parameters{
        .cutoff_m = 6.0, .order = trial % 2 == 0 ? 2.0 : 1.0, .switch_m = 2.0};
    const auto x = random_set();
    const auto y = random_set();
    const auto z = random_set();
    const double xy = TrajectoryGospa(x, y, parameters).tgospa;
    EXPECT_NEAR(TrajectoryGospa(x, x, parameters).tgospa, 0.0, 1e-9);
    EXPECT_NEAR(TrajectoryGospa(y, x, parameters).tgospa, xy, 1e-9);
    EXPECT_LE(TrajectoryGospa(x, z, parameters).tgospa,
              xy + TrajectoryGospa(y, z, parameters).tgospa + 1e-9);
  }
}

TEST(TrajectoryGospa, AFreeSwitchGivesTheSumOfGospas) {
  Random random(3);
  std::vector<Trajectory> truths(3), tracks(3);
  for (auto* set : {&truths, &tracks}) {
    for (auto& trajectory : *set) {
      for (int t = 0; t < 8; ++t) {
        trajectory.emplace_back(random.Uniform(0.0, 12.0), random.Uniform(0.0, 12.0));
      }
    }
  }
  double sum = 0.0;
  Gospa gospa({.cutoff_m = 5.0});
  for (std::size_t t = 0; t < 8; ++t) {
    const std::vector<Eigen::Vector2d> x = {truths[0][t], truths[1][t], truths[2][t]};
    const std::vector<Eigen::Vector2d> y = {tracks[0][t], tracks[1][t], tracks[2][t]};
    sum += gospa.FromPoints(x, y).power;
  }
  EXPECT_NEAR(TrajectoryGospa(truths, tracks, {.cutoff_m = 5.0, .switch_m = 0.0}).power, sum, 1e-9);
}

}  // namespace
}  // namespace v2vouch::evaluation
