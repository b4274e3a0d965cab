// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>

#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "daemon/common/base/random.h"
#include "daemon/common/models/measurement_model.h"
#include "daemon/v2v/perception/v2v_perception.h"

/// PRIORITY alone, beside made-up LOCAL tracks.
namespace v2vouch {

inline constexpr double kFrame_s = 0.05;
inline const Wgs84 kHome{FromDegrees(52.4), FromDegrees(13.05), 60.0};

struct Car {
  std::uint64_t local_id = 0;
  Eigen::Vector2d p = Eigen::Vector2d::Zero();
  double yaw_rad = 0.0;
  double speed_mps = 0.0;
  bool is_seen = true;
  bool is_coasting = false;  // LOCAL still has a track of it that nothing hits.
  bool is_part = false;      // No more than a part of it shows.
  // What a tracker would know of it.
  Timestamp start{};
  SensorSupport support{};
};

// An ego that stands at the origin of L and O looking east, with made-up LOCAL tracks (truth plus
// 0.1 m of noise) and claims. Everything behind x = 15 m is hidden while `has_wall`.
class Scene {
 public:
  explicit Scene(std::uint64_t seed = 1, PriorityConfig config = {})
      : random(seed),
        perception(config, AlignmentConfig{}, vehicle),
        map(VisibilityConfig{}, vehicle) {
    for (int i = 0; i < 20; ++i) Fix();
  }

  void Fix(const Eigen::Vector2d& jump = Eigen::Vector2d::Zero()) {
    GnssFix fix;
    fix.stamp = now;
    fix.position = plane.ToGeodetic(
        LocalPoint{{vehicle.antenna_x_m + jump.x(), vehicle.antenna_y_m + jump.y(), 0.0}});
    fix.covariance_enu = Eigen::Vector3d(0.04, 0.04, 0.1).asDiagonal();
    fix.yaw_rad = 0.0;
    fix.yaw_sigma_rad = 0.003;
    fix.velocity_en_mps = Eigen::Vector2d::Zero();
    fix.velocity_sigma_mps = 0.05;
    fix.fix_type = FixType::k3d;
    fix.has_height = has_height;
    if (!has_height) fix.position.height_m = 0.0;
    EgoState at_fix = Ego();
    perception.OnFix(fix, at_fix, outputs);
    now += FromSeconds(0.001);
  }

  [[nodiscard]] EgoState Ego() const {
    EgoState ego;
    ego.stamp = now;
    return ego;
  }

  void Move(double dt_s) {
    for (Car& car : cars) {
      car.p += dt_s * car.speed_mps * Eigen::Vector2d(std::cos(car.yaw_rad), std::sin(car.yaw_rad));
    }
    now += FromSeconds(dt_s);
    ++frames;
  }

  void Frame() {
    LocalFrame frame;
    frame.stamp = now;
    frame.ego = Ego();
    frame.sectors = {{-kPi, 0.0, 200.0, SectorState::kWatched},
                     {0.0, kPi, 200.0, SectorState::kWatched}};
    std::vector<Occluder> occluders;
    if (has_wall) {
      occluders.push_back(
          {.id = 1, .centre_O = {15.0, 0.0}, .yaw_rad = 0.5 * kPi, .length_m = 120.0});
    }
    if (screen) occluders.push_back(*screen);
    for (Car& car : cars) {
      if (!car.is_seen && !car.is_coasting) continue;
      if (car.support.hits() == 0) car.start = now;
      if (car.is_seen) {
        car.support.Add({SensorKind::kRadar, 0}, now);
        if (frames % 2 == 0) car.support.Add({SensorKind::kCamera, 0}, now);
      }
      LocalTrack track;
      track.id = car.local_id;
      track.start = car.start;
      track.state_O.mean << car.p.x() + random.Normal(0.0, 0.1),
          car.p.y() + random.Normal(0.0, 0.1), car.yaw_rad + random.Normal(0.0, 0.01),
          car.speed_mps + random.Normal(0.0, 0.1), 0.0, 0.0;
      track.state_O.covariance = StateVector(0.02, 0.02, 2e-4, 0.02, 1e-3, 0.05).asDiagonal();
      track.extent = {4.5, 1.8, 0.1, 0.1};
      track.existence = 0.99;
      track.is_confirmed = car.support.hits(SensorKind::kRadar) >= 2;
      track.support = car.support;
      frame.tracks.push_back(track);
      if (!car.is_seen) continue;
      frame.updates.push_back({car.local_id, Radar(car, track.extent)});
      occluders.push_back({.id = track.id,
                           .centre_O = track.state_O.mean.head<2>(),
                           .yaw_rad = car.yaw_rad,
                           .position_sigma_m = 0.14});
    }
    map.SetScene(frame.ego, occluders);
    perception.OnFrame(frame, map, outputs);
  }

  // What radar 0 would report of a car: h at the truth, plus noise.
  RadarMeasurement Radar(const Car& car, const Extent& extent) {
    RadarMeasurement measurement;
    measurement.visible_share = car.is_part ? 0.3 : 1.0;
    measurement.covariance = Eigen::Vector3d(0.04, 1e-4, 0.01).asDiagonal();
    StateVector x;
    x << car.p.x(), car.p.y(), car.yaw_rad, car.speed_mps, 0.0, 0.0;
    for (int pass = 0; pass < 2; ++pass) {  // The second with its own range as reference.
      const auto at_truth = LinearizeRadar(x, extent, Ego(), vehicle.radars[0], measurement);
      if (!at_truth) break;
      measurement.range_m -= at_truth->y[0];
      measurement.azimuth_rad -= at_truth->y[1];
      measurement.range_rate_mps -= at_truth->y[2];
      measurement.near_range_m = measurement.range_m;
    }
    measurement.ground_range_rate_mps = measurement.range_rate_mps;
    measurement.range_m += random.Normal(0.0, 0.2);
    measurement.azimuth_rad += random.Normal(0.0, 0.01);
    measurement.range_rate_mps += random.Normal(0.0, 0.1);
    return measurement;
  }

  void Say(SenderId sender, const Eigen::Vector2d& p, double yaw_rad, double speed_mps,
           double noise_m = 0.5, double height_m = 60.0,
           const std::optional<Finding>& finding = std::nullopt, bool is_lost = false) {
    Claim claim;
    claim.accuracy_is_poor = is_lost;
    claim.finding = finding;
    claim.sender = sender;
    claim.received = now;
    claim.first_heard = first_heard.try_emplace(sender, now).first->second;
    claim.p_E = plane
                    .ToEcefPoint(LocalPoint{{p.x() + random.Normal(0.0, noise_m),
                                             p.y() + random.Normal(0.0, noise_m), 0.0}})
                    .p_E;
    claim.course_E =
        plane.R_LE().transpose() * Eigen::Vector3d(std::cos(yaw_rad), std::sin(yaw_rad), 0.0);
    claim.has_elevation = true;
    claim.height_m = height_m;
    claim.speed_mps = speed_mps;
    claim.position_sigma_m = std::max(0.5, noise_m);
    perception.OnClaim(claim, Ego(), outputs);
  }

  // Claims of car 0 with a bias, every other frame.
  void Honest(SenderId sender, const Eigen::Vector2d& bias = {1.0, -0.8}) {
    if (frames % 2 == 0) {
      Say(sender, cars[0].p + bias, cars[0].yaw_rad, cars[0].speed_mps);
    }
  }

  // Claims of car 0, as far off, from a sender that says itself that its place is worth nothing.
  void Lost(SenderId sender, const Eigen::Vector2d& error) {
    if (frames % 2 == 0) {
      Say(sender, cars[0].p + error, cars[0].yaw_rad, cars[0].speed_mps, 0.5, 60.0, std::nullopt,
          true);
    }
  }

  template <class Say>
  void Run(double for_s, Say say) {
    for (int i = 0; i < std::lround(for_s / kFrame_s); ++i) {
      Move(kFrame_s);
      if (frames % 4 == 0) Fix();
      Frame();
      say();
    }
  }

  [[nodiscard]] std::vector<PublishedTrack> Priority() const {
    TrackList list;
    perception.Publish(now, Ego(), list);
    return list.tracks;
  }

  bool has_height = true;  // Of the fixes.
  VehicleConfig vehicle;
  LocalPlane plane{kHome};
  Timestamp now = FromMicros(1'700'000'000'000'000);
  int frames = 0;
  Random random;
  V2vPerception perception;
  VisibilityMap map;
  Outputs outputs;
  std::vector<Car> cars;
  bool has_wall = false;
  std::optional<Occluder> screen;
  std::map<SenderId, Timestamp> first_heard;
};

inline Car OncomingCar(double x_m = 70.0) {
  return {.local_id = 7, .p = {x_m, 3.5}, .yaw_rad = kPi, .speed_mps = 5.0};
}

// A scene in which car 0 has been validated for `for_s`.
inline Scene Validated(std::uint64_t seed, double for_s = 6.0, double x_m = 70.0) {
  Scene scene(seed);
  scene.cars = {OncomingCar(x_m)};
  scene.Run(for_s, [&] { scene.Honest(1); });
  EXPECT_EQ(scene.Priority().size(), 1u) << "seed " << seed;
  return scene;
}

inline void Hide(Scene& scene) {
  scene.cars[0].is_seen = false;
  scene.has_wall = true;
}

inline double ErrorOf(const PublishedTrack& line, const Car& car) {
  return (line.track.state_O.mean.head<2>() - car.p).norm();
}

}  // namespace v2vouch
