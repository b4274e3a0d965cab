// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/models/ctra.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "tests/daemon/common/models/random_scene.h"

namespace v2vouch {
namespace {

const MotionNoise kNoise;

// The same motion by brute force: Euler steps of 1 us of the rates.
StateVector Integrate(StateVector x, double dt_s) {
  const int steps = 20000;
  const double h = dt_s / steps;
  const double v0 = x[kSpeed];
  const double s = v0 * v0 / (v0 * v0 + 0.25);
  const double rate = 1.0 / kNoise.yaw_rate_decay_s + (1.0 - s) / 0.5;
  for (int i = 0; i < steps; ++i) {
    // Midpoint rule.
    const double v = x[kSpeed] + 0.5 * h * x[kAccel];
    const double yaw = x[kYaw] + 0.5 * h * s * x[kYawRate];
    const double w = x[kYawRate] * (1.0 - 0.5 * h * rate);
    const double a = x[kAccel] * (1.0 - 0.5 * h / kNoise.accel_decay_s);
    x[kX] += h * v * std::cos(yaw);
    x[kY] += h * v * std::sin(yaw);
    x[kYaw] += h * s * w;
    x[kSpeed] += h * a;
    x[kYawRate] -= h * rate * w;
    x[kAccel] -= h * a / kNoise.accel_decay_s;
  }
  return x;
}

TEST(CtraStep, AgreesWithBruteForceIntegration) {
  Random random(11);
  for (int trial = 0; trial < 20; ++trial) {
    const StateVector x = RandomState(random);
    const StateVector difference = CtraStep(x, 0.1, kNoise) - Integrate(x, 0.1);
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-8) << "x = " << x.transpose();
  }
}

TEST(CtraStepProperty, JacobianMatchesCentralDifferences) {
  Random random(12);
  for (int trial = 0; trial < 500; ++trial) {
    StateVector x = RandomState(random);
    if (trial % 3 == 0) x[kSpeed] = random.Uniform(-1.0, 1.0);  // Where the regularisation acts.
    const double dt = random.Uniform(0.001, 0.1);
    StateMatrix F;
    CtraStep(x, dt, kNoise, &F);
    for (int i = 0; i < kStateSize; ++i) {
      StateVector high = x, low = x;
      high[i] += 1e-5;
      low[i] -= 1e-5;
      const StateVector numeric = (CtraStep(high, dt, kNoise) - CtraStep(low, dt, kNoise)) / 2e-5;
      EXPECT_LT((F.col(i) - numeric).cwiseAbs().maxCoeff(), 1e-6)
          << "column " << i << ", x = " << x.transpose();
    }
  }
}

TEST(PredictCtraProperty, CovarianceStaysSymmetricAndPositive) {
  Random random(13);
  for (int trial = 0; trial < 200; ++trial) {
    KinematicState state{RandomState(random), RandomCovariance<kStateSize>(random, 1.0)};
    PredictCtra(state, random.Uniform(0.0, 3.0), kNoise);
    EXPECT_EQ((state.covariance - state.covariance.transpose()).cwiseAbs().maxCoeff(), 0.0);
    const Eigen::SelfAdjointEigenSolver<StateMatrix> solver(state.covariance);
    EXPECT_GT(solver.eigenvalues().minCoeff(), 0.0);
    EXPECT_LE(std::abs(state.mean[kYaw]), kPi);
  }
}

TEST(PredictCtra, TransitionCarriesSmallDeviations) {
  Random random(14);
  KinematicState state{RandomState(random), StateMatrix::Identity()};
  StateMatrix F;
  KinematicState moved = state;
  PredictCtra(moved, 0.35, kNoise, &F);
  KinematicState shifted = state;
  const StateVector d = 1e-6 * StateVector::Ones();
  shifted.mean += d;
  PredictCtra(shifted, 0.35, kNoise);
  EXPECT_LT((shifted.mean - moved.mean - F * d).norm(), 1e-9);
}

TEST(PredictCtra, CutsLongStepsWithoutChangingTheMotion) {
  KinematicState once{(StateVector() << 1, 2, 0.3, 12, 0.2, 1).finished(), StateMatrix::Identity()};
  KinematicState often = once;
  PredictCtra(once, 1.0, kNoise);
  for (int i = 0; i < 20; ++i) PredictCtra(often, 0.05, kNoise);
  EXPECT_LT((once.mean - often.mean).norm(), 2e-3);
  EXPECT_NEAR(once.covariance(kX, kX) / often.covariance(kX, kX), 1.0, 0.05);
}

TEST(PredictCtra, StandingVehicleKeepsItsDirection) {
  KinematicState state;
  state.mean << 5, 5, 1.0, 0.0, 0.4, 0.0;  // A turn that ended in a stop.
  state.covariance = 1e-4 * StateMatrix::Identity();
  for (int i = 0; i < 60; ++i) PredictCtra(state, 1.0, kNoise);
  EXPECT_NEAR(state.mean[kYaw], 1.0, 1e-9);
  EXPECT_LT(std::abs(state.mean[kYawRate]), 1e-9);
  EXPECT_LT(state.covariance(kYaw, kYaw), 2e-4);
}

TEST(PredictCtra, ReversingVehicleMovesAgainstItsDirection) {
  KinematicState state;
  state.mean << 0, 0, 0.5 * kPi, -3.0, 0.0, 0.0;
  PredictCtra(state, 1.0, kNoise);
  EXPECT_NEAR(state.mean[kX], 0.0, 1e-9);
  EXPECT_NEAR(state.mean[kY], -3.0, 1e-9);
  EXPECT_NEAR(state.mean[kYaw], 0.5 * kPi, 1e-12);
}

// A clock that steps must not make one prediction take hours, nor end in numbers that are none.
TEST(PredictCtra, AnyLengthOfTimeIsPredictedAtOnce) {
  Random random(17);
  for (const double dt_s : {10.5, 60.0, 3600.0, 86400.0, 3.2e9}) {
    for (int trial = 0; trial < 20; ++trial) {
      KinematicState state{RandomState(random), 0.1 * StateMatrix::Identity()};
      const Eigen::Vector2d from = state.mean.head<2>();
      StateMatrix transition;
      PredictCtra(state, dt_s, kNoise, &transition);
      ASSERT_TRUE(state.mean.allFinite() && state.covariance.allFinite()) << dt_s;
      ASSERT_TRUE(transition.allFinite()) << dt_s;
      const Eigen::SelfAdjointEigenSolver<StateMatrix> solver(state.covariance);
      EXPECT_GT(solver.eigenvalues().minCoeff(), 0.0) << dt_s;
      // Where traffic can have got to by then lies within two or three sigma.
      const double sigma_m = std::sqrt(state.covariance(kX, kX));
      EXPECT_GT(sigma_m, 10.0 * std::min(dt_s - 10.0, 1e6)) << dt_s;
      EXPECT_LT((state.mean.head<2>() - from).norm(), 3.0 * sigma_m + 600.0) << dt_s;
    }
  }
}

TEST(PredictCtra, WhereTheSubStepsEndNothingJumps) {
  Random random(18);
  for (int trial = 0; trial < 50; ++trial) {
    const KinematicState start{RandomState(random), 0.1 * StateMatrix::Identity()};
    KinematicState before = start, after = start;
    PredictCtra(before, 9.9999, kNoise);
    PredictCtra(after, 10.0001, kNoise);
    EXPECT_LT((before.mean.head<2>() - after.mean.head<2>()).norm(), 0.05);
    const double ratio = after.covariance.trace() / before.covariance.trace();
    EXPECT_NEAR(ratio, 1.0, 0.01);
  }
}

}  // namespace
}  // namespace v2vouch
