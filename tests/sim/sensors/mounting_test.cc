// SPDX-License-Identifier: Apache-2.0
#include "sim/world/mounting.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "sim/sensors/bsm.h"
#include "sim/sensors/camera.h"
#include "sim/sensors/ego.h"
#include "sim/sensors/radar.h"
#include "tests/sim/sensors/scene.h"

namespace v2vouch::sim {
namespace {

using testing::HasSubstr;

Scenario NoiselessPoints() {
  Scenario scenario = StandingEgo();
  scenario.sensors.mode = SensorMode::kIdealPoints;
  scenario.sensors.noise_scale = 0.0;
  return scenario;
}

MountingErrorSpec ErrorOf(const char* sensor) {
  MountingErrorSpec error;
  error.sensor = sensor;
  return error;
}

TEST(Mounting, ARadarTurnedToTheLeftSeesEverythingFartherRight) {
  Scenario scenario = NoiselessPoints();
  AddVehicle(scenario, 1, 43.0, 5.0, kPi);
  MountingErrorSpec error = ErrorOf("radar_front");
  error.yaw_rad = FromDegrees(1.0);
  error.x_m = 0.5;
  scenario.mounting.push_back(error);
  const auto world = MakeWorld(scenario);
  RadarSimulator radar(*world, 0, 7);
  radar_scan_t scan{};
  for (int seq = 0; scan.detections.empty(); ++seq) radar.Scan(world->At(1.0), seq, scan);
  const RadarConfig& nominal = scenario.vehicle.radars[0];
  const Vec2 d = world->At(1.0).actors[0].motion.centre - Vec2(nominal.x_m + 0.5, nominal.y_m);
  EXPECT_NEAR(scan.detections[0].azimuth_rad, std::atan2(d.y(), d.x()) - FromDegrees(1.0), 1e-9);
  EXPECT_NEAR(scan.detections[0].range_m, d.norm(), 1e-9);
  EXPECT_EQ(world->scenario().vehicle.radars[0].yaw_rad, nominal.yaw_rad) << "the daemon's stays";
}

TEST(Mounting, ACameraPitchedDownSeesEverythingFartherUp) {
  Scenario scenario = NoiselessPoints();
  AddVehicle(scenario, 1, 31.8, 0.0, kPi);
  const auto foot_row = [&] {
    const auto world = MakeWorld(scenario);
    CameraSimulator camera(*world, 0, 7);
    camera_detections_t picture{};
    for (int seq = 0; picture.boxes.empty(); ++seq) camera.Shoot(world->At(1.0), seq, picture);
    return picture.boxes[0].top_px + picture.boxes[0].height_px;
  };
  const double before = foot_row();
  MountingErrorSpec error = ErrorOf("camera_front");
  error.pitch_rad = FromDegrees(1.0);
  scenario.mounting.push_back(error);
  EXPECT_NEAR(foot_row() - before, -1000.0 * std::tan(FromDegrees(1.0)), 0.5);
}

TEST(Mounting, TheAntennaMovesWhatTheReceiverMeasuresInATurn) {
  Scenario scenario = StandingEgo();
  scenario.gnss.velocity_sigma_mps = 0.0;
  MountingErrorSpec error = ErrorOf("antenna");
  error.x_m = 0.25;
  scenario.mounting.push_back(error);
  const auto world = MakeWorld(scenario);
  Snapshot snapshot = world->At(0.0);
  snapshot.ego.speed_mps = 10.0;
  snapshot.ego.yaw_rate_radps = 0.4;
  EgoGnssSimulator gnss(*world, 1);
  gnss_fix_t fix{};
  gnss.Measure(snapshot, 0, 0.1, fix);
  EXPECT_NEAR(fix.velocity_north_mps, 0.4 * (scenario.vehicle.antenna_x_m + 0.25), 1e-4);
}

TEST(Mounting, WhatNoPartOfTheCarIsCalledIsNamed) {
  Scenario scenario = StandingEgo();
  scenario.mounting.push_back(ErrorOf("radar_rear"));
  MountingErrorSpec pitched = ErrorOf("radar_front");
  pitched.pitch_rad = 0.1;
  scenario.mounting.push_back(pitched);
  std::vector<std::string> problems;
  CheckMounting(scenario, problems);
  ASSERT_EQ(problems.size(), 2u);
  EXPECT_THAT(problems[0], HasSubstr("mounting[0].sensor: 'radar_rear'"));
  EXPECT_THAT(problems[1], HasSubstr("radar_front has x_m, y_m and yaw_deg only"));
}

TEST(Odometry, SpeedIsThatOfItsPlaceAcrossTheCar) {
  Scenario scenario = StandingEgo();
  scenario.odometry.speed_sigma_mps = 0.0;
  scenario.odometry.speed_scale = 1.0;
  scenario.odometry.y_m = 0.5;
  const auto world = MakeWorld(scenario);
  Snapshot snapshot = world->At(0.0);
  snapshot.ego.speed_mps = 10.0;
  snapshot.ego.yaw_rate_radps = 0.4;
  ego_motion_t motion{};
  OdometrySimulator(*world, 1).Measure(snapshot, 0, motion);
  EXPECT_NEAR(motion.speed_mps, 10.0 - 0.4 * 0.5, 1e-12);  // The left side is the inner one.
}

TEST(RadarSimulator, SceneryAnswersIdealPointsWhereToldTo) {
  Scenario scenario = NoiselessPoints();
  scenario.poles.push_back({.x_m = 30.0, .y_m = 4.0});
  radar_scan_t scan{};
  const auto returns = [&] {
    const auto world = MakeWorld(scenario);
    RadarSimulator radar(*world, 0, 7);
    std::size_t n = 0;
    for (int seq = 0; seq < 50; ++seq) {
      radar.Scan(world->At(1.0), seq, scan);
      n += scan.detections.size();
    }
    return n;
  };
  EXPECT_EQ(returns(), 0u);
  scenario.sensors.static_returns = true;
  EXPECT_GT(returns(), 40u);
}

TEST(RadarSimulator, OutliersAreAsManyAsToldAndTheRestIsUntouched) {
  Scenario scenario = StandingEgo();
  scenario.sensors.mode = SensorMode::kIdealPoints;
  AddVehicle(scenario, 1, 43.0, 5.0, kPi);
  std::vector<radar_detection_t> clean, spoilt;
  for (const double share : {0.0, 0.1}) {
    scenario.sensors.outlier_share = share;
    const auto world = MakeWorld(scenario);
    RadarSimulator radar(*world, 0, 7);
    radar_scan_t scan{};
    for (int seq = 0; seq < 4000; ++seq) {
      radar.Scan(world->At(1.0), seq, scan);
      auto& all = share == 0.0 ? clean : spoilt;
      all.insert(all.end(), scan.detections.begin(), scan.detections.end());
    }
  }
  ASSERT_EQ(clean.size(), spoilt.size());
  int changed = 0;
  for (std::size_t i = 0; i < clean.size(); ++i) {
    changed += clean[i].range_m != spoilt[i].range_m ||
               clean[i].azimuth_rad != spoilt[i].azimuth_rad ||
               clean[i].range_rate_mps != spoilt[i].range_rate_mps;
  }
  EXPECT_NEAR(changed / static_cast<double>(clean.size()), 0.1, 0.02);
}

TEST(BsmSender, TellsWhereItWasWhenItsPositionIsOlderThanItsStamp) {
  Scenario scenario = StandingEgo();
  AddVehicle(scenario, 1, 50.0, 3.5, 0.0, 20.0);
  scenario.vehicles[0].v2v = true;
  scenario.vehicles[0].sender.noise_scale = 0.0;
  const auto place = [&] {
    const auto world = MakeWorld(scenario);
    BsmSender sender(*world, 0, 3);
    for (int i = 0; i < 20; ++i) sender.NextMessage();
    return sender.NextMessage()->said.centre;
  };
  const Vec2 fresh = place();
  scenario.vehicles[0].sender.position_age_s = 0.15;
  EXPECT_NEAR((fresh - place()).x(), 20.0 * 0.15, 1e-6);
  scenario.bsm.position_age_s = 0.1;
  EXPECT_NEAR((fresh - place()).x(), 20.0 * 0.25, 1e-6);
}

}  // namespace
}  // namespace v2vouch::sim
