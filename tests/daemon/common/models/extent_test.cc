// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/models/extent.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "tests/daemon/common/models/random_scene.h"

namespace v2vouch {
namespace {

const double kLorry_m = ClassExtent(ObjectClass::kTruck).length_m;

ExtendedState LeadCar(ObjectClass object_class) {
  const Extent size = ClassExtent(object_class);
  ExtendedState state;
  state.mean << 40.0, 0.0, 0.0, 15.0, 0.0, 0.0, size.length_m, size.width_m;
  state.covariance = 0.01 * ExtendedState::Matrix::Identity();
  const double variance = size.length_sigma_m * size.length_sigma_m;
  state.covariance(ExtendedState::kLength, ExtendedState::kLength) = variance;
  state.covariance(ExtendedState::kWidth, ExtendedState::kWidth) =
      size.width_sigma_m * size.width_sigma_m;
  // Rear bumper known: the centre moves by half of the length.
  state.covariance(kX, kX) += 0.25 * variance;
  state.covariance(kX, ExtendedState::kLength) = 0.5 * variance;
  state.covariance(ExtendedState::kLength, kX) = 0.5 * variance;
  return state;
}

TEST(AssumeClass, NamingATruckMovesItsCentreAndKeepsItsRear) {
  ExtendedState state = LeadCar(ObjectClass::kUnknown);
  const double rear = state.mean[kX] - 0.5 * state.mean[ExtendedState::kLength];
  AssumeClass(ObjectClass::kUnknown, ObjectClass::kTruck, state);
  EXPECT_NEAR(state.mean[ExtendedState::kLength], kLorry_m, 1e-6);
  EXPECT_NEAR(state.mean[kX] - 0.5 * state.mean[ExtendedState::kLength], rear, 1e-6);
  EXPECT_NEAR(state.extent().length_sigma_m, 3.5, 1e-6);
  const Eigen::SelfAdjointEigenSolver<ExtendedState::Matrix> solver(state.covariance);
  EXPECT_GT(solver.eigenvalues().minCoeff(), 0.0);
}

TEST(AssumeClass, AMeasuredSizeOutweighsTheName) {
  ExtendedState state = LeadCar(ObjectClass::kUnknown);
  state.covariance(ExtendedState::kLength, ExtendedState::kLength) = 0.01;
  state.covariance(kX, ExtendedState::kLength) = 0.005;
  state.covariance(ExtendedState::kLength, kX) = 0.005;
  AssumeClass(ObjectClass::kUnknown, ObjectClass::kTruck, state);
  EXPECT_NEAR(state.mean[ExtendedState::kLength], 4.6, 0.05);
}

// A track of a lorry begins as one of a car whose middle reflects.
TEST(AssumeLongClass, KeepsTheNearFaceAndTiesTheCentreToTheLength) {
  ExtendedState state = LeadCar(ObjectClass::kUnknown);
  const double rear = state.mean[kX] - 0.5 * state.mean[ExtendedState::kLength];
  AssumeLongClass(ObjectClass::kTruck, Eigen::Vector2d::Zero(), state);
  const double length_variance = 3.5 * 3.5;
  EXPECT_NEAR(state.mean[ExtendedState::kLength], kLorry_m, 1e-9);
  EXPECT_NEAR(state.mean[kX] - 0.5 * kLorry_m, rear, 1e-9);
  EXPECT_NEAR(state.covariance(kX, ExtendedState::kLength), 0.5 * length_variance, 1e-9);
  // A better range of the face moves the whole lorry and leaves its length alone.
  Linearized face;
  face.y = Eigen::VectorXd::Constant(1, 1.0);
  face.H.setZero(1, kStateSize);
  face.H(0, kX) = 1.0;
  face.E.resize(1, 2);
  face.E << -0.5, 0.0;
  face.R = Eigen::MatrixXd::Constant(1, 1, 0.01);
  ASSERT_TRUE(UpdateExtended(face, state));
  EXPECT_NEAR(state.mean[kX] - 0.5 * kLorry_m, rear + 1.0, 0.02);
  EXPECT_NEAR(state.mean[ExtendedState::kLength], kLorry_m, 0.02);
  EXPECT_GT(std::sqrt(state.covariance(kX, kX)), 1.7);
}

TEST(PredictExtended, KeepsTheCentreTiedToTheLength) {
  ExtendedState state = LeadCar(ObjectClass::kCar);
  const double before = state.covariance(kX, ExtendedState::kLength);
  PredictExtended(state, 0.5, MotionNoise{});
  EXPECT_NEAR(state.mean[kX], 47.5, 1e-6);
  EXPECT_NEAR(state.covariance(kX, ExtendedState::kLength), before, 1e-9);
}

TEST(LinearizeSpan, ALongSideSeenBroadsideTeachesTheLength) {
  ExtendedState state = LeadCar(ObjectClass::kUnknown);
  state.mean[kX] = 30.0;
  state.mean[kYaw] = 0.5 * kPi;
  RadarConfig radar;
  radar.azimuth_sigma_rad = FromDegrees(0.3);
  RadarMeasurement z;
  z.returns = 8;
  z.azimuth_min_rad = -0.12;  // 7.2 m at 30 m.
  z.azimuth_max_rad = 0.12;
  z.radial_extent_m = 0.6;
  for (int i = 0; i < 200; ++i) {
    const auto span = LinearizeSpan(state, EgoState{}, radar, z);
    if (!span) break;
    ASSERT_TRUE(UpdateExtended(*span, state));
  }
  // What was seen, less the noise of the edges.
  EXPECT_GT(state.mean[ExtendedState::kLength], 6.0);
  EXPECT_LT(state.mean[ExtendedState::kLength], 7.2);
  // A part of the side teaches nothing.
  z.azimuth_max_rad = 0.0;
  EXPECT_FALSE(LinearizeSpan(state, EgoState{}, radar, z));
}

// Beside a lorry its flank fills far more of the view than its length over its distance.
TEST(LinearizeSpan, AFlankThatIsPassedCloselyLengthensNothing) {
  constexpr double kLong_m = 10.7;
  constexpr double kBeside_m = 2.5;
  RadarConfig radar;
  radar.azimuth_sigma_rad = FromDegrees(0.7);
  for (const double rear_m : {-9.0, -7.0, -5.0, -3.0, -1.0, 0.5}) {
    ExtendedState state = LeadCar(ObjectClass::kTruck);
    state.mean[ExtendedState::kLength] = kLong_m;
    state.mean[kX] = radar.x_m + rear_m + 0.5 * kLong_m;
    state.mean[kY] = radar.y_m + kBeside_m + 0.5 * state.mean[ExtendedState::kWidth];
    state.mean[kYaw] = 0.0;
    RadarMeasurement z;
    z.returns = 8;
    z.radial_extent_m = 4.0;
    z.azimuth_min_rad = std::atan2(kBeside_m, rear_m + kLong_m);
    z.azimuth_max_rad = std::atan2(kBeside_m, rear_m);
    EXPECT_FALSE(LinearizeSpan(state, EgoState{}, radar, z)) << rear_m;
    if (rear_m != -5.0) continue;
    // One that is shorter is lengthened still.
    state.mean[ExtendedState::kLength] = kLong_m - 4.0;
    const auto span = LinearizeSpan(state, EgoState{}, radar, z);
    ASSERT_TRUE(span);
    EXPECT_GT(span->y[1], 0.0);
  }
}

TEST(LinearizeSpan, SaysNothingForOneReturnOrObjects) {
  const ExtendedState state = LeadCar(ObjectClass::kCar);
  RadarMeasurement z;
  z.returns = 1;
  EXPECT_FALSE(LinearizeSpan(state, EgoState{}, RadarConfig{}, z));
  z.returns = 9;
  z.radial_extent_m = 12.0;
  EXPECT_TRUE(LinearizeSpan(state, EgoState{}, RadarConfig{}, z));
  z.is_object = true;
  EXPECT_FALSE(LinearizeSpan(state, EgoState{}, RadarConfig{}, z));
}

// The face that was measured stays; what was too short before grows away from the sensor.
TEST(Lengthen, GrowsAwayFromTheSensor) {
  ExtendedState lorry = LeadCar(ObjectClass::kTruck);
  const ExtendedState before = lorry;
  Lengthen(before.mean[ExtendedState::kLength] - 1.0, 1.0, Eigen::Vector2d::Zero(), lorry);
  EXPECT_EQ(lorry.mean, before.mean) << "It is longer already.";
  Lengthen(14.0, 1.5, Eigen::Vector2d::Zero(), lorry);
  EXPECT_DOUBLE_EQ(lorry.mean[ExtendedState::kLength], 14.0);
  const double face = before.mean[kX] - 0.5 * before.mean[ExtendedState::kLength];
  EXPECT_NEAR(lorry.mean[kX] - 7.0, face, 1e-9);
  EXPECT_GT(lorry.covariance(kX, ExtendedState::kLength),
            before.covariance(kX, ExtendedState::kLength));
}

// A radar that sees the front half of a passing car gets a mean half a length/2 ahead of that of
// the whole side: with the share known, the car must hardly follow and say that it is unsure.
TEST(UpdateExtended, PartlyVisibleSideDoesNotDragTheVehicle) {
  RadarConfig radar;
  radar.yaw_rad = 0.5 * kPi;
  ExtendedState start;
  start.mean << 0.0, 8.0, kPi, 10.0, 0.0, 0.0, 4.5, 1.8;
  start.covariance.setZero();
  start.covariance.diagonal() << 0.04, 0.04, 1e-4, 0.04, 1e-4, 0.01, 0.04, 0.01;
  RadarMeasurement z;
  z.returns = 4;
  z.covariance = Eigen::Vector3d(0.02, 1e-4, 0.01).asDiagonal();
  const Eigen::Vector2d half(-1.125, 7.1);
  z.range_m = half.norm();
  z.azimuth_rad = std::atan2(half.y(), half.x()) - radar.yaw_rad;
  z.range_rate_mps = -10.0 * half.x() / half.norm();
  double drag_m[2];
  double sigma_m[2];
  for (const bool is_known : {false, true}) {
    ExtendedState state = start;
    z.visible_share = is_known ? 0.5 : 1.0;
    for (int i = 0; i < 6; ++i) {
      const auto model = LinearizeRadar(state.mean.head<kStateSize>(), state.assumed_extent(),
                                        EgoState{}, radar, z);
      ASSERT_TRUE(model);
      ASSERT_TRUE(UpdateExtended(*model, state, false));
    }
    drag_m[is_known] = std::abs(state.mean[kX]);
    sigma_m[is_known] = std::sqrt(state.covariance(kX, kX));
  }
  EXPECT_GT(drag_m[0], 0.3);
  EXPECT_LT(drag_m[1], 0.5 * drag_m[0]);
  EXPECT_LT(drag_m[1], 2.5 * sigma_m[1]);
}

TEST(UpdateExtent, SilhouetteFromBehindTeachesTheWidthOnly) {
  Extent extent = ClassExtent(ObjectClass::kUnknown);
  const Extent before = extent;
  for (int i = 0; i < 50; ++i) UpdateExtent(2.3, 0.2, kPi, extent);
  EXPECT_NEAR(extent.width_m, 2.3, 0.1);
  EXPECT_LT(extent.width_sigma_m, 0.05);
  EXPECT_NEAR(extent.length_m, before.length_m, 1e-6);
}

}  // namespace
}  // namespace v2vouch
