// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/random.h"
#include "daemon/common/models/measurement_model.h"

namespace v2vouch {
namespace {

BoxMeasurement Good() {
  BoxMeasurement z{.x_m = 10.0, .y_m = -4.0, .yaw_rad = 0.3};
  z.position_covariance << 0.1, 0.02, 0.02, 0.2;
  z.velocity_O_mps = Eigen::Vector2d(8.0, 2.0);
  return z;
}

StateVector Near(const BoxMeasurement& z, Random& random) {
  StateVector x = StateVector::Zero();
  x << z.x_m + random.Normal(), z.y_m + random.Normal(), z.yaw_rad + random.Uniform(-0.5, 0.5),
      random.Normal(8.0, 4.0), 0.0, 0.0;
  return x;
}

TEST(LinearizeBoxProperty, JacobianMatchesFiniteDifferences) {
  Random random(20240611);
  const BoxMeasurement z = Good();
  for (int trial = 0; trial < 100; ++trial) {
    const StateVector x = Near(z, random);
    const Linearized model = LinearizeBox(x, z);
    ASSERT_EQ(model.y.size(), 5);
    for (int k = 0; k < kStateSize; ++k) {
      constexpr double kStep = 1e-6;
      StateVector up = x, down = x;
      up[k] += kStep;
      down[k] -= kStep;
      // y = z - h(x).
      const Linearized::Vector by_k =
          (LinearizeBox(down, z).y - LinearizeBox(up, z).y) / (2.0 * kStep);
      EXPECT_LT((by_k - model.H.col(k)).norm(), 1e-6) << "state " << k;
    }
  }
}

TEST(LinearizeBox, AnAxisHasTwoEndsAndAQuarterTurnTeachesNothing) {
  StateVector x = StateVector::Zero();
  x[kYaw] = 0.3 + kPi;
  BoxMeasurement z = Good();
  z.velocity_O_mps.reset();
  ASSERT_EQ(LinearizeBox(x, z).y.size(), 3);
  EXPECT_NEAR(LinearizeBox(x, z).y[2], 0.0, 1e-12);
  x[kYaw] = 0.3 + 0.5 * kPi;
  EXPECT_EQ(LinearizeBox(x, z).y.size(), 2);
}

TEST(LinearizeBox, AVehicleInReverseHasAVelocityAgainstItsFront) {
  StateVector x = StateVector::Zero();
  x[kYaw] = std::atan2(2.0, 8.0) + kPi;
  x[kSpeed] = -std::hypot(2.0, 8.0);
  BoxMeasurement z = Good();
  z.yaw_rad = x[kYaw];
  EXPECT_NEAR(LinearizeBox(x, z).y.tail<2>().norm(), 0.0, 1e-12);
}

TEST(FaultOfBox, NamesWhatCannotBeUsed) {
  EXPECT_FALSE(FaultOf(Good()));
  const auto fault = [](auto spoil) {
    BoxMeasurement z = Good();
    spoil(z);
    return FaultOf(z);
  };
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(fault([](auto& z) { z.x_m = kNaN; }), Reason::kNotFinite);
  EXPECT_EQ(fault([&](auto& z) { z.velocity_O_mps->x() = infinity; }), Reason::kNotFinite);
  EXPECT_EQ(fault([](auto& z) { z.velocity_O_mps->x() = 400.0; }), Reason::kOutOfRange);
  EXPECT_EQ(fault([](auto& z) { z.velocity_covariance.setZero(); }), Reason::kOutOfRange);
  EXPECT_EQ(fault([](auto& z) { z.position_covariance(0, 1) = 1.0; }), Reason::kOutOfRange);
  EXPECT_EQ(fault([](auto& z) { z.width_m = 0.0; }), Reason::kOutOfRange);
}

}  // namespace
}  // namespace v2vouch
