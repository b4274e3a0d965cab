// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/radar.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/sim/sensors/scene.h"

namespace v2vouch::sim {
namespace {

Scenario QuietScene(SensorMode mode) {
  Scenario scenario = StandingEgo();
  scenario.sensors.mode = mode;
  scenario.sensors.clutter_scale = 0.0;
  scenario.sensors.ghost_scale = 0.0;
  return scenario;
}

struct Statistics {
  double mean = 0.0;
  double sigma = 0.0;
};
Statistics Of(const std::vector<double>& values) {
  Statistics s;
  for (const double v : values) s.mean += v / static_cast<double>(values.size());
  for (const double v : values) {
    s.sigma += (v - s.mean) * (v - s.mean) / static_cast<double>(values.size() - 1);
  }
  s.sigma = std::sqrt(s.sigma);
  return s;
}

TEST(RadarSimulator, IdealPointNoiseHasTheConfiguredSigmas) {
  Scenario scenario = QuietScene(SensorMode::kIdealPoints);
  AddVehicle(scenario, 1, 43.0, 5.0, kPi, 0.0);
  const auto world = MakeWorld(scenario);
  const RadarConfig& config = scenario.vehicle.radars[0];
  RadarSimulator radar(*world, 0, 7);
  const Snapshot snapshot = world->At(1.0);
  std::vector<double> range, azimuth, rate;
  radar_scan_t scan{};
  constexpr int kLooks = 4000;
  for (int seq = 0; seq < kLooks; ++seq) {
    radar.Scan(snapshot, seq, scan);
    ASSERT_LE(scan.detections.size(), 1u);
    if (scan.detections.empty()) continue;
    range.push_back(scan.detections[0].range_m);
    azimuth.push_back(scan.detections[0].azimuth_rad);
    rate.push_back(scan.detections[0].range_rate_mps);
  }
  EXPECT_NEAR(static_cast<double>(range.size()) / kLooks, config.detection_probability, 0.012);
  const Vec2 d = snapshot.actors[0].motion.centre - Vec2(config.x_m, config.y_m);
  // Five sigma of the mean, and 5 % of the sigma: 4000 draws give 1.1 %.
  EXPECT_NEAR(Of(range).mean, d.norm(), 5 * config.range_sigma_m / 60);
  EXPECT_NEAR(Of(azimuth).mean, std::atan2(d.y(), d.x()), 5 * config.azimuth_sigma_rad / 60);
  EXPECT_NEAR(Of(rate).mean, 0.0, 5 * config.range_rate_sigma_mps / 60);
  EXPECT_NEAR(Of(range).sigma / config.range_sigma_m, 1.0, 0.06);
  EXPECT_NEAR(Of(azimuth).sigma / config.azimuth_sigma_rad, 1.0, 0.06);
  EXPECT_NEAR(Of(rate).sigma / config.range_rate_sigma_mps, 1.0, 0.06);
}

TEST(RadarSimulator, DopplerHoldsLeverArmAndBothMotions) {
  Scenario scenario = QuietScene(SensorMode::kIdealPoints);
  scenario.sensors.noise_scale = 0.0;
  AddVehicle(scenario, 1, 30.0, 20.0, 0.5, 8.0);
  const auto world = MakeWorld(scenario);
  Snapshot snapshot = world->At(0.5);
  snapshot.ego.speed_mps = 6.0;
  snapshot.ego.yaw_rate_radps = 0.4;
  RadarSimulator radar(*world, 1, 7);  // At the left front corner.
  const RadarConfig& config = scenario.vehicle.radars[1];
  radar_scan_t scan{};
  for (int seq = 0; scan.detections.empty(); ++seq) radar.Scan(snapshot, seq, scan);
  const Vec2 antenna_velocity(6.0 - 0.4 * config.y_m, 0.4 * config.x_m);
  const Vec2 d = snapshot.actors[0].motion.centre - Vec2(config.x_m, config.y_m);
  const double expected = (8.0 * Direction(0.5) - antenna_velocity).dot(d) / d.norm();
  EXPECT_NEAR(scan.detections[0].range_rate_mps, expected, 1e-6);
}

TEST(RadarSimulator, ConventionsOfTheSensorAreApplied) {
  Scenario scenario = QuietScene(SensorMode::kIdealPoints);
  scenario.sensors.noise_scale = 0.0;
  RadarConfig& config = scenario.vehicle.radars[0];
  config.flip_azimuth = true;
  config.flip_range_rate = true;
  config.range_offset_m = 1.5;
  AddVehicle(scenario, 1, 50.0, 8.0, 0.0, 5.0);
  const auto world = MakeWorld(scenario);
  const Snapshot snapshot = world->At(0.0);
  RadarSimulator radar(*world, 0, 7);
  radar_scan_t scan{};
  for (int seq = 0; scan.detections.empty(); ++seq) radar.Scan(snapshot, seq, scan);
  const Vec2 d = snapshot.actors[0].motion.centre - Vec2(config.x_m, config.y_m);
  EXPECT_NEAR(scan.detections[0].range_m + config.range_offset_m, d.norm(), 1e-9);
  EXPECT_LT(scan.detections[0].azimuth_rad, 0.0);
  EXPECT_LT(scan.detections[0].range_rate_mps, 0.0);
}

TEST(RadarSimulator, CarsGiveSeveralReflectionsOnTheirVisibleFaces) {
  Scenario scenario = QuietScene(SensorMode::kRealistic);
  scenario.sensors.noise_scale = 0.0;
  AddVehicle(scenario, 1, 25.0, 4.0, kPi, 0.0);
  const auto world = MakeWorld(scenario);
  const Snapshot snapshot = world->At(0.0);
  const RadarConfig& config = scenario.vehicle.radars[0];
  RadarSimulator radar(*world, 0, 3);
  radar_scan_t scan{};
  double reflections = 0.0;
  double scans = 0.0;
  for (int seq = 0; seq < 400; ++seq) {
    radar.Scan(snapshot, seq, scan);
    if (scan.detections.empty()) continue;
    scans += 1.0;
    reflections += static_cast<double>(scan.detections.size());
    for (const auto& d : scan.detections) {
      const Vec2 place = Vec2(config.x_m, config.y_m) + d.range_m * Direction(d.azimuth_rad);
      EXPECT_TRUE(snapshot.actors[0].box().Contains(place, 0.05));
    }
  }
  EXPECT_GT(reflections / scans, 3.0);
  EXPECT_LT(reflections / scans, 8.0);
}

TEST(RadarSimulator, NothingComesFromBehindATruckOrAHouse) {
  for (const bool by_house : {false, true}) {
    Scenario scenario = QuietScene(SensorMode::kRealistic);
    AddVehicle(scenario, 1, 60.0, 0.0, kPi, 5.0);
    if (by_house) {
      scenario.buildings.push_back({.x_m = 30, .y_m = 0, .length_m = 5, .width_m = 12});
    } else {
      AddVehicle(scenario, 2, 30.0, 0.0, kPi / 2, 0.0, ObjectClass::kTruck);
    }
    const auto world = MakeWorld(scenario);
    const Snapshot snapshot = world->At(0.0);
    RadarSimulator radar(*world, 0, 3);
    std::vector<Sight> sights;
    radar.Look(snapshot, sights);
    EXPECT_EQ(sights[0].visible_fraction, 0.0);
    EXPECT_EQ(sights[0].detection_probability, 0.0);
    radar_scan_t scan{};
    for (int seq = 0; seq < 50; ++seq) {
      radar.Scan(snapshot, seq, scan);
      for (const auto& d : scan.detections) EXPECT_LT(d.range_m, 40.0);
    }
  }
}

TEST(RadarSimulator, ClutterAboveSixDecibelHasTheConfiguredRate) {
  Scenario scenario = QuietScene(SensorMode::kRealistic);
  scenario.sensors.clutter_scale = 1.0;
  const auto world = MakeWorld(scenario);
  RadarSimulator radar(*world, 0, 5);
  radar_scan_t scan{};
  double above = 0.0;
  constexpr int kScans = 4000;
  for (int seq = 0; seq < kScans; ++seq) {
    radar.Scan(world->At(0.0), seq, scan);
    for (const auto& d : scan.detections) above += d.snr_db > 6.0 ? 1.0 : 0.0;
  }
  EXPECT_NEAR(above / kScans, scenario.vehicle.radars[0].clutter_per_scan, 0.06);
}

TEST(RadarSimulator, AnotherVehicleOutOfTheWayChangesNobodysDraws) {
  Scenario scenario = QuietScene(SensorMode::kRealistic);
  AddVehicle(scenario, 1, 40.0, 4.0, kPi, 9.0);
  const auto alone = MakeWorld(scenario);
  AddVehicle(scenario, 2, -60.0, 4.0, 0.0, 9.0);  // Behind the ego.
  AddVehicle(scenario, 3, 30.0, -12.0, 0.0, 9.0);
  const auto crowded = MakeWorld(scenario);
  RadarSimulator a(*alone, 0, 11);
  RadarSimulator b(*crowded, 0, 11);
  radar_scan_t first{};
  radar_scan_t second{};
  std::size_t found = 0;
  for (int seq = 0; seq < 40; ++seq) {
    a.Scan(alone->At(0.05 * seq), seq, first);
    b.Scan(crowded->At(0.05 * seq), seq, second);
    for (const auto& d : first.detections) {
      const bool is_there =
          std::any_of(second.detections.begin(), second.detections.end(), [&](const auto& e) {
            return e.range_m == d.range_m && e.azimuth_rad == d.azimuth_rad && e.snr_db == d.snr_db;
          });
      EXPECT_TRUE(is_there) << "scan " << seq;
      ++found;
    }
  }
  EXPECT_GT(found, 40u);
}

}  // namespace
}  // namespace v2vouch::sim
