// SPDX-License-Identifier: Apache-2.0
#include "daemon/assembly/daemon_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace v2vouch {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> ProblemsOf(const DaemonConfig& config) {
  std::vector<std::string> problems;
  CheckConfig(config, "a.yaml", problems);
  return problems;
}

TEST(DaemonConfig, DefaultsAreGood) { EXPECT_THAT(ProblemsOf(DaemonConfig{}), IsEmpty()); }

TEST(DaemonConfig, ShippedVehicleIsTheDefault) {
  DaemonConfig shipped;
  shipped.perception.vehicle.radars.clear();  // So that equality comes from the file.
  shipped.perception.vehicle.length_m = 9.0;
  shipped.lcm.own_queue = 9;
  std::vector<std::string> problems;
  EXPECT_TRUE(LoadDaemonConfig("daemon/config/vehicle.yaml", shipped, problems))
      << testing::PrintToString(problems);
  std::istringstream is(PrintDaemonConfig(shipped));
  std::istringstream wanted(PrintDaemonConfig(DaemonConfig{}));
  std::string line;
  for (std::string wanted_line; std::getline(wanted, wanted_line);) {
    ASSERT_TRUE(std::getline(is, line)) << "missing: " << wanted_line;
    EXPECT_EQ(line, wanted_line);
  }
  EXPECT_FALSE(std::getline(is, line)) << line;
}

// A key that is missing would keep its default silently; the shipped file is the documentation.
TEST(DaemonConfig, ShippedVehicleNamesEveryKey) {
  std::ifstream file("daemon/config/vehicle.yaml");
  std::string text(std::istreambuf_iterator<char>(file), {});
  std::istringstream lines(PrintDaemonConfig(DaemonConfig{}));
  for (std::string line; std::getline(lines, line);) {
    const auto start = line.find_first_not_of(" -");
    const std::string key = line.substr(start, line.find(':') - start) + ":";
    EXPECT_NE(text.find(key), std::string::npos) << key;
  }
}

TEST(DaemonConfig, EveryShippedVehicleLoads) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator("daemon/config")) {
    if (entry.path().extension() != ".yaml") continue;
    DaemonConfig config;
    std::vector<std::string> problems;
    EXPECT_TRUE(LoadDaemonConfig(entry.path().string(), config, problems))
        << testing::PrintToString(problems);
    ++count;
  }
  EXPECT_GE(count, 2);
}

TEST(DaemonConfig, ClashingAndImpossibleNamesAreProblems) {
  DaemonConfig config;
  config.perception.vehicle.radars[1].name = config.perception.vehicle.radars[0].name;
  config.lcm.channels.bsm = "TRACKS_LOCAL";
  config.lcm.channels.status = std::string(64, 'X');
  config.lcm.channels.config = ".*$";
  config.lcm.channels.misbehavior = "";
  EXPECT_THAT(
      ProblemsOf(config),
      testing::ElementsAre(HasSubstr("vehicle.radars[1].name: channel RADAR_FRONT: is that of "
                                     "vehicle.radars[0].name already"),
                           HasSubstr("lcm.channels.tracks_local: channel TRACKS_LOCAL: is that of "
                                     "lcm.channels.bsm already"),
                           HasSubstr("lcm.channels.misbehavior: channel \"\""),
                           HasSubstr("lcm.channels.status: channel \"XX"),
                           HasSubstr("lcm.channels.config: channel \".*$\"")));
}

TEST(DaemonConfig, WhatTheInstrumentsAreOffByHasBounds) {
  const std::string path = testing::TempDir() + "off.yaml";
  std::ofstream(path) << "vehicle:\n"
                         "  id: \"\\x01\"\n"
                         "  speed_scale: 1.2\n"
                         "  yaw_rate_bias_degps: -5.1\n"
                         "  heading_bias_deg: 181\n";
  DaemonConfig config;
  std::vector<std::string> problems;
  EXPECT_FALSE(LoadDaemonConfig(path, config, problems));
  EXPECT_THAT(problems,
              testing::ElementsAre(
                  HasSubstr("vehicle.speed_scale = 1.2: must be at least 0.9, at most 1.1"),
                  HasSubstr("vehicle.yaw_rate_bias_degps = -5.1: must be at least -5, at most 5"),
                  HasSubstr("vehicle.heading_bias_deg = 181: must be at least -180, at most 180"),
                  HasSubstr("vehicle.id: must have at most 64 printable ASCII characters")));
  std::ofstream(path) << "vehicle: {id: WVW-1, speed_scale: 0.98, heading_bias_deg: -1.5}\n";
  problems.clear();
  EXPECT_TRUE(LoadDaemonConfig(path, config, problems)) << testing::PrintToString(problems);
  EXPECT_EQ(config.perception.vehicle.id, "WVW-1");
  EXPECT_EQ(config.perception.vehicle.speed_scale, 0.98);
  EXPECT_EQ(config.perception.vehicle.heading_bias_rad, FromDegrees(-1.5));
}

TEST(DaemonConfig, RangesTheWrongWayRoundAreProblems) {
  DaemonConfig config;
  config.perception.vehicle.radars[0].min_range_m = 20.0;
  config.perception.vehicle.radars[0].max_range_m = 10.0;
  config.perception.vehicle.cameras[0].distortion = {1.0, 2.0};
  EXPECT_THAT(ProblemsOf(config), testing::ElementsAre(HasSubstr("vehicle.radars[0].min_range_m"),
                                                       HasSubstr("vehicle.cameras[0].distortion")));
}

TEST(DaemonConfig, CalibrationIsReadFromTheFileOwnFolderAndApplied) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "calibrated";
  std::filesystem::create_directories(folder);
  const std::string path = (folder / "vehicle.yaml").string();
  std::ofstream(path) << "calibration: mine.yaml\nvehicle: {id: A}\n";
  CalibrationFile file;
  file.vehicle_id = "A";
  file.parameters = {{"radar_front_left.yaw_deg", 55.4, 0.02, 55.0, 1.0,
                      CalibrationVerdict::kEstimated, "static Doppler"}};
  std::string error;
  ASSERT_TRUE(SaveCalibration((folder / "mine.yaml").string(), file, error)) << error;
  DaemonConfig config;
  std::vector<std::string> problems;
  ASSERT_TRUE(LoadDaemonConfig(path, config, problems)) << testing::PrintToString(problems);
  EXPECT_EQ(config.perception.vehicle.radars[1].yaw_rad, FromDegrees(55.4));
  ASSERT_TRUE(config.calibrated);
  EXPECT_EQ(config.calibrated->checksum.size(), 64u);
  EXPECT_THAT(PrintDaemonConfig(config), HasSubstr("yaw_deg: 55.4"));

  std::ofstream(path) << "calibration: mine.yaml\nvehicle: {id: B}\n";
  EXPECT_FALSE(LoadDaemonConfig(path, config, problems));
  EXPECT_THAT(problems, testing::ElementsAre(
                            testing::AllOf(HasSubstr("calibrated/mine.yaml"),
                                           HasSubstr("is for vehicle \"A\", this one is \"B\""))));
  problems.clear();
  std::ofstream(path) << "calibration: none.yaml\n";
  EXPECT_FALSE(LoadDaemonConfig(path, config, problems));
  EXPECT_THAT(problems, testing::ElementsAre(HasSubstr("calibrated/none.yaml: No such file")));
}

}  // namespace
}  // namespace v2vouch
