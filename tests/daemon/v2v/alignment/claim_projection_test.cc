// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "daemon/v2v/alignment/alignment.h"
#include "tests/daemon/v2v/alignment/simulated_drive.h"

namespace v2vouch {
namespace {

const Wgs84 kTown{FromDegrees(42.5), FromDegrees(-83.1), 0.0};

// A car at the start of L that looks north-east, and its alignment.
class ToOdometryTest : public ::testing::Test {
 protected:
  ToOdometryTest() : drive_(kTown, 0.6, {}), alignment_(AlignmentConfig{}, vehicle_) {
    for (int i = 0; i < 100; ++i) {
      drive_.Advance(10.0, 0.1, 0.1);
      alignment_.OnFix(drive_.Fix(vehicle_), drive_.Ego());
    }
  }

  // A claim of a vehicle at a place in B, looking along `yaw_B`, at `height_m`.
  Claim ClaimAt(double x_B, double y_B, double yaw_B, double speed_mps, double height_m = 0.0) {
    const Pose<Body, Target> X_BT(x_B, y_B, yaw_B);
    const Eigen::Vector3d forward = drive_.TrueDirection_E();
    const Wgs84 place = ToWgs84({drive_.TruePlace_E()});
    const Eigen::Matrix3d R_EN = EastNorthUp(place);
    const Eigen::Vector3d left = R_EN.col(2).cross(forward);
    Wgs84 there = ToWgs84({drive_.TruePlace_E() + x_B * forward + y_B * left});
    there.height_m = height_m;
    Claim claim;
    claim.received = drive_.Now();
    claim.p_E = ToEcef(there).p_E;
    claim.course_E = std::cos(yaw_B) * forward + std::sin(yaw_B) * left;
    claim.speed_mps = speed_mps;
    claim.position_sigma_m = 1.0;
    return claim;
  }

  Pose<Odometry, Target> Expected(double x_B, double y_B, double yaw_B) const {
    return drive_.Ego().X_OB * Pose<Body, Target>(x_B, y_B, yaw_B);
  }

  VehicleConfig vehicle_;
  SimulatedDrive drive_;
  Alignment alignment_;
};

TEST_F(ToOdometryTest, AFreshClaimLandsWhereTheVehicleIs) {
  const ClaimInOdometry in_O = alignment_.ToOdometry(ClaimAt(60.0, -8.0, 2.9, 12.0), drive_.Now());
  const Pose<Odometry, Target> expected = Expected(60.0, -8.0, 2.9);
  EXPECT_LT((in_O.p_O - expected.origin().vector()).norm(), 0.01);
  EXPECT_NEAR(AngleDifference(in_O.yaw_rad, expected.yaw_rad()), 0.0, 1e-4);
  EXPECT_EQ(in_O.speed_mps, 12.0);
}

TEST_F(ToOdometryTest, HeightMovesNothingSideways) {
  const ClaimInOdometry low = alignment_.ToOdometry(ClaimAt(60.0, 5.0, 0.0, 0.0), drive_.Now());
  const ClaimInOdometry high =
      alignment_.ToOdometry(ClaimAt(60.0, 5.0, 0.0, 0.0, 4000.0), drive_.Now());
  EXPECT_LT((low.p_O - high.p_O).norm(), 1e-6);
}

TEST_F(ToOdometryTest, AgeIsMadeUpForAlongACurvedPath) {
  Claim claim = ClaimAt(40.0, 3.0, 0.5, 10.0);
  claim.accel_mps2 = 1.5;
  claim.yaw_rate_radps = 0.3;
  claim.age_s = 0.4;
  const ClaimInOdometry in_O = alignment_.ToOdometry(claim, claim.received + FromSeconds(0.6));
  // The same second integrated in very small steps.
  Eigen::Vector2d p = Expected(40.0, 3.0, 0.5).origin().vector();
  double yaw = Expected(40.0, 3.0, 0.5).yaw_rad();
  double speed = 10.0;
  for (int i = 0; i < 10000; ++i) {
    p += speed * 1e-4 * Eigen::Vector2d(std::cos(yaw), std::sin(yaw));
    yaw += 0.3 * 1e-4;
    speed += 1.5 * 1e-4;
  }
  EXPECT_LT((in_O.p_O - p).norm(), 0.02);
  EXPECT_NEAR(AngleDifference(in_O.yaw_rad, yaw), 0.0, 1e-3);
  EXPECT_NEAR(in_O.speed_mps, 11.5, 1e-9);
  EXPECT_EQ(in_O.stamp, claim.received + FromSeconds(0.6));
}

TEST_F(ToOdometryTest, BrakingEndsAtStandstill) {
  Claim claim = ClaimAt(40.0, 3.0, 0.5, 2.0);
  claim.accel_mps2 = -4.0;
  claim.age_s = 1.5;
  const ClaimInOdometry in_O = alignment_.ToOdometry(claim, claim.received);
  EXPECT_EQ(in_O.speed_mps, 0.0);
  const double way = (in_O.p_O - Expected(40.0, 3.0, 0.5).origin().vector()).norm();
  EXPECT_NEAR(way, 0.5, 0.03);  // v^2 / 2a.
}

TEST_F(ToOdometryTest, AReversingVehicleMovesBackwards) {
  Claim claim = ClaimAt(40.0, 3.0, 0.0, -3.0);
  claim.age_s = 1.0;
  const ClaimInOdometry in_O = alignment_.ToOdometry(claim, claim.received);
  EXPECT_LT((in_O.p_O - Expected(37.0, 3.0, 0.0).origin().vector()).norm(), 0.01);
}

TEST_F(ToOdometryTest, NoiseGrowsWithAgeAndTheAlignmentsShareWithDistance) {
  Claim claim = ClaimAt(50.0, 0.0, 0.3, 15.0);
  const ClaimInOdometry fresh = alignment_.ToOdometry(claim, claim.received);
  const ClaimInOdometry old = alignment_.ToOdometry(claim, claim.received + FromSeconds(1.0));
  EXPECT_GE(fresh.noise.trace(), 2.0);
  EXPECT_GT(old.noise.trace(), fresh.noise.trace() + 0.3);
  EXPECT_GT(old.yaw_sigma_rad, fresh.yaw_sigma_rad);
  EXPECT_GT(old.speed_sigma_mps, fresh.speed_sigma_mps);

  const ClaimInOdometry near = alignment_.ToOdometry(ClaimAt(5.0, 0.0, 0.3, 15.0), claim.received);
  const ClaimInOdometry far = alignment_.ToOdometry(ClaimAt(205.0, 0.0, 0.3, 15.0), claim.received);
  const double yaw_sigma = std::sqrt(alignment_.covariance()(2, 2));
  const double growth = far.alignment.trace() - near.alignment.trace();
  EXPECT_GT(growth, 0.5 * yaw_sigma * yaw_sigma * (205.0 * 205.0 - 5.0 * 5.0));
  // A yaw error moves a far point sideways, not along.
  const Eigen::Vector2d along = drive_.Ego().X_OB.rotation() * Eigen::Vector2d::UnitX();
  const Eigen::Vector2d across = drive_.Ego().X_OB.rotation() * Eigen::Vector2d::UnitY();
  EXPECT_GT(across.dot(far.alignment * across), along.dot(far.alignment * along) + 0.1);
}

TEST_F(ToOdometryTest, WithoutACourseTheClaimStaysAndItsNoiseCoversTheWay) {
  Claim claim = ClaimAt(50.0, 0.0, 0.3, 15.0);
  claim.has_course = false;
  claim.age_s = 1.0;
  const ClaimInOdometry in_O = alignment_.ToOdometry(claim, claim.received);
  EXPECT_FALSE(in_O.has_course);
  EXPECT_LT((in_O.p_O - Expected(50.0, 0.0, 0.0).origin().vector()).norm(), 0.01);
  EXPECT_GT(in_O.noise(0, 0), 15.0 * 15.0);
}

TEST_F(ToOdometryTest, GeodeticPlacesGoThereAndBack) {
  const Eigen::Vector2d p_O = Expected(123.0, -45.0, 0.0).origin().vector();
  const Wgs84 place = alignment_.ToGeodetic(p_O, 77.0);
  EXPECT_EQ(place.height_m, 77.0);
  Claim claim;
  claim.received = drive_.Now();
  claim.p_E = ToEcef(place).p_E;
  EXPECT_LT((alignment_.ToOdometry(claim, claim.received).p_O - p_O).norm(), 1e-6);
}

}  // namespace
}  // namespace v2vouch
