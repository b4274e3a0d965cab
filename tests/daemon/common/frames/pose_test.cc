// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/frames/pose.h"

#include <gtest/gtest.h>

#include "daemon/common/base/random.h"

namespace v2vouch {
namespace {

TEST(PoseProperty, InverseUndoesAndChainsAssociate) {
  Random random(20240611);
  for (int i = 0; i < 500; ++i) {
    const auto draw = [&] { return random.Uniform(-50.0, 50.0); };
    const Pose<Odometry, Body> X_OB(draw(), draw(), draw());
    const Pose<Body, Radar> X_BR(draw(), draw(), draw());
    const Point<Radar> p_R{draw(), draw()};
    const Point<Odometry> direct = (X_OB * X_BR) * p_R;
    const Point<Odometry> nested = X_OB * (X_BR * p_R);
    EXPECT_NEAR(direct.x_m, nested.x_m, 1e-11);
    EXPECT_NEAR(direct.y_m, nested.y_m, 1e-11);
    const Point<Radar> back = (X_OB * X_BR).Inverse() * direct;
    EXPECT_NEAR(back.x_m, p_R.x_m, 1e-11);
    EXPECT_NEAR(back.y_m, p_R.y_m, 1e-11);
  }
}

TEST(Pose, YawStaysInTheHalfOpenCircle) {
  EXPECT_NEAR((Pose<Odometry, Body>(0.0, 0.0, 3.0) * Pose<Body, Radar>(0.0, 0.0, 1.0)).yaw_rad(),
              4.0 - 2.0 * kPi, 1e-12);
}

}  // namespace
}  // namespace v2vouch
