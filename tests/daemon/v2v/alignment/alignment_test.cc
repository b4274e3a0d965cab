// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/alignment/alignment.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>

#include "tests/daemon/v2v/alignment/simulated_drive.h"

namespace v2vouch {
namespace {

const Wgs84 kTown{FromDegrees(48.1372), FromDegrees(11.5756), 0.0};

DriveErrors RealisticErrors() {
  DriveErrors errors;
  errors.speed_scale = 0.005;
  errors.yaw_rate_bias_radps = FromDegrees(0.05);
  errors.bias_en = {0.7, -0.7};  // 1 m in all.
  errors.markov_sigma_m = 0.2;
  errors.markov_time_s = 30.0;
  errors.white_sigma_m = 0.05;
  errors.velocity_sigma_mps = 0.1;
  return errors;
}

// Drives steadily for `seconds` with ten fixes a second.
void Drive(SimulatedDrive& drive, Alignment& alignment, const VehicleConfig& vehicle,
           double speed_mps, double yaw_rate_radps, double seconds) {
  for (int i = 0; i < static_cast<int>(std::lround(seconds * 10.0)); ++i) {
    drive.Advance(speed_mps, yaw_rate_radps, 0.1);
    const GnssFix fix = drive.Fix(vehicle);
    alignment.OnFix(fix, drive.Ego());
  }
}

TEST(Alignment, WaitsForAYawSourceWhileStanding) {
  const VehicleConfig vehicle;
  SimulatedDrive drive(kTown, 0.4, {});
  Alignment alignment(AlignmentConfig{}, vehicle);
  Drive(drive, alignment, vehicle, 0.0, 0.0, 5.0);
  EXPECT_FALSE(alignment.is_ready());
  Drive(drive, alignment, vehicle, 0.3, 0.0, 5.0);  // Too slow for a direction.
  EXPECT_FALSE(alignment.is_ready());
  Drive(drive, alignment, vehicle, 8.0, 0.0, 0.1);
  EXPECT_TRUE(alignment.is_ready());
  EXPECT_LT(drive.ErrorOf(alignment).norm(), 1e-3);
}

TEST(Alignment, StartsAtStandstillWithAHeading) {
  const VehicleConfig vehicle;
  SimulatedDrive drive(kTown, -2.0, {});
  Alignment alignment(AlignmentConfig{}, vehicle);
  drive.Advance(0.0, 0.0, 0.1);
  GnssFix fix = drive.Fix(vehicle);
  fix.yaw_rad = -2.0;
  fix.yaw_sigma_rad = 0.01;
  EXPECT_EQ(alignment.OnFix(fix, drive.Ego()), std::nullopt);
  EXPECT_TRUE(alignment.is_ready());
  EXPECT_LT(drive.ErrorOf(alignment).norm(), 1e-6);
}

TEST(Alignment, StartsFromPositionsAloneAfterSomeWay) {
  const VehicleConfig vehicle;
  DriveErrors errors;
  errors.white_sigma_m = 0.3;
  SimulatedDrive drive(kTown, 1.0, errors);
  Alignment alignment(AlignmentConfig{}, vehicle);
  for (int i = 0; i < 600; ++i) {
    drive.Advance(10.0, 0.0, 0.1);
    GnssFix fix = drive.Fix(vehicle);
    fix.velocity_en_mps.reset();
    alignment.OnFix(fix, drive.Ego());
    if (i == 3) {  // 4 m.
      EXPECT_FALSE(alignment.is_ready());
    }
  }
  ASSERT_TRUE(alignment.is_ready());
  EXPECT_LT(drive.ErrorOf(alignment).head<2>().norm(), 0.5);
  EXPECT_LT(std::abs(drive.ErrorOf(alignment)(2)), 0.02);
}

TEST(Alignment, AnExactReceiverGivesAnExactAlignmentInTurnsAndInReverse) {
  VehicleConfig vehicle;
  vehicle.antenna_x_m = 2.2;
  vehicle.antenna_y_m = -0.6;
  SimulatedDrive drive(kTown, 2.5, {});
  Alignment alignment(AlignmentConfig{}, vehicle);
  Drive(drive, alignment, vehicle, 8.0, 0.4, 10.0);
  EXPECT_LT(drive.ErrorOf(alignment).norm(), 1e-3);
  Drive(drive, alignment, vehicle, -5.0, 0.2, 10.0);
  EXPECT_LT(drive.ErrorOf(alignment).norm(), 1e-3);
  EXPECT_FALSE(alignment.is_suspect());
}

// The drift that was estimated against GNSS must not be taken off twice.
TEST(Alignment, WhatOdometryLearnsIsNoLongerLeftForIt) {
  const VehicleConfig vehicle;
  DriveErrors errors;
  errors.yaw_rate_bias_radps = FromDegrees(0.5);
  errors.speed_scale = 0.03;
  errors.white_sigma_m = 0.05;
  errors.velocity_sigma_mps = 0.1;
  SimulatedDrive drive(kTown, 0.3, errors);
  Alignment alignment(AlignmentConfig{}, vehicle);
  Drive(drive, alignment, vehicle, 10.0, 0.0, 60.0);
  Drive(drive, alignment, vehicle, 0.0, 0.0, 5.0);
  drive.LearnOdometry();
  Drive(drive, alignment, vehicle, 0.0, 0.0, 1.0);
  double worst_rad = 0.0;
  double worst_m = 0.0;
  for (int i = 0; i < 20; ++i) {
    Drive(drive, alignment, vehicle, 10.0, 0.0, 0.5);
    worst_rad = std::max(worst_rad, std::abs(drive.ErrorOf(alignment)(2)));
    worst_m = std::max(worst_m, drive.ErrorOf(alignment).head<2>().norm());
  }
  EXPECT_LT(ToDegrees(worst_rad), 0.6);
  EXPECT_LT(worst_m, 0.3);
}

TEST(Alignment, StartsInReverse) {
  const VehicleConfig vehicle;
  SimulatedDrive drive(kTown, 0.3, {});
  Alignment alignment(AlignmentConfig{}, vehicle);
  Drive(drive, alignment, vehicle, -4.0, 0.0, 1.0);
  ASSERT_TRUE(alignment.is_ready());
  EXPECT_LT(drive.ErrorOf(alignment).norm(), 1e-3);
}

TEST(Alignment, LatencyIsTakenFromTheStamp) {
  VehicleConfig vehicle;
  vehicle.gnss_latency_s = 0.06;  // Measured on a u-blox receiver in a real car.
  const Alignment alignment(AlignmentConfig{}, vehicle);
  GnssFix fix;
  fix.stamp = FromMicros(5'000'000);
  EXPECT_EQ(alignment.FixTime(fix), FromMicros(4'940'000));
}

// Ten minutes of town and country: the true errors must be what the covariance says.
TEST(Alignment, StaysWithinItsOwnSigmaOverTenMinutes) {
  const VehicleConfig vehicle;
  double nees_sum = 0.0;
  double worst_nees = 0.0;
  double position_squares = 0.0;
  double yaw_squares = 0.0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SimulatedDrive drive(kTown, 0.7, RealisticErrors(), seed);
    Alignment alignment(AlignmentConfig{}, vehicle);
    for (int i = 0; i < 6000; ++i) {
      // 40 s of driving with bends, 20 s of standing, again and again.
      const double phase = std::fmod(0.1 * i, 60.0);
      const double speed = phase < 40.0 ? std::min({15.0, 3.0 * phase, 3.0 * (40.0 - phase)}) : 0.0;
      const double yaw_rate = speed > 5.0 ? 0.15 * std::sin(0.1 * i / 7.0) : 0.0;
      drive.Advance(speed, yaw_rate, 0.1);
      EXPECT_EQ(alignment.OnFix(drive.Fix(vehicle), drive.Ego()), std::nullopt) << "at " << 0.1 * i;
      if (!alignment.is_ready() || i < 300) continue;
      const Eigen::Vector3d error = drive.ErrorOf(alignment);
      Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
      P.topLeftCorner<2, 2>() = alignment.CovarianceAt(drive.Ego().X_OB.origin().vector());
      P(2, 2) = alignment.covariance()(2, 2);
      const double nees = error.dot(P.ldlt().solve(error));
      nees_sum += nees;
      worst_nees = std::max(worst_nees, nees);
      position_squares += error.head<2>().squaredNorm();
      yaw_squares += error(2) * error(2);
      ++count;
      ASSERT_LT(error.head<2>().norm(), 3.0 * std::sqrt(P.topLeftCorner<2, 2>().trace()));
      ASSERT_LT(std::abs(error(2)), 3.0 * std::sqrt(P(2, 2)));
      // The slow part of a receiver's error is never averaged away.
      ASSERT_GT(P(0, 0), 0.64);
      ASSERT_GT(P(2, 2), 0.003 * 0.003);
    }
  }
  RecordProperty("position_rms_m", std::to_string(std::sqrt(position_squares / count)));
  RecordProperty("yaw_rms_deg", std::to_string(ToDegrees(std::sqrt(yaw_squares / count))));
  RecordProperty("mean_nees", std::to_string(nees_sum / count));
  RecordProperty("worst_nees", std::to_string(worst_nees));
  EXPECT_LT(nees_sum / count, 5.0);  // 3 when consistent; the 1 m bias is fixed, not drawn.
  EXPECT_LT(worst_nees, 14.16);      // 99.7 % of chi-square with 3 degrees of freedom.
  EXPECT_LT(std::sqrt(position_squares / count), 1.2);  // 1.0 m of it is the receiver's bias.
  EXPECT_LT(ToDegrees(std::sqrt(yaw_squares / count)), 0.3);
}

// O turns by the gyro's bias while the car stands: the car's own place and direction stay.
TEST(Alignment, DirectionIsHeldAtStandstillHoweverLong) {
  const VehicleConfig vehicle;
  SimulatedDrive drive(kTown, 0.7, RealisticErrors(), 3);
  Alignment alignment(AlignmentConfig{}, vehicle);
  Drive(drive, alignment, vehicle, 12.0, 0.0, 60.0);
  Drive(drive, alignment, vehicle, 0.0, 0.0, 0.1);
  const Pose<LocalEnu, Body> before = alignment.X_LO() * drive.Ego().X_OB;
  Drive(drive, alignment, vehicle, 0.0, 0.0, 600.0);
  const Pose<LocalEnu, Body> after = alignment.X_LO() * drive.Ego().X_OB;
  EXPECT_NEAR(AngleDifference(after.yaw_rad(), before.yaw_rad()), 0.0, 1e-9);
  EXPECT_LT((after.origin().vector() - before.origin().vector()).norm(), 0.5);
  EXPECT_GT(alignment.CovarianceAt(drive.Ego().X_OB.origin().vector())(0, 0), 0.64);
}

TEST(Alignment, AStandingCarDoesNotFollowAJumpOfItsReceiver) {
  const VehicleConfig vehicle;
  DriveErrors errors = RealisticErrors();
  errors.yaw_rate_bias_radps = 0.0;
  SimulatedDrive drive(kTown, 0.7, errors, 4);
  Alignment alignment(AlignmentConfig{}, vehicle);
  Drive(drive, alignment, vehicle, 12.0, 0.0, 30.0);
  Drive(drive, alignment, vehicle, 0.0, 0.0, 30.0);
  const EgoState ego = drive.Ego();
  const Point<Odometry> far = ego.X_OB * Point<Body>{80.0, 20.0};  // Where a vehicle may be.
  const Eigen::Vector2d before = (alignment.X_LO() * far).vector();
  drive.jump_en = {30.0, 40.0};
  for (int i = 0; i < 1200; ++i) {
    drive.Advance(0.0, 0.0, 0.1);
    EXPECT_EQ(alignment.OnFix(drive.Fix(vehicle), drive.Ego()), Reason::kGnssJump);
    ASSERT_TRUE(alignment.is_suspect());
    ASSERT_LT(((alignment.X_LO() * far).vector() - before).norm(), 1.0);
  }
  // The receiver finds back: a second of agreement thaws the estimate.
  drive.jump_en.setZero();
  Drive(drive, alignment, vehicle, 0.0, 0.0, 0.8);
  EXPECT_TRUE(alignment.is_suspect());
  Drive(drive, alignment, vehicle, 0.0, 0.0, 0.6);
  EXPECT_FALSE(alignment.is_suspect());
  EXPECT_LT(((alignment.X_LO() * far).vector() - before).norm(), 1.0);
}

TEST(Alignment, ADrivingCarMovesToANewPlaceThatHoldsForTenSeconds) {
  const VehicleConfig vehicle;
  SimulatedDrive drive(kTown, 0.7, {}, 5);
  Alignment alignment(AlignmentConfig{}, vehicle);
  Drive(drive, alignment, vehicle, 12.0, 0.0, 30.0);
  drive.jump_en = {30.0, 40.0};
  Drive(drive, alignment, vehicle, 12.0, 0.05, 9.5);
  EXPECT_LT(drive.ErrorOf(alignment).head<2>().norm(), 0.1);  // Dead reckoning carries it.
  EXPECT_TRUE(alignment.is_suspect());
  Drive(drive, alignment, vehicle, 12.0, 0.05, 1.5);
  EXPECT_NEAR(drive.ErrorOf(alignment).head<2>().norm(), 50.0, 0.5);
  EXPECT_TRUE(alignment.is_suspect());  // Kept for as long again.
  Drive(drive, alignment, vehicle, 12.0, 0.05, 8.0);
  EXPECT_TRUE(alignment.is_suspect());
  Drive(drive, alignment, vehicle, 12.0, 0.05, 3.0);
  EXPECT_FALSE(alignment.is_suspect());
}

TEST(Alignment, AVouchedForPlaceIsNotGivenUp) {
  const VehicleConfig vehicle;
  SimulatedDrive drive(kTown, 0.7, {}, 6);
  Alignment alignment(AlignmentConfig{}, vehicle);
  Drive(drive, alignment, vehicle, 12.0, 0.0, 30.0);
  drive.jump_en = {30.0, 40.0};
  for (int i = 0; i < 30; ++i) {
    alignment.Vouch(drive.Now());
    Drive(drive, alignment, vehicle, 12.0, 0.02, 1.0);
    ASSERT_LT(drive.ErrorOf(alignment).head<2>().norm(), 0.5);
  }
  Drive(drive, alignment, vehicle, 12.0, 0.02, 6.0);  // Nobody vouches any longer.
  EXPECT_NEAR(drive.ErrorOf(alignment).head<2>().norm(), 50.0, 0.5);
}

TEST(Alignment, OneWildFixMovesNothing) {
  const VehicleConfig vehicle;
  SimulatedDrive drive(kTown, 0.7, {}, 7);
  Alignment alignment(AlignmentConfig{}, vehicle);
  Drive(drive, alignment, vehicle, 12.0, 0.0, 30.0);
  drive.jump_en = {7000.0, 0.0};  // Even beyond the next anchor.
  Drive(drive, alignment, vehicle, 12.0, 0.0, 0.1);
  EXPECT_LT(drive.ErrorOf(alignment).norm(), 0.01);
  EXPECT_TRUE(alignment.is_suspect());
}

TEST(Alignment, ANewAnchorLeavesEverythingInPlace) {
  const VehicleConfig vehicle;
  SimulatedDrive drive({FromDegrees(64.1), FromDegrees(-21.9), 0.0}, 0.2, {}, 8);
  AlignmentConfig config;
  Alignment alignment(config, vehicle);
  int anchors = 0;
  for (int i = 0; i < 12000; ++i) {  // 36 km.
    drive.Advance(30.0, 0.0, 0.1);
    const Alignment before = alignment;
    const EgoState ego = drive.Ego();
    alignment.OnFix(drive.Fix(vehicle), ego);
    if (!before.is_ready()) continue;
    if (before.plane().origin() == alignment.plane().origin()) continue;
    ++anchors;
    // Claims all round the car, through the old plane and the new one.
    for (double bearing = 0.0; bearing < 6.0; bearing += 0.7) {
      const Wgs84 place =
          LocalPlane(alignment.ToGeodetic(ego.X_OB.origin().vector(), 0.0))
              .ToGeodetic(LocalPoint{{300.0 * std::cos(bearing), 300.0 * std::sin(bearing), 12.0}});
      Claim claim;
      claim.received = ego.stamp;
      claim.p_E = ToEcef(place).p_E;
      claim.course_E = EastNorthUp(place).col(1);
      // Exact receiver and odometry: before and after see the same world but for rounding.
      const ClaimInOdometry was = before.ToOdometry(claim, ego.stamp);
      const ClaimInOdometry is = alignment.ToOdometry(claim, ego.stamp);
      EXPECT_LT((was.p_O - is.p_O).norm(), 1e-3);
      EXPECT_NEAR(AngleDifference(was.yaw_rad, is.yaw_rad), 0.0, 1e-5);
    }
    EXPECT_LT((alignment.X_LO() * ego.X_OB).origin().vector().norm(), 1000.0);
  }
  EXPECT_GE(anchors, 5);
  EXPECT_LT(drive.ErrorOf(alignment).norm(), 0.05);
}

TEST(Alignment, TheAnchorDoesNotDependOnWhichFixCameFirst) {
  const VehicleConfig vehicle;
  SimulatedDrive drive(kTown, 0.2, {}, 8);
  Alignment early(AlignmentConfig{}, vehicle);
  Alignment late(AlignmentConfig{}, vehicle);
  for (int i = 0; i < 50; ++i) {
    drive.Advance(10.0, 0.0, 0.1);
    const GnssFix fix = drive.Fix(vehicle);
    early.OnFix(fix, drive.Ego());
    if (i > 20) late.OnFix(fix, drive.Ego());
  }
  ASSERT_TRUE(late.is_ready());
  EXPECT_EQ(early.plane().origin(), late.plane().origin());
}

TEST(Alignment, UnusableFixesAreRefusedAndChangeNothing) {
  const VehicleConfig vehicle;
  SimulatedDrive drive(kTown, 0.2, {}, 9);
  Alignment alignment(AlignmentConfig{}, vehicle);
  Drive(drive, alignment, vehicle, 10.0, 0.0, 3.0);
  const Pose<LocalEnu, Odometry> before = alignment.X_LO();
  const EgoState ego = drive.Ego();
  const auto refused = [&](auto spoil) {
    GnssFix fix = drive.Fix(vehicle);
    spoil(fix);
    return alignment.OnFix(fix, ego);
  };
  EXPECT_EQ(refused([](GnssFix& f) { f.fix_type = FixType::kNone; }), Reason::kGnssUnusable);
  EXPECT_EQ(refused([](GnssFix& f) { f.position.latitude_rad = kNaN; }), Reason::kGnssUnusable);
  EXPECT_EQ(refused([](GnssFix& f) { f.position.longitude_rad = 1e300; }), Reason::kGnssUnusable);
  EXPECT_EQ(refused([](GnssFix& f) { f.position.height_m = -INFINITY; }), Reason::kGnssUnusable);
  EXPECT_EQ(refused([](GnssFix& f) { f.covariance_enu(0, 1) = kNaN; }), Reason::kGnssUnusable);
  EXPECT_EQ(refused([](GnssFix& f) { f.covariance_enu(0, 0) = -1.0; }), Reason::kGnssUnusable);
  EXPECT_EQ(refused([](GnssFix& f) { f.covariance_enu(0, 1) = f.covariance_enu(1, 0) = 9.0; }),
            Reason::kGnssUnusable);
  EXPECT_EQ(refused([](GnssFix& f) { f.covariance_enu *= 1e6; }), Reason::kGnssUnusable);
  EXPECT_EQ(alignment.X_LO(), before);
  // A receiver without accuracy figures, or with boastful ones, is usable but not believed.
  EXPECT_EQ(refused([](GnssFix& f) { f.covariance_enu.setZero(); }), std::nullopt);
  EXPECT_EQ(refused([](GnssFix& f) { f.covariance_enu *= 1e-12; }), std::nullopt);
  EXPECT_EQ(refused([](GnssFix& f) {
              f.velocity_en_mps = Eigen::Vector2d(kNaN, 0.0);
              f.velocity_sigma_mps = kNaN;
              f.yaw_rad = kNaN;
            }),
            std::nullopt);
}

TEST(Alignment, AFixOlderThanTheLastOneIsRefused) {
  const VehicleConfig vehicle;
  SimulatedDrive drive(kTown, 0.2, {}, 9);
  Alignment alignment(AlignmentConfig{}, vehicle);
  drive.Advance(10.0, 0.0, 0.1);
  const EgoState old_ego = drive.Ego();
  const GnssFix old_fix = drive.Fix(vehicle);
  Drive(drive, alignment, vehicle, 10.0, 0.0, 1.0);
  EXPECT_EQ(alignment.OnFix(old_fix, old_ego), Reason::kTooOld);
}

TEST(Alignment, ACopyIsACheckpoint) {
  const VehicleConfig vehicle;
  SimulatedDrive drive(kTown, 0.2, RealisticErrors(), 10);
  Alignment alignment(AlignmentConfig{}, vehicle);
  Drive(drive, alignment, vehicle, 10.0, 0.1, 20.0);
  Alignment copy = alignment;
  SimulatedDrive again = drive;
  Drive(drive, alignment, vehicle, 10.0, -0.1, 20.0);
  Drive(again, copy, vehicle, 10.0, -0.1, 20.0);
  EXPECT_EQ(copy.X_LO(), alignment.X_LO());
  EXPECT_EQ(copy.covariance(), alignment.covariance());
}

}  // namespace
}  // namespace v2vouch
