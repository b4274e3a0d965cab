// SPDX-License-Identifier: Apache-2.0
#include "sim/annotation/projection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <random>

#include "daemon/preprocessing/camera/camera_preprocessing.h"

namespace v2vouch::sim {
namespace {

CameraConfig RandomCamera(std::mt19937_64& rng) {
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  CameraConfig camera;
  camera.x_m = 1.5 + u(rng);
  camera.y_m = 0.5 * u(rng);
  camera.z_m = 1.5 + 0.5 * u(rng);
  camera.yaw_rad = 0.5 * u(rng);
  camera.pitch_rad = 0.1 * u(rng);
  camera.roll_rad = 0.1 * u(rng);
  camera.distortion = {-0.2 * std::abs(u(rng)), 0.05 * u(rng), 0.002 * u(rng), 0.002 * u(rng),
                       0.01 * u(rng)};
  return camera;
}

// The daemon's way back from a pixel must lead along the ray to the point: bearing and depression
// in the camera's levelled frame are those of plain geometry.
TEST(Projection, IsTheInverseOfTheDaemonsUndistortion) {
  std::mt19937_64 rng(20240611);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  for (int trial = 0; trial < 300; ++trial) {
    const CameraConfig camera = RandomCamera(rng);
    const double bearing = 0.4 * u(rng);
    const double distance_m = 25.0 + 20.0 * u(rng);
    const double yaw = camera.yaw_rad + bearing;
    const Eigen::Vector3d p(camera.x_m + distance_m * std::cos(yaw),
                            camera.y_m + distance_m * std::sin(yaw), 0.0);
    const auto pixel = PixelOf(camera, p);
    ASSERT_TRUE(pixel);
    const PixelAngles angles = AnglesOfPixel(camera, pixel->x(), pixel->y());
    EXPECT_NEAR(angles.azimuth_rad, bearing, 1e-8) << "trial " << trial;
    EXPECT_NEAR(angles.depression_rad, std::atan2(camera.z_m, distance_m), 1e-8);
  }
}

TEST(Projection, AgreesWithOpenCv) {
  std::mt19937_64 rng(7);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  for (int trial = 0; trial < 100; ++trial) {
    CameraConfig camera = RandomCamera(rng);
    camera.yaw_rad = camera.pitch_rad = camera.roll_rad = 0.0;
    const Eigen::Vector3d p(20.0 + 10.0 * u(rng), 5.0 * u(rng), 1.0 + u(rng));
    const cv::Matx33d K(camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1);
    // OpenCV's axes: x right, y down, z ahead.
    const std::vector<cv::Point3d> points = {
        {-(p.y() - camera.y_m), -(p.z() - camera.z_m), p.x() - camera.x_m}};
    std::vector<cv::Point2d> pixels;
    cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), K, camera.distortion, pixels);
    const auto ours = PixelOf(camera, p);
    ASSERT_TRUE(ours);
    EXPECT_NEAR(ours->x(), pixels[0].x, 1e-6);
    EXPECT_NEAR(ours->y(), pixels[0].y, 1e-6);
  }
}

TEST(Projection, BehindTheCameraThereIsNothing) {
  const CameraConfig camera;
  EXPECT_FALSE(PixelOf(camera, {camera.x_m + 0.4, 0.0, 1.0}));
  EXPECT_FALSE(PixelOf(camera, {-30.0, 0.0, 1.0}));
}

}  // namespace
}  // namespace v2vouch::sim
