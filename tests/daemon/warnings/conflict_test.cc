// SPDX-License-Identifier: Apache-2.0
#include "daemon/warnings/conflict.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "daemon/common/base/angle.h"

namespace v2vouch::warnings {
namespace {

BodyTarget TargetAt(double x, double y, double yaw, double speed, double sigma = 0.1) {
  BodyTarget target;
  target.mean << x, y, yaw, speed, 0.0, 0.0;
  target.covariance.diagonal() << sigma * sigma, sigma * sigma, 1e-4, sigma * sigma, 1e-6, 1e-4;
  target.size = {2.0, 0.85};
  return target;
}

Conflict Of(double ego_speed, const BodyTarget& target) {
  EgoPlan plan;
  plan.speed_mps = ego_speed;
  return AssessConflict(EgoFan(plan, {0.02, 0.001}, {}, {}), target, {});
}

TEST(NormalDraws, HaveMeanZeroVarianceOneAndNoCorrelation) {
  const auto& draws = NormalDraws();
  ASSERT_EQ(draws.size(), kDrawCount);
  for (std::size_t i = 0; i < kDrawDimensions; ++i) {
    for (std::size_t j = i; j < kDrawDimensions; ++j) {
      double sum = 0.0;
      double mean = 0.0;
      for (const Draw& draw : draws) {
        sum += draw[i] * draw[j];
        mean += draw[i];
      }
      EXPECT_NEAR(mean / kDrawCount, 0.0, 0.02) << i;
      // Quasi-random: far closer than the 1 / sqrt(128) = 0.09 of chance.
      EXPECT_NEAR(sum / kDrawCount, i == j ? 1.0 : 0.0, i == j ? 0.03 : 0.16) << i << " " << j;
    }
  }
}

TEST(InverseNormal, AgreesWithTheErrorFunction) {
  for (const double p : {1e-6, 0.001, 0.02, 0.3, 0.5, 0.8, 0.99, 1.0 - 1e-6}) {
    EXPECT_NEAR(0.5 * std::erfc(-InverseNormal(p) / std::sqrt(2.0)), p, 1e-8);
  }
}

TEST(Touch, AgreesWithSampledPoints) {
  std::mt19937_64 rng(7);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  int touching = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const double angle = 3.0 * u(rng);
    const Box a;
    const Box b{{4.0 * u(rng), 4.0 * u(rng)}, {std::cos(angle), std::sin(angle)}};
    const HalfSize size_a{2.0, 0.8};
    const HalfSize size_b{2.5, 1.0};
    bool has_point = false;  // Of b's area in a.
    for (int i = -50; i <= 50 && !has_point; ++i) {
      for (int k = -50; k <= 50 && !has_point; ++k) {
        const Eigen::Vector2d left(-b.along.y(), b.along.x());
        const Eigen::Vector2d p =
            b.centre + i / 50.0 * size_b.length_m * b.along + k / 50.0 * size_b.width_m * left;
        has_point = std::abs(p.x()) <= size_a.length_m && std::abs(p.y()) <= size_a.width_m;
      }
    }
    touching += has_point;
    if (has_point) {
      EXPECT_TRUE(Touch(a, size_a, b, size_b));
    }
    // The other way round only where the sampling's grid could not have missed it.
    const HalfSize smaller{size_a.length_m - 0.06, size_a.width_m - 0.06};
    if (!has_point) {
      EXPECT_FALSE(Touch(a, smaller, b, size_b)) << b.centre.transpose();
    }
  }
  EXPECT_GT(touching, 100);
}

TEST(Conflict, StandingVehicleAheadIsHitWhenItsRearIsReached) {
  // Bumper at 3.75 m (+0.2 m margin), rear at 48 m: 44.05 m at 10 m/s.
  const Conflict conflict = Of(10.0, TargetAt(50.0, 0.0, 0.0, 0.0));
  EXPECT_EQ(conflict.probability, 1.0);
  EXPECT_NEAR(conflict.median_s, 4.4, 0.1 + 1e-9);
  EXPECT_LE(conflict.early_s, conflict.median_s);
}

TEST(Conflict, VehiclePassedAtOneMetreTwentyIsNoConflict) {
  // Side gap 1.2 m: 0.925 + 1.2 + 0.85.
  EXPECT_LT(Of(10.0, TargetAt(40.0, 2.975, 0.0, 0.0, 0.15)).probability, 0.02);
}

TEST(Conflict, CrossingAtTheSameTimeHasNoGapAndLaterHasTheDifference) {
  // Ego's centre (1.4 m ahead of its origin) is at 30 m after 2.86 s.
  const Conflict together = Of(10.0, TargetAt(30.0, -28.6, kPi / 2, 10.0));
  EXPECT_GT(together.probability, 0.95);
  EXPECT_NEAR(together.post_encroachment_s, 0.0, 1e-9);
  // Three seconds further away: bodies need about 0.65 s to leave each other's place.
  const Conflict later = Of(10.0, TargetAt(30.0, -58.6, kPi / 2, 10.0));
  EXPECT_EQ(later.probability, 0.0);
  EXPECT_GT(later.post_encroachment_s, 2.0);
  EXPECT_LT(later.post_encroachment_s, 3.0);
}

TEST(Conflict, ProbabilityIsThatOfAClosedFormWhereOneExists) {
  // Standing vehicle beside the path: touched where y < 0.925 + 0.2 + 0.85 = 1.975.
  for (const double y : {1.5, 1.975, 2.3, 2.8}) {
    BodyTarget target = TargetAt(30.0, y, 0.0, 0.0);
    target.covariance.diagonal() << 1e-8, 0.25, 1e-10, 1e-10, 1e-10, 1e-10;
    EgoPlan plan;
    plan.speed_mps = 10.0;
    const Conflict conflict = AssessConflict(EgoFan(plan, {1e-3, 1e-6}, {}, {}), target, {});
    const double expected = 0.5 * std::erfc(-(1.975 - y) / 0.5 / std::sqrt(2.0));
    EXPECT_NEAR(conflict.probability, expected, 0.02) << y;
  }
}

TEST(Conflict, AgreesWithPlainMonteCarlo) {
  BodyTarget target = TargetAt(32.0, -26.0, kPi / 2 - 0.1, 10.0);
  StateMatrix root = StateMatrix::Zero();
  root.diagonal() << 0.8, 0.9, 0.05, 0.9, 0.02, 0.4;
  root(3, 1) = 0.5;  // Speed and place go together.
  target.covariance = root * root.transpose();
  EgoPlan plan;
  plan.speed_mps = 10.0;
  const WarningsConfig config;
  const Conflict conflict = AssessConflict(EgoFan(plan, {1e-6, 1e-9}, {}, config), target, config);
  std::mt19937_64 rng(3);
  std::normal_distribution<double> normal;
  Motion ego;
  Motion other;
  PredictEgo(plan, {}, 60, ego);
  int hits = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    StateVector z;
    for (int i = 0; i < 6; ++i) z[i] = normal(rng);
    PredictTarget(target.mean + root * z, false, 60, other);
    for (std::size_t k = 0; k < other.size(); ++k) {
      if (!Touch(ego[k], {2.55, 1.125}, other[k], target.size)) continue;
      ++hits;
      break;
    }
  }
  const double plain = hits / 4000.0;
  EXPECT_GT(plain, 0.2);
  EXPECT_LT(plain, 0.95);
  EXPECT_NEAR(conflict.probability, plain, 0.06);
}

TEST(PredictTarget, BrakingEndsAtRestAndNeverRollsBack) {
  StateVector x;
  x << 0, 0, 0, 6.0, 0, -6.0;
  Motion motion;
  PredictTarget(x, true, 60, motion);
  EXPECT_NEAR(motion.back().centre.x(), 3.0, 0.2);  // 36 / 12
  EXPECT_EQ(motion.back().centre, motion[20].centre);
}

TEST(PlaceOnPath, IsSymmetricAndFollowsTheArc) {
  EgoPlan left;
  left.curvature_per_m = 0.02;
  EgoPlan right;
  right.curvature_per_m = -0.02;
  // A point 2 m outside of a left bend of 50 m, a quarter of a circle on.
  const PathPlace place = PlaceOnPath(left, {52.0, 50.0});
  EXPECT_NEAR(place.left_m, -2.0, 1e-9);
  EXPECT_NEAR(place.along_m, 50.0 * kPi / 2, 1e-9);
  EXPECT_NEAR(place.yaw_rad, kPi / 2, 1e-9);
  const PathPlace mirrored = PlaceOnPath(right, {52.0, -50.0});
  EXPECT_NEAR(mirrored.left_m, 2.0, 1e-9);
  EXPECT_NEAR(mirrored.along_m, place.along_m, 1e-9);
  EXPECT_NEAR(mirrored.yaw_rad, -kPi / 2, 1e-9);
}

// The draws one after the other, each predicted to its end: what the lanes must give to the bit.
Conflict DrawByDraw(const EgoFan& ego, const BodyTarget& target, const StateMatrix& root,
                    const WarningsConfig& config) {
  std::vector<double> wide, exact;
  Conflict out;
  Motion other;
  for (const Draw& draw : NormalDraws()) {
    const Eigen::Matrix<double, 6, 1> z =
        Eigen::Map<const Eigen::Matrix<double, 6, 1>>(draw.data());
    PredictTarget(target.mean + root * z, false, ego.steps(), other);
    const Motion& own = ego.Of(draw[6], draw[7]);
    bool has_touched = false;
    for (std::size_t k = 0; k < other.size(); ++k) {
      const double t_s = kStep_s * static_cast<double>(k);
      if (!Touch(own[k], ego.wide(), other[k], target.size)) continue;
      if (!has_touched) wide.push_back(t_s);
      const bool is_near = z.squaredNorm() <= config.hidden_sigmas * config.hidden_sigmas;
      if (!has_touched && is_near && !(out.reachable_s <= t_s)) out.reachable_s = t_s;
      has_touched = true;
      if (!Touch(own[k], ego.exact(), other[k], target.size)) continue;
      exact.push_back(t_s);
      break;
    }
  }
  const auto at = [](std::vector<double>& v, double share) {
    std::ranges::sort(v);
    return v.empty() ? kNaN
                     : v[static_cast<std::size_t>(share * static_cast<double>(v.size() - 1) + 0.5)];
  };
  out.probability = static_cast<double>(wide.size()) / kDrawCount;
  out.probability_exact = static_cast<double>(exact.size()) / kDrawCount;
  out.early_s = at(wide, 0.1);
  out.median_s = at(wide, 0.5);
  out.exact_median_s = at(exact, 0.5);
  return out;
}

TEST(AssessConflict, GivesToTheBitWhatOneDrawAfterTheOtherGives) {
  std::mt19937_64 rng(11);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  int touching = 0;
  for (int trial = 0; trial < 200; ++trial) {
    EgoPlan plan;
    plan.speed_mps = 10.0 + 9.0 * u(rng);
    plan.curvature_per_m = 0.03 * u(rng);
    const EgoFan ego(plan, {0.3, 0.02}, {}, {});
    BodyTarget target = TargetAt(30.0 + 28.0 * u(rng), 15.0 * u(rng), kPi * u(rng),
                                 trial % 4 == 0 ? 0.1 * u(rng) : 12.0 * u(rng));
    target.mean[kYawRate] = 0.2 * u(rng);
    target.mean[kAccel] = trial % 2 == 0 ? 0.9 * u(rng) : 3.0 * std::abs(u(rng));
    // A covariance whose square root is the same by any method.
    target.covariance = 0.09 * StateMatrix::Identity();
    const StateMatrix root = 0.3 * StateMatrix::Identity();
    const Conflict lanes = AssessConflict(ego, target, {});
    const Conflict plain = DrawByDraw(ego, target, root, {});
    if (lanes.probability == 0.0) {
      EXPECT_EQ(plain.probability, 0.0);
      continue;
    }
    ++touching;
    EXPECT_EQ(lanes.probability, plain.probability) << trial;
    EXPECT_EQ(lanes.probability_exact, plain.probability_exact) << trial;
    EXPECT_TRUE(same(lanes.reachable_s, plain.reachable_s)) << trial;
    EXPECT_TRUE(same(lanes.early_s, plain.early_s)) << trial;
    EXPECT_TRUE(same(lanes.median_s, plain.median_s)) << trial;
    EXPECT_TRUE(same(lanes.exact_median_s, plain.exact_median_s)) << trial;
  }
  EXPECT_GT(touching, 20);
}

TEST(TargetLanes, GoAsPredictTargetDoesToTheBit) {
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  for (const bool keeps_braking : {false, true}) {
    for (int trial = 0; trial < 50; ++trial) {
      std::array<StateVector, TargetLanes::kLanes> states;
      std::array<Motion, TargetLanes::kLanes> plain;
      for (std::size_t i = 0; i < states.size(); ++i) {
        states[i] << 50.0 * u(rng), 50.0 * u(rng), 3.0 * u(rng), (i % 3 == 0 ? 0.6 : 15.0) * u(rng),
            0.3 * u(rng), 4.0 * u(rng);
        PredictTarget(states[i], keeps_braking, 60, plain[i]);
      }
      TargetLanes lanes(states, keeps_braking);
      const double furthest_m = lanes.FurthestIn(6.0);
      for (std::size_t k = 0; k <= 60; ++k) {
        for (std::size_t i = 0; i < states.size(); ++i) {
          EXPECT_EQ(lanes.At(i).centre, plain[i][k].centre);
          EXPECT_EQ(lanes.At(i).along, plain[i][k].along);
          EXPECT_LE((plain[i][k].centre - plain[i][0].centre).norm(), furthest_m + 1e-9);
        }
        lanes.Step();
      }
    }
  }
}

}  // namespace
}  // namespace v2vouch::warnings
