// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/camera/camera_preprocessing.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <vector>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/random.h"

namespace v2vouch {
namespace {

// Where the camera sees a direction given in the levelled frame: the forward path, written from
// OpenCV's formulas and Eigen's rotations, independent of the code under test.
Eigen::Vector2d PixelOf(const CameraConfig& camera, double azimuth_rad, double depression_rad) {
  const Eigen::Vector3d level(std::cos(azimuth_rad) * std::cos(depression_rad),
                              std::sin(azimuth_rad) * std::cos(depression_rad),
                              -std::sin(depression_rad));
  const Eigen::Matrix3d mount = (Eigen::AngleAxisd(camera.pitch_rad, Eigen::Vector3d::UnitY()) *
                                 Eigen::AngleAxisd(camera.roll_rad, Eigen::Vector3d::UnitX()))
                                    .toRotationMatrix();
  const Eigen::Vector3d d = mount.transpose() * level;
  const double x = -d.y() / d.x();
  const double y = -d.z() / d.x();
  std::vector<double> k = camera.distortion;
  k.resize(5, 0.0);
  const double r2 = x * x + y * y;
  const double radial = 1.0 + k[0] * r2 + k[1] * r2 * r2 + k[4] * r2 * r2 * r2;
  const double xd = x * radial + 2.0 * k[2] * x * y + k[3] * (r2 + 2.0 * x * x);
  const double yd = y * radial + k[2] * (r2 + 2.0 * y * y) + 2.0 * k[3] * x * y;
  return {camera.fx_px * xd + camera.cx_px, camera.fy_px * yd + camera.cy_px};
}

CameraBox Box(double left, double top, double width, double height, double score = 0.9,
              ObjectClass object_class = ObjectClass::kCar) {
  return {left, top, width, height, object_class, score};
}

std::vector<CameraMeasurement> Process(const CameraConfig& camera, std::vector<CameraBox> boxes,
                                       int width_px = 1280, int height_px = 720) {
  CameraDetections detections;
  detections.camera = 1;
  detections.image_width_px = width_px;
  detections.image_height_px = height_px;
  detections.boxes = std::move(boxes);
  std::vector<CameraMeasurement> measurements(2);  // Left-overs must go.
  ProcessCamera(detections, camera, measurements);
  return measurements;
}

TEST(AnglesOfPixel, SignsAreLeftAndDown) {
  const CameraConfig camera;  // fx 1000, centre (640, 360).
  const auto centre = AnglesOfPixel(camera, 640.0, 360.0);
  EXPECT_DOUBLE_EQ(centre.azimuth_rad, 0.0);
  EXPECT_DOUBLE_EQ(centre.depression_rad, 0.0);
  EXPECT_NEAR(AnglesOfPixel(camera, 540.0, 360.0).azimuth_rad, std::atan(0.1), 1e-12);
  EXPECT_NEAR(AnglesOfPixel(camera, 640.0, 460.0).depression_rad, std::atan(0.1), 1e-12);
}

TEST(AnglesOfPixel, MountIsTakenOut) {
  CameraConfig camera;
  camera.pitch_rad =
      FromDegrees(5.0);  // Looking down: the picture's centre lies below the horizon.
  EXPECT_NEAR(AnglesOfPixel(camera, 640.0, 360.0).depression_rad, FromDegrees(5.0), 1e-12);
  camera.pitch_rad = 0.0;
  camera.roll_rad = FromDegrees(90.0);  // Right side down: the picture's right is below.
  const auto right = AnglesOfPixel(camera, 740.0, 360.0);
  EXPECT_NEAR(right.azimuth_rad, 0.0, 1e-12);
  EXPECT_NEAR(right.depression_rad, std::atan(0.1), 1e-12);
  camera.roll_rad = 0.0;
  camera.yaw_rad = 1.0;  // Bearings count from the camera's own axis.
  EXPECT_NEAR(AnglesOfPixel(camera, 640.0, 360.0).azimuth_rad, 0.0, 1e-12);
}

// Property: undistortion and levelling invert the forward model over the whole picture.
TEST(AnglesOfPixelProperty, InvertsTheForwardModel) {
  Random random(4);
  for (int trial = 0; trial < 2000; ++trial) {
    CameraConfig camera;
    camera.fy_px = 990.0;
    camera.pitch_rad = random.Uniform(-0.1, 0.1);
    camera.roll_rad = random.Uniform(-0.1, 0.1);
    camera.distortion = {random.Uniform(-0.35, 0.1), random.Uniform(-0.05, 0.1),
                         random.Uniform(-2e-3, 2e-3), random.Uniform(-2e-3, 2e-3),
                         random.Uniform(-0.02, 0.02)};
    if (trial % 4 == 0) camera.distortion.resize(static_cast<std::size_t>(trial / 4 % 5));
    const double azimuth = random.Uniform(-0.5, 0.5);
    const double depression = random.Uniform(-0.2, 0.25);
    const Eigen::Vector2d pixel = PixelOf(camera, azimuth, depression);
    const auto angles = AnglesOfPixel(camera, pixel.x(), pixel.y());
    ASSERT_NEAR(angles.azimuth_rad, azimuth, 1e-9) << "trial " << trial;
    ASSERT_NEAR(angles.depression_rad, depression, 1e-9) << "trial " << trial;
  }
}

TEST(AnglesOfPixel, StaysFiniteWhereTheLensModelCannotBeInverted) {
  CameraConfig camera;
  camera.distortion = {-0.4, 0.0};  // Folds back at r = 0.91; no ray reaches beyond 0.61.
  for (const double u : {-3000.0, 0.0, 5000.0, 1e9}) {
    const auto angles = AnglesOfPixel(camera, u, 100.0);
    EXPECT_TRUE(std::isfinite(angles.azimuth_rad) && std::isfinite(angles.depression_rad)) << u;
  }
  EXPECT_NEAR(AnglesOfPixel(camera, 5000.0, 360.0).azimuth_rad, -std::atan(4.36), 1e-9);
}

TEST(ProcessCamera, ReadsEdgesAndBottom) {
  const auto m = Process(CameraConfig{}, {Box(540.0, 300.0, 200.0, 100.0)});
  ASSERT_EQ(m.size(), 1U);
  EXPECT_EQ(m[0].camera, 1);
  EXPECT_NEAR(m[0].azimuth_left_rad, std::atan(0.1), 1e-12);
  EXPECT_NEAR(m[0].azimuth_right_rad, -std::atan(0.1), 1e-12);
  EXPECT_NEAR(m[0].depression_rad, std::atan(0.04), 1e-12);
  EXPECT_NEAR(m[0].azimuth_sigma_rad, 2.0 / 1000.0, 1e-6);
  // 2 px and 0.2 degrees of pitch.
  EXPECT_NEAR(m[0].depression_sigma_rad, std::hypot(0.002, FromDegrees(0.2)), 1e-5);
  EXPECT_FALSE(m[0].left_is_cut || m[0].right_is_cut || m[0].bottom_is_cut);
}

TEST(ProcessCamera, BordersAreFlaggedWithinTwoPixels) {
  const CameraConfig camera;
  const auto left = Process(camera, {Box(2.0, 300.0, 200.0, 100.0)}).at(0);
  EXPECT_TRUE(left.left_is_cut && !left.right_is_cut && !left.bottom_is_cut);
  EXPECT_FALSE(Process(camera, {Box(2.1, 300.0, 200.0, 100.0)}).at(0).left_is_cut);
  const auto corner = Process(camera, {Box(1100.0, 600.0, 300.0, 300.0)}).at(0);
  EXPECT_TRUE(!corner.left_is_cut && corner.right_is_cut && corner.bottom_is_cut);
  // Cut to the picture: no bearing from beyond its border.
  EXPECT_NEAR(corner.azimuth_right_rad, -std::atan(0.64), 1e-12);
}

TEST(ProcessCamera, ABottomBehindANearerBoxTellsNoRangeWhereAskedFor) {
  CameraConfig camera;
  const CameraBox far = Box(500.0, 350.0, 100.0, 60.0);            // Bottom at 410.
  const CameraBox near = Box(540.0, 380.0, 300.0, 200.0);          // Covers 60 % of it.
  EXPECT_FALSE(Process(camera, {far, near}).at(0).bottom_is_cut);  // Built in: believed.
  camera.covered_bottom_share = 0.5;
  const auto m = Process(camera, {far, near});
  EXPECT_TRUE(m.at(0).bottom_is_cut);
  EXPECT_FALSE(m.at(0).left_is_cut || m.at(0).right_is_cut);
  EXPECT_FALSE(m.at(1).bottom_is_cut);
  // Beside it, behind it, or too weak to be believed: nothing is covered.
  EXPECT_FALSE(Process(camera, {far, Box(601.0, 380.0, 300.0, 200.0)}).at(0).bottom_is_cut);
  EXPECT_FALSE(Process(camera, {far, Box(540.0, 300.0, 300.0, 100.0)}).at(0).bottom_is_cut);
  EXPECT_FALSE(Process(camera, {far, Box(540.0, 411.0, 300.0, 200.0)}).at(0).bottom_is_cut);
  EXPECT_FALSE(Process(camera, {far, Box(540.0, 380.0, 300.0, 200.0, 0.2)}).at(0).bottom_is_cut);
  camera.covered_bottom_share = 0.7;
  EXPECT_FALSE(Process(camera, {far, near}).at(0).bottom_is_cut);
}

TEST(ProcessCamera, SkipsWhatCannotBeABox) {
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(Process(CameraConfig{},
                      {Box(100, 100, 0, 50), Box(100, 100, 50, -1), Box(kNaN, 100, 50, 50),
                       Box(100, kNaN, 50, 50), Box(100, 100, kNaN, 50), Box(100, 100, 50, inf),
                       Box(-60, 100, 50, 50), Box(1281, 100, 50, 50), Box(100, 721, 50, 50),
                       Box(100, 100, 50, 50, 0.29), Box(100, 100, 50, 50, kNaN)})
                  .empty());
}

TEST(ProcessCamera, KeepsOrderClassAndScore) {
  const auto m = Process(
      CameraConfig{}, {Box(700, 300, 20, 50, 0.5, ObjectClass::kPedestrian),
                       Box(10, 300, 20, 50, 0.1), Box(300, 300, 20, 50, 0.8, ObjectClass::kCyclist),
                       Box(400, 300, 90, 90, 0.3, ObjectClass::kTruck)});
  ASSERT_EQ(m.size(), 3U);
  EXPECT_EQ(m[0].object_class, ObjectClass::kPedestrian);
  EXPECT_DOUBLE_EQ(m[0].score, 0.5);
  EXPECT_EQ(m[1].object_class, ObjectClass::kCyclist);
  EXPECT_EQ(m[2].object_class, ObjectClass::kTruck);
}

TEST(ProcessCamera, APictureOfAnotherSizeIsScaled) {
  const auto full = Process(CameraConfig{}, {Box(540.0, 300.0, 200.0, 100.0)}).at(0);
  const auto half = Process(CameraConfig{}, {Box(270.0, 150.0, 100.0, 50.0)}, 640, 360).at(0);
  EXPECT_DOUBLE_EQ(full.azimuth_left_rad, half.azimuth_left_rad);
  EXPECT_DOUBLE_EQ(full.depression_rad, half.depression_rad);
}

TEST(ProcessCamera, WhatIsAsLowAsACarIsNoLorryWhateverItIsCalled) {
  const CameraConfig camera;  // Level, so that heights follow from the rows.
  const auto named = [&](double height_m, double range_m, ObjectClass object_class) {
    const double foot_px = camera.cy_px + camera.fy_px * camera.z_m / range_m;
    const double top_px = foot_px - camera.fy_px * height_m / range_m;
    CameraDetections detections;
    detections.boxes = {Box(600.0, top_px, 90.0, foot_px - top_px, 0.9, object_class)};
    std::vector<CameraMeasurement> m;
    ProcessCamera(detections, camera, m);
    return m.at(0).object_class;
  };
  EXPECT_EQ(named(1.45, 15.0, ObjectClass::kTruck), ObjectClass::kCar);
  EXPECT_EQ(named(1.45, 15.0, ObjectClass::kBus), ObjectClass::kCar);
  EXPECT_EQ(named(3.5, 15.0, ObjectClass::kTruck), ObjectClass::kTruck);
  EXPECT_EQ(named(1.45, 15.0, ObjectClass::kVan), ObjectClass::kVan);
  // Far away a row is worth too much.
  EXPECT_EQ(named(2.2, 80.0, ObjectClass::kTruck), ObjectClass::kTruck);
}

}  // namespace
}  // namespace v2vouch
