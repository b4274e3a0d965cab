// SPDX-License-Identifier: Apache-2.0
#include "sim/annotation/projection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "daemon/local/camera/camera_preprocessing.h"

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

// Expected: cv::projectPoints of OpenCV 4.6 with the same intrinsics and distortion, the points
// turned into its axes by hand.
TEST(Projection, AgreesWithOpenCv) {
  CameraConfig camera;
  camera.x_m = 1.8;
  camera.y_m = 0.1;
  camera.z_m = 1.4;
  camera.fx_px = 1000;
  camera.fy_px = 900;
  camera.distortion = {-0.21, 0.043, 0.0017, -0.0011, 0.008};
  const struct {
    Eigen::Vector3d p_B;
    double u_px;
    double v_px;
  } cases[] = {{{20, 3, 0.2}, 481.523998175, 419.051964366},
               {{12, -5, 2.5}, 1113.051025377, 268.516876402},
               {{35, 0.5, 0}, 627.952509201, 397.945874321},
               {{8, 3.5, 1.9}, 123.791909481, 292.193135369}};
  for (const auto& each : cases) {
    const auto pixel = PixelOf(camera, each.p_B);
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x(), each.u_px, 1e-6);
    EXPECT_NEAR(pixel->y(), each.v_px, 1e-6);
  }
}

TEST(Projection, BehindTheCameraThereIsNothing) {
  const CameraConfig camera;
  EXPECT_FALSE(PixelOf(camera, {camera.x_m + 0.4, 0.0, 1.0}));
  EXPECT_FALSE(PixelOf(camera, {-30.0, 0.0, 1.0}));
}

}  // namespace
}  // namespace v2vouch::sim
