// SPDX-License-Identifier: Apache-2.0
#include "calibration/extrinsics/extrinsics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "tests/calibration/extrinsics/simulated_drive.h"

namespace v2vouch {
namespace {

using enum CalibrationVerdict;

ExtrinsicsResult Points(const DriveLog& log) {
  return CalibrateExtrinsics(log, VehicleConfig{}, {.priors = {}, .point_targets = true}, nullptr);
}

const MountingEstimate& Find(const ExtrinsicsResult& result, const std::string& name) {
  const auto at = std::ranges::find(result.parameters, name, &MountingEstimate::name);
  EXPECT_NE(at, result.parameters.end()) << name;
  return *at;
}

// What calibration_drive.yaml's `mounting`, `gnss` and `odometry` say, in the file's names.
const std::map<std::string, double> kTruth = {{"radar_front.x_m", 3.79},
                                              {"radar_front.y_m", -0.03},
                                              {"radar_front.yaw_deg", 1.0},
                                              {"radar_front_left.x_m", 3.42},
                                              {"radar_front_left.y_m", 0.77},
                                              {"radar_front_left.yaw_deg", 54.2},
                                              {"radar_front_right.x_m", 3.47},
                                              {"radar_front_right.y_m", -0.72},
                                              {"radar_front_right.yaw_deg", -54.4},
                                              {"camera_front.x_m", 1.83},
                                              {"camera_front.y_m", 0.02},
                                              {"camera_front.z_m", 1.43},
                                              {"camera_front.yaw_deg", -0.7},
                                              {"camera_front.pitch_deg", 0.8},
                                              {"camera_front.roll_deg", 0.5},
                                              {"ego.antenna_x_m", 1.05},
                                              {"ego.antenna_y_m", 0.1},
                                              {"ego.heading_bias_deg", 0.3},
                                              {"ego.speed_scale", 0.99},
                                              {"ego.yaw_rate_bias_degps", 0.05}};

TEST(Extrinsics, ADriveWithTurnsTellsEverySignAndSize) {
  const ExtrinsicsResult result = Points(SimulatedDrive("calibration_drive", 150.0, 3));
  EXPECT_TRUE(result.accepted) << (result.problems.empty() ? "" : result.problems[0]);
  double nees = 0.0;
  for (const auto& [name, truth] : kTruth) {
    const MountingEstimate& p = Find(result, name);
    EXPECT_NEAR(p.value, truth, 4.5 * p.std) << name;
    EXPECT_TRUE(p.verdict == kEstimated || p.verdict == kWeak) << name;
    EXPECT_GT(p.block_std, 0.0);
    nees += (p.value - truth) * (p.value - truth) / (p.std * p.std);
  }
  EXPECT_LT(nees / static_cast<double>(kTruth.size()), 2.5);
  for (const char* name : {"radar_front.yaw_deg", "radar_front_left.yaw_deg", "ego.speed_scale",
                           "camera_front.yaw_deg", "camera_front.pitch_deg"}) {
    EXPECT_EQ(Find(result, name).verdict, kEstimated) << name;
  }
  EXPECT_LT(Find(result, "radar_front.yaw_deg").std, 0.03);
  EXPECT_EQ(Find(result, "ego.odometer_y_m").verdict, kPrior);
}

TEST(Extrinsics, TurnedTheOtherWayItSaysTheOtherWay) {
  // Every mounting error of the scenario twice over, the other way round.
  const DriveLog log = SimulatedDrive("calibration_drive", 150.0, 4, [](sim::Scenario& scenario) {
    const std::vector<sim::MountingErrorSpec> errors = scenario.mounting;
    for (sim::MountingErrorSpec error : errors) {
      error.x_m *= -2.0;
      error.y_m *= -2.0;
      error.z_m *= -2.0;
      error.yaw_rad *= -2.0;
      error.pitch_rad *= -2.0;
      error.roll_rad *= -2.0;
      scenario.mounting.push_back(error);
    }
  });
  const ExtrinsicsResult result = Points(log);
  const VehicleConfig nominal;
  const std::map<std::string, double> nominals = {{"radar_front_left.yaw_deg", 55.0},
                                                  {"radar_front_right.yaw_deg", -55.0},
                                                  {"radar_front.x_m", 3.75},
                                                  {"camera_front.z_m", 1.4},
                                                  {"radar_front.yaw_deg", 0.0},
                                                  {"camera_front.yaw_deg", 0.0},
                                                  {"camera_front.pitch_deg", 0.0},
                                                  {"camera_front.roll_deg", 0.0},
                                                  {"ego.antenna_x_m", 0.8}};
  for (const auto& [name, from] : nominals) {
    const MountingEstimate& p = Find(result, name);
    EXPECT_NEAR(p.value - from, -(kTruth.at(name) - from), 4.5 * p.std) << name;
  }
}

TEST(Extrinsics, AStraightRoadLeavesPlacesAtThePriorAndTellsYaws) {
  const ExtrinsicsResult result = Points(SimulatedDrive("calibration_straight", 120.0, 5));
  EXPECT_TRUE(result.accepted);
  for (const char* name : {"radar_front.x_m", "radar_front_left.x_m", "radar_front_right.x_m",
                           "radar_front.y_m", "radar_front_left.y_m", "ego.antenna_x_m"}) {
    const MountingEstimate& p = Find(result, name);
    EXPECT_EQ(p.verdict, kPrior) << name;
    EXPECT_EQ(p.value, p.prior) << name;
    EXPECT_EQ(p.std, p.prior_std) << name;
    EXPECT_NE(p.hint.find("no turns"), std::string::npos) << name << ": " << p.hint;
  }
  for (const char* name : {"radar_front.yaw_deg", "radar_front_left.yaw_deg",
                           "radar_front_right.yaw_deg", "ego.heading_bias_deg"}) {
    const MountingEstimate& p = Find(result, name);
    EXPECT_EQ(p.verdict, kEstimated) << name;
    EXPECT_NEAR(p.value, kTruth.at(name), 4.5 * p.std) << name;
  }
  EXPECT_FALSE(result.weak.empty());
}

TEST(Extrinsics, AParkedCarIsNotCalibrated) {
  const ExtrinsicsResult result = Points(SimulatedDrive("calibration_parked", 60.0, 6));
  for (const MountingEstimate& p : result.parameters) {
    if (!p.name.starts_with("radar_")) continue;
    EXPECT_EQ(p.verdict, kPrior) << p.name;
  }
}

TEST(Extrinsics, OutliersBarelyMoveIt) {
  const ExtrinsicsResult result =
      Points(SimulatedDrive("calibration_drive", 150.0, 7,
                            [](sim::Scenario& scenario) { scenario.sensors.outlier_share = 0.1; }));
  EXPECT_TRUE(result.accepted) << (result.problems.empty() ? "" : result.problems[0]);
  for (const auto& [name, truth] : kTruth) {
    const MountingEstimate& p = Find(result, name);
    EXPECT_NEAR(p.value, truth, 5.0 * p.crlb) << name;
  }
}

TEST(Extrinsics, WhereVehiclesReflectMovesNoRadarAndIsInTheCamerasDoubt) {
  // Fields of view cut vehicles, near ones reflect more, boxes are half hidden: the same errors in
  // all vehicles, which no number of them averages away. Taken for noise they put the front radar
  // 0.07 m (four sigma) behind where it sits.
  const DriveLog log = SimulatedDrive("calibration_drive", 200.0, 4, [](sim::Scenario& scenario) {
    scenario.sensors.mode = sim::SensorMode::kRealistic;
  });
  const ExtrinsicsResult result =
      CalibrateExtrinsics(log, VehicleConfig{}, {.priors = {}, .point_targets = false}, nullptr);
  double nees = 0.0;
  for (const auto& [name, truth] : kTruth) {
    const MountingEstimate& p = Find(result, name);
    if (p.verdict != kEstimated && p.verdict != kWeak) continue;
    EXPECT_NEAR(p.value, truth, 3.5 * p.std) << name;
    nees += (p.value - truth) * (p.value - truth) / (p.std * p.std);
  }
  EXPECT_LT(nees / static_cast<double>(kTruth.size()), 2.0);
  EXPECT_EQ(Find(result, "ego.speed_scale").verdict, kEstimated);
  EXPECT_EQ(Find(result, "radar_front.yaw_deg").verdict, kEstimated);
}

TEST(Extrinsics, ARadarThatDoesNotDoWhatItsFigureSaysIsRejected) {
  const ExtrinsicsResult result =
      Points(SimulatedDrive("calibration_drive", 60.0, 8, [](sim::Scenario& scenario) {
        scenario.vehicle.radars[0].range_sigma_m = 2.5;  // The configuration says 0.25.
      }));
  EXPECT_FALSE(result.accepted);
  EXPECT_EQ(Find(result, "radar_front.yaw_deg").verdict, kRejected);
}

TEST(Extrinsics, WithoutOdometryThereIsNoCalibration) {
  DriveLog log;
  const ExtrinsicsResult result = Points(log);
  EXPECT_FALSE(result.accepted);
  ASSERT_FALSE(result.problems.empty());
  EXPECT_NE(result.problems[0].find("EGO_MOTION"), std::string::npos);
}

TEST(Extrinsics, TheSameDriveGivesTheSameFigures) {
  const DriveLog log = SimulatedDrive("calibration_drive", 40.0, 9);
  const ExtrinsicsResult a = Points(log);
  const ExtrinsicsResult b = Points(log);
  for (std::size_t i = 0; i < a.parameters.size(); ++i) {
    // Two threads add in either order: equal to far below what matters, not to the bit.
    EXPECT_NEAR(a.parameters[i].value, b.parameters[i].value, 0.01 * a.parameters[i].std);
  }
}

}  // namespace
}  // namespace v2vouch
