// SPDX-License-Identifier: Apache-2.0
#include "daemon/priority/priority_filter.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "daemon/base/random.h"

namespace v2vouch {
namespace {

constexpr double kDt_s = 0.05;

Timestamp At(int step) { return FromMicros(1'000'000) + FromSeconds(kDt_s * step); }

// A radar at the origin of O and a point target: range, azimuth, range rate.
Linearized PointRadar(const StateVector& x, const Eigen::Vector3d& z) {
  const double c = std::cos(x[kYaw]), s = std::sin(x[kYaw]), v = x[kSpeed];
  const double r = std::hypot(x[kX], x[kY]);
  const double ux = x[kX] / r, uy = x[kY] / r;
  const double rate = v * (ux * c + uy * s);
  Linearized m;
  m.y.resize(3);
  m.y << z[0] - r, AngleDifference(z[1], std::atan2(x[kY], x[kX])), z[2] - rate;
  m.H.setZero(3, kStateSize);
  m.H.row(0).head<2>() << ux, uy;
  m.H.row(1).head<2>() << -uy / r, ux / r;
  m.H(2, kX) = v * (c - rate / std::max(std::abs(v), 1e-9) * ux * (v < 0 ? -1 : 1)) / r;
  m.H(2, kY) = v * (s - rate / std::max(std::abs(v), 1e-9) * uy * (v < 0 ? -1 : 1)) / r;
  m.H(2, kYaw) = v * (-ux * s + uy * c);
  m.H(2, kSpeed) = ux * c + uy * s;
  m.R.setZero(3, 3);
  m.R.diagonal() << 0.25 * 0.25, std::pow(FromDegrees(0.5), 2), 0.1 * 0.1;
  return m;
}

Eigen::Vector3d Measure(const StateVector& x, Random& random) {
  const double r = std::hypot(x[kX], x[kY]);
  const double rate = x[kSpeed] * (x[kX] * std::cos(x[kYaw]) + x[kY] * std::sin(x[kYaw])) / r;
  return {r + 0.25 * random.Normal(), std::atan2(x[kY], x[kX]) + FromDegrees(0.5) * random.Normal(),
          rate + 0.1 * random.Normal()};
}

struct Figures {
  double squared = 0.0;
  double nees = 0.0;
  int count = 0;
  [[nodiscard]] double rms() const { return std::sqrt(squared / count); }
  [[nodiscard]] double anees() const { return nees / count; }
};

struct Result {
  Figures seen, hidden, at_end;
  Figures local_seen;  // The same filter without any claim.
};

// A validated vehicle is seen for 6 s and then hidden for 4 s; BSM white noise 1.0 m,
// bias 1.5 m per axis, ego heading off by 0.3 deg (1 sigma); claimed speed and direction are off by
// 0.1 m/s and 0.7 deg for good, unknown to the filter. An oncoming car that
// brakes, goes on and sways; none of that is the filter's own model.
/// @param correlated_m Gauss-Markov part of the GNSS error (30 s) beside bias and white noise.
Result SeenThenHidden(int runs, bool with_claims_hidden, double correlated_m = 0.0) {
  const PriorityFilterConfig config;
  Random random(20240611);
  Result result;
  for (int run = 0; run < runs; ++run) {
    const Eigen::Vector2d bias = 1.5 * Eigen::Vector2d(random.Normal(), random.Normal());
    const double heading_error = FromDegrees(0.3) * random.Normal();
    const double speed_error = 0.1 * random.Normal();
    const double yaw_error = FromDegrees(0.7) * random.Normal();
    Eigen::Vector2d wander = correlated_m * Eigen::Vector2d(random.Normal(), random.Normal());
    const double sway = random.Uniform(0.0, 2.0 * kPi);

    StateVector truth;
    truth << 90.0, 3.5, kPi, 10.0, 0.0, 0.0;
    KinematicState start;
    start.mean = truth;
    start.covariance.diagonal() << 0.3, 0.3, 0.01, 0.2, 0.01, 0.5;
    const Eigen::LLT<StateMatrix> root(start.covariance);
    StateVector draw;
    for (double& d : draw) d = random.Normal();
    start.mean += root.matrixL() * draw;
    KinematicState local = start;
    PriorityFilter filter(start, At(0), Eigen::Vector2d::Zero(), 2.25 * Eigen::Matrix2d::Identity(),
                          FromDegrees(0.3), config);

    for (int step = 1; step <= 200; ++step) {
      const double t = kDt_s * step;
      truth[kAccel] = 1.2 * std::sin(0.9 * t + sway);
      truth[kYawRate] = 0.06 * std::sin(0.7 * t + 2.0 * sway);
      const double middle = truth[kYaw] + 0.5 * kDt_s * truth[kYawRate];
      truth[kX] += truth[kSpeed] * kDt_s * std::cos(middle);
      truth[kY] += truth[kSpeed] * kDt_s * std::sin(middle);
      truth[kYaw] = WrapAngle(truth[kYaw] + kDt_s * truth[kYawRate]);
      truth[kSpeed] += kDt_s * truth[kAccel];

      filter.PredictTo(At(step), config);
      PredictCtra(local, kDt_s, config.motion);
      const bool is_hidden = t > 6.0;
      if (!is_hidden) {
        const Eigen::Vector3d z = Measure(truth, random);
        EXPECT_TRUE(filter.Update(PointRadar(filter.kinematics().mean, z)));
        EXPECT_TRUE(UpdateWith(PointRadar(local.mean, z), local));
      }
      if (step % 2 == 0 && (!is_hidden || with_claims_hidden)) {
        ClaimInOdometry claim;
        claim.stamp = At(step);
        const Eigen::Vector2d p = truth.head<2>();
        const double keep = std::exp(-2.0 * kDt_s / 30.0);
        wander = keep * wander + correlated_m * std::sqrt(1.0 - keep * keep) *
                                     Eigen::Vector2d(random.Normal(), random.Normal());
        claim.p_O = p + heading_error * Eigen::Vector2d(-p.y(), p.x()) + bias + wander +
                    Eigen::Vector2d(random.Normal(), random.Normal());
        claim.yaw_rad = WrapAngle(truth[kYaw] + heading_error + yaw_error + 0.01 * random.Normal());
        claim.speed_mps = truth[kSpeed] + speed_error + 0.05 * random.Normal();
        claim.yaw_rate_radps = truth[kYawRate] + 0.01 * random.Normal();
        claim.accel_mps2 = truth[kAccel] + 0.2 * random.Normal();
        filter.Update(claim, config);
      }
      const auto score = [&](Figures& figures, const KinematicState& state) {
        const Eigen::Vector2d e = state.mean.head<2>() - truth.head<2>();
        figures.squared += e.squaredNorm();
        figures.nees += e.dot(state.covariance.topLeftCorner<2, 2>().inverse() * e);
        ++figures.count;
      };
      if (t > 2.0 && !is_hidden) {
        score(result.seen, filter.kinematics());
        score(result.local_seen, local);
      }
      if (is_hidden) score(result.hidden, filter.kinematics());
      if (step == 200) score(result.at_end, filter.kinematics());
      EXPECT_TRUE(filter.is_healthy());
    }
  }
  return result;
}

TEST(PriorityFilter, HiddenVehicleStaysWithinItsTarget) {
  const Result result = SeenThenHidden(50, true);
  std::printf(
      "seen %.3f m (ANEES %.2f; LOCAL %.3f m), hidden %.3f m (ANEES %.2f), after 4 s %.3f m\n",
      result.seen.rms(), result.seen.anees(), result.local_seen.rms(), result.hidden.rms(),
      result.hidden.anees(), result.at_end.rms());
  EXPECT_LE(result.hidden.rms(), 0.6);
  EXPECT_LE(result.hidden.anees(), 3.0);
  EXPECT_LE(result.seen.anees(), 3.0);
  EXPECT_LE(result.seen.rms(), 1.02 * result.local_seen.rms());  // As good as LOCAL while seen.
}

TEST(PriorityFilter, CorrelatedGnssErrorIsCoveredByTheCovariance) {
  const Result result = SeenThenHidden(50, true, 0.5);
  std::printf("with 0.5 m, 30 s: hidden %.3f m (ANEES %.2f), after 4 s %.3f m\n",
              result.hidden.rms(), result.hidden.anees(), result.at_end.rms());
  EXPECT_LE(result.hidden.rms(), 0.6);
  EXPECT_LE(result.hidden.anees(), 3.0);
}

TEST(PriorityFilter, ClaimsAreWhatMakesTheDifferenceWhileHidden) {
  EXPECT_GT(SeenThenHidden(20, false).at_end.rms(), 2.0 * SeenThenHidden(20, true).at_end.rms());
}

PriorityFilter Standing(const PriorityFilterConfig& config) {
  KinematicState start;
  start.mean << 30.0, 0.0, 0.0, 10.0, 0.0, 0.0;
  start.covariance.diagonal() << 0.04, 0.04, 0.001, 0.02, 0.001, 0.05;
  return {start, At(0), Eigen::Vector2d::Zero(), 0.09 * Eigen::Matrix2d::Identity(), 0.005, config};
}

ClaimInOdometry ClaimOf(const PriorityFilter& filter) {
  const KinematicState state = filter.kinematics();
  ClaimInOdometry claim;
  claim.stamp = filter.stamp();
  claim.p_O = state.mean.head<2>() + filter.bias();
  claim.yaw_rad = state.mean[kYaw];
  claim.speed_mps = state.mean[kSpeed];
  return claim;
}

TEST(PriorityFilter, OutlierIsNotUsed) {
  const PriorityFilterConfig config;
  PriorityFilter filter = Standing(config);
  const auto before = filter.mean();
  ClaimInOdometry claim = ClaimOf(filter);
  claim.p_O.y() += 8.0;
  const ClaimFit fit = filter.Update(claim, config);
  EXPECT_FALSE(fit.is_used);
  EXPECT_GT(fit.position_nis, config.position_gate);
  EXPECT_EQ(filter.mean(), before);
}

TEST(PriorityFilter, FalseBrakingIsNotFollowed) {
  const PriorityFilterConfig config;
  PriorityFilter filter = Standing(config);
  ClaimInOdometry claim = ClaimOf(filter);
  claim.accel_mps2 = -6.0;
  filter.Update(claim, config);
  EXPECT_NEAR(filter.kinematics().mean[kAccel], 0.0, 1e-9);
}

TEST(PriorityFilter, ReversingCarMayBeToldFromEitherEnd) {
  const PriorityFilterConfig config;
  PriorityFilter filter = Standing(config);
  ClaimInOdometry claim = ClaimOf(filter);
  claim.yaw_rad = kPi;
  claim.speed_mps = -claim.speed_mps;
  const ClaimFit fit = filter.Update(claim, config);
  EXPECT_TRUE(fit.is_used && fit.is_velocity_used);
  EXPECT_NEAR(filter.kinematics().mean[kSpeed], -10.0, 0.2);
}

TEST(PriorityFilter, PredictionInOneStepOrManyAgrees) {
  const PriorityFilterConfig config;
  PriorityFilter once = Standing(config);
  PriorityFilter often = once;
  once.PredictTo(At(20), config);
  for (int step = 2; step <= 20; step += 2) often.PredictTo(At(step), config);
  EXPECT_LT((once.mean() - often.mean()).norm(), 1e-6);
  EXPECT_LT((once.covariance() - often.covariance()).norm(), 1e-6);
}

TEST(PriorityFilter, BiasNeverExceedsItsCap) {
  PriorityFilterConfig config;
  config.position_gate = 100.0;
  PriorityFilter filter = Standing(config);
  for (int step = 1; step < 400; ++step) {
    filter.PredictTo(At(step), config);
    ClaimInOdometry claim = ClaimOf(filter);
    claim.p_O.y() += 2.0;
    filter.Update(claim, config);
    ASSERT_LE(filter.bias().norm(), config.max_bias_m + 1e-9);
  }
}

}  // namespace
}  // namespace v2vouch
