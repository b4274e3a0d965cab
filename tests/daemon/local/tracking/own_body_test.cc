// SPDX-License-Identifier: Apache-2.0
// Water on a radome, a tow bar, a bicycle rack: what is always at the car itself is no vehicle, and
// neither is what a camera sees another vehicle through. A car at the bumper is one.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "daemon/common/base/angle.h"
#include "tests/daemon/local/tracking/scene.h"

namespace v2vouch {
namespace {

constexpr double kStep_s = 0.05;

/// One return at the radar itself in every scan.
struct Ghost {
  double range_m = 0.6;
  double azimuth_rad = 0.0;
  double range_sigma_m = 0.05;
  double azimuth_sigma_rad = 0.05;
  double rate_sigma_mps = 0.0;  ///< Of its range rate, which is 0 on the average.
};

RadarMeasurement GhostReturn(const Scene& scene, const Ghost& ghost, Random& random) {
  const RadarConfig& radar = scene.vehicle.radars[0];
  RadarMeasurement z;
  z.range_m = std::max(0.3, ghost.range_m + random.Normal(0.0, ghost.range_sigma_m));
  z.azimuth_rad = ghost.azimuth_rad + random.Normal(0.0, ghost.azimuth_sigma_rad);
  z.range_rate_mps = random.Normal(0.0, ghost.rate_sigma_mps);
  const double bearing = z.azimuth_rad + radar.yaw_rad;
  z.ground_range_rate_mps = z.range_rate_mps + scene.ego.speed_mps * std::cos(bearing);
  z.is_static = std::abs(z.ground_range_rate_mps) < 0.6;
  z.covariance =
      Eigen::Vector3d(std::pow(radar.range_sigma_m, 2), std::pow(radar.azimuth_sigma_rad, 2),
                      std::pow(radar.range_rate_sigma_mps, 2))
          .asDiagonal();
  z.near_range_m = z.range_m;
  z.azimuth_min_rad = z.azimuth_max_rad = z.azimuth_rad;
  return z;
}

/// Counts published tracks that are no car of the scene.
int FalseTracks(const Scene& scene, const Tracker& tracker) {
  int count = 0;
  for (const LocalTrack& track : tracker.tracks()) {
    if (!track.is_confirmed) continue;
    bool is_real = false;
    for (const Car& car : scene.cars) {
      is_real = is_real || (track.state_O.mean.head<2>() - car.p_W).norm() < 4.0;
    }
    if (!is_real) ++count;
  }
  return count;
}

struct Drive {
  int lists = 0;
  int false_tracks = 0;
  int lead_missing = 0;  ///< After the first second.
};

Drive RunDrive(Scene& scene, const Ghost& ghost, bool with_camera, double duration_s,
               const std::function<void(double)>& drive = {}) {
  Tracker tracker(TrackerConfig{}, scene.vehicle);
  Random random(7);
  Drive out;
  for (int step = 0; kStep_s * step < duration_s; ++step) {
    if (drive) drive(kStep_s * step);
    scene.Advance(kStep_s);
    std::vector<RadarMeasurement> scan = scene.Scan(0);
    if (ghost.range_m > 0.0) scan.push_back(GhostReturn(scene, ghost, random));
    scene.Radar(tracker, scan);
    if (with_camera && step % 2 == 1) scene.Camera(tracker);
    ++out.lists;
    out.false_tracks += FalseTracks(scene, tracker);
    if (!scene.cars.empty() && step > 20 && Scene::Find(tracker, scene.cars[0]) == nullptr) {
      ++out.lead_missing;
    }
  }
  return out;
}

TEST(OwnBody, WaterOnTheRadomeIsNoVehicleHoweverItMoves) {
  for (const double range_m : {0.3, 0.55, 0.8, 1.2, 1.5}) {
    for (const double rate_sigma_mps : {0.0, 0.1, 2.0}) {
      for (const double ego_mps : {0.0, 3.0, 12.0}) {
        for (const bool with_camera : {true, false}) {
          Scene scene(3);
          scene.ego.speed_mps = ego_mps;
          scene.cars.push_back({.p_W = {25.0, 0.0}, .speed_mps = ego_mps});
          const Drive drive = RunDrive(
              scene, {.range_m = range_m, .rate_sigma_mps = rate_sigma_mps}, with_camera, 6.0);
          EXPECT_LE(drive.false_tracks, 0.02 * drive.lists)
              << range_m << " m, " << rate_sigma_mps << " m/s, ego " << ego_mps << ", camera "
              << with_camera;
          if (with_camera || ego_mps > 0.0) {
            EXPECT_EQ(drive.lead_missing, 0) << range_m << ", ego " << ego_mps;
          }
        }
      }
    }
  }
}

TEST(OwnBody, WhatTheTowBarHoldsIsNoVehicle) {
  for (const double range_m : {0.4, 1.0, 1.6, 2.0}) {
    Scene scene(4);
    scene.ego.speed_mps = 10.0;
    RadarConfig& rear = scene.vehicle.radars[0];
    rear.x_m = scene.vehicle.centre_x_m - 0.5 * scene.vehicle.length_m;
    rear.yaw_rad = kPi;
    const Drive drive = RunDrive(scene, {.range_m = range_m, .range_sigma_m = 0.02}, true, 6.0,
                                 [&](double t_s) { scene.ego.accel_mps2 = std::sin(t_s); });
    EXPECT_EQ(drive.false_tracks, 0) << range_m;
  }
}

// The same is told of what the camera sees the lead car through, wherever it is.
TEST(OwnBody, WhatTheCameraSeesACarThroughIsNone) {
  for (const double range_m : {4.0, 7.0, 12.0}) {
    Scene scene(5);
    scene.ego.speed_mps = 12.0;
    scene.cars.push_back({.p_W = {30.0, 0.0}, .speed_mps = 12.0});
    const Drive drive =
        RunDrive(scene, {.range_m = range_m, .azimuth_sigma_rad = 0.005}, true, 6.0);
    EXPECT_LE(drive.false_tracks, 12) << range_m;  // Before the lead car is known.
    EXPECT_EQ(drive.lead_missing, 0) << range_m;
  }
}

// The lead car in the queue: it brakes to a stand 1 m before our bumper, and stays.
TEST(OwnBody, TheCarThatStandsAMetreBeforeTheBumperStays) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    Scene scene(seed);
    const double front_m = scene.vehicle.centre_x_m + 0.5 * scene.vehicle.length_m;
    scene.ego.speed_mps = 5.0;
    scene.cars.push_back({.p_W = {front_m + 8.0 + 2.25, 0.0}, .speed_mps = 5.0});
    const Drive drive = RunDrive(scene, {.range_m = 0.0}, true, 15.0, [&](double t_s) {
      Car& lead = scene.cars[0];
      if (t_s > 2.0) lead.accel_mps2 = lead.speed_mps > 0.1 ? -2.0 : 0.0;
      if (t_s > 2.0 && lead.speed_mps <= 0.1) lead.speed_mps = 0.0;
      const double gap_m = lead.p_W.x() - 2.25 - scene.ego.p_W.x() - front_m;
      const double wanted = std::sqrt(std::max(0.0, 2.0 * 1.5 * (gap_m - 1.0)));
      scene.ego.speed_mps = std::min(5.0, wanted < 0.05 ? 0.0 : wanted);
    });
    EXPECT_EQ(drive.lead_missing, 0) << seed;
    EXPECT_EQ(drive.false_tracks, 0) << seed;
  }
}

// Front and rear corners, as (x, y, yaw) of the antenna from the footprint's centre.
struct Corner {
  double x_m;
  double y_m;
  double yaw_deg;
};
constexpr Corner kCorners[] = {
    {2.05, 0.8, 55.0}, {2.05, -0.8, -55.0}, {-2.1, 0.8, 125.0}, {-2.1, -0.8, -125.0}};

void Mount(Scene& scene, const Corner& corner) {
  RadarConfig& radar = scene.vehicle.radars[0];
  radar.x_m = scene.vehicle.centre_x_m + corner.x_m;
  radar.y_m = corner.y_m;
  radar.yaw_rad = FromDegrees(corner.yaw_deg);
  radar.half_fov_rad = FromDegrees(75.0);
}

TEST(OwnBody, WaterOnACornerRadarsRadomeIsNoVehicle) {
  for (const Corner& corner : kCorners) {
    for (const double range_m : {0.3, 0.7, 1.2, 1.7}) {
      for (const double azimuth_deg : {-70.0, -30.0, 0.0, 30.0, 70.0}) {
        for (const double rate_sigma_mps : {0.05, 2.0}) {
          Scene scene(6);
          scene.ego.speed_mps = 9.0;
          Mount(scene, corner);
          const Drive drive = RunDrive(scene,
                                       {.range_m = range_m,
                                        .azimuth_rad = FromDegrees(azimuth_deg),
                                        .rate_sigma_mps = rate_sigma_mps},
                                       true, 4.0);
          EXPECT_LE(drive.false_tracks, 0.02 * drive.lists)
              << corner.yaw_deg << " deg, " << range_m << " m at " << azimuth_deg;
        }
      }
    }
  }
}

// The bumper's edge, the mirror, a wheel: along the own flank.
TEST(OwnBody, WhatACornerRadarSeesOfTheOwnFlankIsNoVehicle) {
  for (const Corner& corner : kCorners) {
    const double back_deg = corner.x_m > 0.0 ? 180.0 : 0.0;  // Towards the other end of the car.
    for (const double range_m : {0.5, 1.5, 2.5, 3.5}) {
      Scene scene(7);
      scene.ego.speed_mps = 9.0;
      Mount(scene, corner);
      const Drive drive =
          RunDrive(scene,
                   {.range_m = range_m,
                    .azimuth_rad = WrapAngle(FromDegrees(back_deg - corner.yaw_deg)),
                    .range_sigma_m = 0.02,
                    .azimuth_sigma_rad = 0.02},
                   true, 4.0, [&](double t_s) { scene.ego.accel_mps2 = std::sin(t_s); });
      EXPECT_EQ(drive.false_tracks, 0) << corner.yaw_deg << " deg, " << range_m << " m";
    }
  }
}

// A car that overtakes a metre beside the flank comes from elsewhere.
TEST(OwnBody, ACarThatOvertakesCloseByStaysListed) {
  for (const Corner& corner : kCorners) {
    if (corner.x_m > 0.0) continue;
    for (const std::uint64_t seed : {1, 2, 3}) {
      Scene scene(seed);
      scene.ego.speed_mps = 9.0;
      Mount(scene, corner);
      const double side = corner.y_m > 0.0 ? 1.0 : -1.0;
      scene.cars.push_back({.p_W = {-25.0, side * 3.0}, .speed_mps = 14.0});
      const Drive drive = RunDrive(scene, {.range_m = 0.0}, false, 5.0);
      EXPECT_LE(drive.lead_missing, 5) << corner.yaw_deg << ", seed " << seed;
      EXPECT_LE(drive.false_tracks, 5) << corner.yaw_deg << ", seed " << seed;
    }
  }
}

}  // namespace
}  // namespace v2vouch
