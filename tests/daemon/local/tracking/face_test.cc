// SPDX-License-Identifier: Apache-2.0
// Nothing of a vehicle lies before its near face, and nothing of it is a second vehicle.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "daemon/local/tracking/vehicle_filter.h"
#include "tests/daemon/local/tracking/scene.h"

namespace v2vouch {
namespace {

constexpr double kFace_m = 76.0;  // Of a standing lorry ahead, from the antenna.
constexpr double kDepth_m = 0.1;  // Mean depth of strong returns behind the outline.

RadarMeasurement FaceReturn(double range_m) {
  RadarMeasurement z;
  z.returns = 1;
  z.range_m = range_m;
  z.outline[z.outline_count++] = {range_m, 0.0, 40.0};
  z.covariance = Eigen::Vector3d(0.06, 1e-5, 0.02).asDiagonal();
  return z;
}

// Its place was once learnt without its length: the filter thinks that it knows the centre, six
// metres too far, and would have every range explain the length, which a radar may not learn.
BoxMeasurement LorryTooFar() {
  BoxMeasurement box;
  box.x_m = kFace_m + 0.5 * 8.3 + 6.3;
  box.y_m = 0.0;
  box.yaw_rad = 0.0;
  box.length_m = 11.0;
  box.width_m = 2.5;
  box.length_sigma_m = 3.5;
  box.position_covariance = 0.05 * Eigen::Matrix2d::Identity();
  return box;
}

// A radar at the ego's origin, looking ahead.
RadarConfig AtOrigin() {
  RadarConfig radar;
  radar.x_m = radar.y_m = radar.yaw_rad = 0.0;
  return radar;
}

class NearFaceTest : public ::testing::Test {
 protected:
  const RadarConfig radar_ = AtOrigin();
  const EgoState ego_;
  const RadarLook look{ego_, radar_};
};

double NearFace(const VehicleFilter& filter) {
  const ExtendedState& state = filter.best();
  return state.mean[kX] - 0.5 * state.mean[ExtendedState::kLength];
}

TEST_F(NearFaceTest, ReturnsBeforeItScanAfterScanBringAVehicleToWhereTheyAre) {
  VehicleFilter filter;
  filter.StartAt(LorryTooFar());
  for (int scan = 0; scan < 60; ++scan) {
    filter.Predict(0.05, {});
    ASSERT_TRUE(filter.Update(look, FaceReturn(kFace_m + kDepth_m), false, {}));
  }
  EXPECT_NEAR(NearFace(filter), kFace_m, 0.5);
}

// Seen obliquely, so that the length moves the centre across the line of sight as well.
TEST_F(NearFaceTest, TheCovarianceStaysPositiveHoweverOftenItIsSetAnew) {
  VehicleFilter filter;
  BoxMeasurement box = LorryTooFar();
  box.yaw_rad = 0.4;
  filter.StartAt(box);
  for (int scan = 0; scan < 200; ++scan) {
    filter.Predict(0.05, {});
    ASSERT_TRUE(filter.Update(look, FaceReturn(kFace_m - 4.0 * (scan / 40)), false, {}));
    const Eigen::SelfAdjointEigenSolver<ExtendedState::Matrix> parts(filter.best().covariance);
    ASSERT_GT(parts.eigenvalues().minCoeff(), 0.0) << scan;
  }
}

// A follower whose centre was learnt too near as it turned: its length would have to explain the
// rest, which a radar may not learn.
// Its near face 1.6 m nearer than the returns, which come towards the radar at `speed_mps`.
// @return how far its near face is off after three seconds.
double FaceError(const RadarLook& look, double speed_mps, double visible_share = 1.0) {
  double face_m = 30.0;
  PoseMeasurement pose;
  pose.x_m = face_m + 0.5 * 4.6 - 1.6;
  pose.y_m = 0.0;
  pose.yaw_rad = kPi;
  pose.speed_mps = speed_mps;
  pose.covariance =
      (Eigen::Matrix<double, 5, 1>() << 0.02, 0.02, 1e-3, 0.01, 1e-3).finished().asDiagonal();
  VehicleFilter filter;
  filter.StartAt(pose, {4.6, 1.85, 0.8, 0.2});
  for (int scan = 0; scan < 60; ++scan) {
    filter.Predict(0.05, {});
    face_m -= 0.05 * speed_mps;
    RadarMeasurement z = FaceReturn(face_m + kDepth_m);
    z.range_rate_mps = -speed_mps;
    z.visible_share = visible_share;
    EXPECT_TRUE(filter.Update(look, z, false, {}));
  }
  return NearFace(filter) - face_m;
}

TEST_F(NearFaceTest, ReturnsBehindItScanAfterScanMoveACarThatDrives) {
  EXPECT_NEAR(FaceError(look, 2.0), 0.0, 0.5);
}

// A part of another vehicle behind it shows the same returns in scan after scan.
TEST_F(NearFaceTest, ReturnsBehindItMoveNoCarThatHasStopped) {
  EXPECT_LT(FaceError(look, 0.0), -0.8);
}

// Its near face may be what cannot be seen.
TEST_F(NearFaceTest, ReturnsBehindItMoveNoCarThatIsPartlyHidden) {
  EXPECT_LT(FaceError(look, 2.0, 0.5), FaceError(look, 2.0) - 0.5);
}

// What covers it stands right before it: its returns are not the face.
TEST_F(NearFaceTest, ReturnsBeforeItMoveNoVehicleThatIsPartlyHidden) {
  VehicleFilter whole, standing, moving;
  whole.StartAt(LorryTooFar());
  standing = moving = whole;
  for (int scan = 0; scan < 60; ++scan) {
    RadarMeasurement z = FaceReturn(kFace_m + kDepth_m);
    for (VehicleFilter* filter : {&whole, &standing, &moving}) filter->Predict(0.05, {});
    ASSERT_TRUE(whole.Update(look, z, false, {}));
    z.visible_share = 0.4;
    ASSERT_TRUE(moving.Update(look, z, false, {}));
    z.visible_share = 0.6;
    z.is_static = true;
    ASSERT_TRUE(standing.Update(look, z, false, {}));
  }
  EXPECT_GT(NearFace(moving), NearFace(whole) + 0.5);
  EXPECT_GT(NearFace(standing), NearFace(whole) + 0.5);
}

// What bounces between a follower and the car comes back from twice as far: at next to no range
// rate it looks like its far end.
TEST(SecondEcho, LengthensNoCarThatFollows) {
  Scene scene(3);
  scene.ego.speed_mps = 10.0;
  scene.cars.push_back({.p_W = {12.5, 0.0}, .speed_mps = 10.0});
  Tracker tracker(TrackerConfig{}, scene.vehicle);
  double longest_m = 0.0;
  for (int step = 0; step < 400; ++step) {
    scene.Advance(0.05);
    auto scan = scene.Scan(0);
    const std::size_t own = scan.size();
    for (std::size_t j = 0; j < own; ++j) {
      RadarMeasurement& z = scan[j];
      if (z.outline_count == 0) z.outline[z.outline_count++] = {z.range_m, z.azimuth_rad, 40.0};
      RadarMeasurement echo = z;
      echo.range_m *= 2.0;
      echo.near_range_m *= 2.0;
      echo.range_rate_mps *= 2.0;
      for (std::size_t k = 0; k < echo.outline_count; ++k) {
        echo.outline[k].range_m *= 2.0;
        echo.outline[k].strength_db -= 20.0;
      }
      scan.push_back(echo);
    }
    scene.Radar(tracker, scan);
    if (const LocalTrack* track = Scene::Find(tracker, scene.cars[0], 6.0)) {
      longest_m = std::max(longest_m, track->extent.length_m);
    }
  }
  EXPECT_GT(longest_m, 3.0);
  EXPECT_LT(longest_m, 5.5);
}

TEST_F(NearFaceTest, ReturnsOutOfAnothersBoxMoveNoVehicle) {
  VehicleFilter own, anothers;
  own.StartAt(LorryTooFar());
  anothers = own;
  for (int scan = 0; scan < 60; ++scan) {
    RadarMeasurement z = FaceReturn(kFace_m + kDepth_m);
    own.Predict(0.05, {});
    anothers.Predict(0.05, {});
    ASSERT_TRUE(own.Update(look, z, false, {}));
    z.may_be_anothers = true;
    ASSERT_TRUE(anothers.Update(look, z, false, {}));
  }
  EXPECT_GT(NearFace(anothers), NearFace(own) + 0.5);
}

TEST_F(NearFaceTest, ScatterBehindItLeavesAVehicleWhereItIs) {
  VehicleFilter filter;
  BoxMeasurement box = LorryTooFar();
  box.x_m = kFace_m + 5.5;
  filter.StartAt(box);
  Random random(7);
  double nearest_m = 1e9;
  for (int scan = 0; scan < 400; ++scan) {
    filter.Predict(0.05, {});
    const double deep_m = std::abs(random.Normal(0.0, 0.3));
    ASSERT_TRUE(filter.Update(look, FaceReturn(kFace_m + deep_m), false, {}));
    nearest_m = std::min(nearest_m, NearFace(filter));
  }
  EXPECT_GT(nearest_m, kFace_m - 0.6);
}

}  // namespace
}  // namespace v2vouch
