// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/random.h"
#include "daemon/common/models/extent.h"

namespace v2vouch {
namespace {

using Matrix5 = Eigen::Matrix<double, 5, 5>;

PoseMeasurement Good() {
  PoseMeasurement z{.x_m = 10.0, .y_m = -4.0, .yaw_rad = 0.3, .speed_mps = 20.0};
  z.covariance.diagonal() << 0.25, 0.25, 0.0025, 0.25, 0.0004;
  return z;
}

Matrix5 RandomCovariance(Random& random) {
  Matrix5 A;
  for (double& a : A.reshaped()) a = random.Normal();
  return A * A.transpose() + 0.1 * Matrix5::Identity();
}

ExtendedState RandomState(Random& random) {
  ExtendedState state;
  ExtendedState::Matrix A;
  for (double& a : A.reshaped()) a = random.Normal();
  state.covariance = A * A.transpose() + 0.1 * ExtendedState::Matrix::Identity();
  state.mean << random.Normal(0, 50), random.Normal(0, 50), random.Uniform(-kPi, kPi),
      random.Normal(10, 5), random.Normal(0, 0.2), random.Normal(), 4.5, 1.8;
  return state;
}

TEST(LinearizePose, TakesTheShortWayBetweenHeadings) {
  StateVector x = StateVector::Zero();
  for (const double yaw : {0.0, 0.01, kPi, -kPi + 0.01, 0.5 * kPi, 7.0}) {
    x[kYaw] = yaw;
    for (const double turns : {0.0, 2.0 * kPi, -4.0 * kPi}) {
      const auto model = LinearizePose(x, {.yaw_rad = yaw - 0.02 + turns});
      EXPECT_NEAR(model.y[kYaw], -0.02, 1e-12) << yaw << " " << turns;
    }
  }
}

TEST(FaultOf, AcceptsWhatIsUsable) { EXPECT_FALSE(FaultOf(Good()).has_value()); }

TEST(FaultOf, RefusesWhatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinity, -infinity}) {
    for (double PoseMeasurement::*field :
         {&PoseMeasurement::x_m, &PoseMeasurement::y_m, &PoseMeasurement::yaw_rad,
          &PoseMeasurement::speed_mps, &PoseMeasurement::yaw_rate_radps}) {
      PoseMeasurement z = Good();
      z.*field = bad;
      EXPECT_EQ(FaultOf(z), Reason::kNotFinite);
    }
    PoseMeasurement z = Good();
    z.covariance(3, 1) = bad;
    EXPECT_EQ(FaultOf(z), Reason::kNotFinite);
  }
}

TEST(FaultOf, RefusesCovariancesThatAreNone) {
  PoseMeasurement z = Good();
  z.covariance.setZero();
  EXPECT_EQ(FaultOf(z), Reason::kOutOfRange);
  z = Good();
  z.covariance(2, 2) = -0.1;
  EXPECT_EQ(FaultOf(z), Reason::kOutOfRange);
  z = Good();
  z.covariance(0, 1) = z.covariance(1, 0) = 0.3;  // Correlation 1.2.
  EXPECT_EQ(FaultOf(z), Reason::kOutOfRange);
  z = Good();
  z.covariance(0, 1) = 0.1;  // Not symmetric.
  EXPECT_EQ(FaultOf(z), Reason::kOutOfRange);
}

TEST(FaultOf, RefusesWhatNoVehicleCanBe) {
  PoseMeasurement z = Good();
  z.x_m = 1e300;
  EXPECT_EQ(FaultOf(z), Reason::kOutOfRange);
  z = Good();
  z.speed_mps = 400.0;
  EXPECT_EQ(FaultOf(z), Reason::kOutOfRange);
}

// The pose's short cut (H = [I 0]) against the general update with that H written out.
TEST(PoseModelProperty, EqualsTheGeneralUpdate) {
  Random random(20241102);
  for (int trial = 0; trial < 200; ++trial) {
    const ExtendedState state = RandomState(random);
    PoseMeasurement z = Good();
    z.covariance = RandomCovariance(random);
    z.x_m = state.mean[kX] + random.Normal();
    z.yaw_rad = state.mean[kYaw] + random.Normal();
    const LinearizedPose pose = LinearizePose(state.mean.head<kStateSize>(), z);
    Linearized general;
    general.y = pose.y;
    general.H.setIdentity(5, kStateSize);
    general.E.setZero(5, 2);
    general.R = pose.R;

    const auto quick = EvaluateExtended(pose, state);
    const auto slow = EvaluateExtended(general, state);
    ASSERT_TRUE(quick && slow);
    EXPECT_EQ(quick->rows, 5);
    EXPECT_NEAR(quick->distance_squared, slow->distance_squared,
                1e-9 * (1.0 + slow->distance_squared));
    EXPECT_NEAR(quick->log_det, slow->log_det, 1e-9);

    ExtendedState a = state, b = state;
    ASSERT_TRUE(UpdateExtended(pose, a));
    ASSERT_TRUE(UpdateExtended(general, b));
    EXPECT_LT((a.mean - b.mean).norm(), 1e-8);
    EXPECT_LT((a.covariance - b.covariance).norm(), 1e-8);
  }
}

}  // namespace
}  // namespace v2vouch
