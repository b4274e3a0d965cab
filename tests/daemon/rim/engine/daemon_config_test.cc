// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/engine/daemon_config.h"

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

class ShippedVehicle : public testing::TestWithParam<const char*> {};

TEST_P(ShippedVehicle, IsTheDefault) {
  DaemonConfig shipped;
  shipped.perception.vehicle.radars.clear();  // So that equality comes from the file.
  shipped.perception.vehicle.length_m = 9.0;
  std::vector<std::string> problems;
  EXPECT_TRUE(LoadDaemonConfig(GetParam(), shipped, problems)) << testing::PrintToString(problems);
  std::istringstream is(PrintDaemonConfig(shipped));
  std::istringstream wanted(PrintDaemonConfig(DaemonConfig{}));
  std::string line;
  for (std::string wanted_line; std::getline(wanted, wanted_line);) {
    ASSERT_TRUE(std::getline(is, line)) << "missing: " << wanted_line;
    EXPECT_EQ(line, wanted_line);
  }
  EXPECT_FALSE(std::getline(is, line)) << line;
}

INSTANTIATE_TEST_SUITE_P(Both, ShippedVehicle,
                         testing::Values("daemon/vehicles/vehicle.yaml",
                                         "daemon/vehicles/advanced.yaml"));

// A key that is missing would keep its default silently; the shipped file is the documentation.
TEST(DaemonConfig, TheAdvancedFileNamesEveryKey) {
  std::ifstream file("daemon/vehicles/advanced.yaml");
  std::string text(std::istreambuf_iterator<char>(file), {});
  std::istringstream lines(PrintDaemonConfig(DaemonConfig{}));
  for (std::string line; std::getline(lines, line);) {
    const auto start = line.find_first_not_of(" -");
    const std::string key = line.substr(start, line.find(':') - start) + ":";
    EXPECT_NE(text.find(key), std::string::npos) << key;
  }
}

// scripts/config_reference writes the page anew.
TEST(DaemonConfig, TheReferencePageNamesEveryKeyWithRangeAndDefault) {
  std::ifstream file("docs/reference/configuration.md");
  const std::string page(std::istreambuf_iterator<char>(file), {});
  const std::vector<config::Key> keys = DaemonConfigKeys();
  EXPECT_GT(keys.size(), 200U);
  for (const config::Key& key : keys) {
    const std::string words = "must be ";
    const std::string range =
        key.range.starts_with(words) ? key.range.substr(words.size()) : key.range;
    const std::string row = "| `" + key.path + "` | " + range + " | " +
                            (key.value.empty() ? "" : "`" + key.value + "`");
    EXPECT_NE(page.find(row), std::string::npos) << row;
  }
}

TEST(DaemonConfig, EveryShippedVehicleLoads) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator("daemon/vehicles")) {
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

// Loads a file with this text over the shipped vehicle.
struct Loaded {
  explicit Loaded(const std::string& text) {
    const std::string path = testing::TempDir() + "sensors.yaml";
    std::ofstream(path) << text;
    is_good = LoadDaemonConfig(path, config, problems, &notes);
  }
  [[nodiscard]] std::vector<std::string> radars() const {
    std::vector<std::string> names;
    for (const auto& radar : config.perception.vehicle.radars) names.push_back(radar.name);
    return names;
  }
  [[nodiscard]] const RadarConfig& radar(std::size_t i) const {
    return config.perception.vehicle.radars.at(i);
  }
  DaemonConfig config;
  std::vector<std::string> problems;
  std::vector<std::string> notes;
  bool is_good = false;
};

constexpr char kRear[] = "x_m: -0.9, y_m: 0, yaw_deg: 180, half_fov_deg: 60, max_range_m: 70";

TEST(DaemonConfig, AFileWithoutAnySettingIsNoticed) {
  for (const char* text : {"", "\n\n", "# my car\n", "---\n"}) {
    const Loaded loaded(text);
    EXPECT_TRUE(loaded.is_good) << text;
    EXPECT_THAT(loaded.notes, testing::ElementsAre(HasSubstr("holds no setting"))) << text;
  }
}

TEST(DaemonConfigSensors, OneKeyOfOneSensorChangesThatKeyAlone) {
  const Loaded loaded("vehicle: {radars: [{name: FRONT_LEFT, yaw_deg: 56}]}");
  ASSERT_TRUE(loaded.is_good) << testing::PrintToString(loaded.problems);
  EXPECT_THAT(loaded.radars(), testing::ElementsAre("FRONT", "FRONT_LEFT", "FRONT_RIGHT"));
  DaemonConfig wanted;
  wanted.perception.vehicle.radars[1].yaw_rad = FromDegrees(56.0);
  EXPECT_EQ(PrintDaemonConfig(loaded.config), PrintDaemonConfig(wanted));
  EXPECT_THAT(loaded.notes, IsEmpty());

  const Loaded camera("vehicle: {cameras: [{source: image}]}");  // There is only one.
  ASSERT_TRUE(camera.is_good) << testing::PrintToString(camera.problems);
  EXPECT_EQ(camera.config.perception.vehicle.cameras.at(0).source, CameraSource::kImage);
  EXPECT_EQ(camera.radars().size(), 3u);
}

TEST(DaemonConfigSensors, ANewSensorMustBeCompleteAndNamesWhatItLacks) {
  const Loaded bare("vehicle: {radars: [{name: REAR, yaw_deg: 180, x_m: -1}]}");
  EXPECT_FALSE(bare.is_good);
  EXPECT_THAT(bare.problems,
              testing::ElementsAre(HasSubstr("vehicle.radars[0]: lacks y_m, half_fov_deg, "
                                             "max_range_m: REAR is new, and a new one must be "
                                             "complete; there are FRONT, FRONT_LEFT")));
  const Loaded typo("vehicle: {radars: [{name: FORNT, yaw_deg: 1}]}");
  EXPECT_THAT(typo.problems, testing::ElementsAre(HasSubstr("(did you mean FRONT?)")));
  const Loaded camera("vehicle: {cameras: [{name: SIDE, x_m: 1}]}");
  EXPECT_THAT(camera.problems,
              testing::ElementsAre(HasSubstr("lacks y_m, z_m, yaw_deg, image_wid")));
  const Loaded mixed(std::string("vehicle: {radars: [{name: FRONT, yaw_deg: 1}, {name: REAR, ") +
                     kRear + "}]}");
  EXPECT_THAT(mixed.problems, testing::ElementsAre(HasSubstr("say `add: true`")));
  const Loaded added(std::string("vehicle: {radars: [{name: REAR, add: true, ") + kRear + "}]}");
  ASSERT_TRUE(added.is_good) << testing::PrintToString(added.problems);
  EXPECT_THAT(added.radars(), testing::ElementsAre("FRONT", "FRONT_LEFT", "FRONT_RIGHT", "REAR"));
  EXPECT_EQ(added.radar(3).max_range_m, 70.0);
}

TEST(DaemonConfigSensors, RemovingIsExplicitAndNamesWhatThereIs) {
  const Loaded removed("vehicle: {radars: [{name: FRONT_LEFT, remove: true}]}");
  ASSERT_TRUE(removed.is_good) << testing::PrintToString(removed.problems);
  EXPECT_THAT(removed.radars(), testing::ElementsAre("FRONT", "FRONT_RIGHT"));
  EXPECT_THAT(Loaded("vehicle: {radars: [{name: REAR, remove: true}]}").problems,
              testing::ElementsAre(HasSubstr("no REAR to remove; there are FRONT, FRONT_LEFT")));
  EXPECT_THAT(Loaded("vehicle: {radars: [{name: FRONT, remove: yes}]}").problems,
              testing::ElementsAre(HasSubstr("remove = yes: must be true or false")));
  EXPECT_THAT(Loaded("vehicle: {radars: [{name: FRONT, remove: true, x_m: 1}]}").problems,
              testing::ElementsAre(HasSubstr("no other key belongs here")));
  const Loaded none("vehicle: {radars: []}");
  EXPECT_TRUE(none.is_good);
  EXPECT_THAT(none.radars(), IsEmpty());
}

TEST(DaemonConfigSensors, TwiceNamelessAndCaseOnlyAreProblems) {
  EXPECT_THAT(Loaded("vehicle: {radars: [{name: FRONT, x_m: 1}, {name: FRONT, y_m: 1}]}").problems,
              testing::ElementsAre(HasSubstr("FRONT stands here a second time, first at [0]")));
  EXPECT_THAT(Loaded("vehicle: {radars: [{yaw_deg: 1}]}").problems,
              testing::ElementsAre(HasSubstr("vehicle.radars[0]: has no name")));
  EXPECT_THAT(Loaded(std::string("vehicle: {radars: [{name: Rear, ") + kRear + "}, {name: REAR, " +
                     kRear + "}]}")
                  .problems,
              testing::ElementsAre(HasSubstr("differs from Rear by its case only")));
  EXPECT_THAT(Loaded("detector: {classes: [{id: 2, class: car}, {id: 2, class: bus}]}").problems,
              testing::ElementsAre(HasSubstr("2 stands here a second time")));
  EXPECT_THAT(Loaded("detector: {classes: [{id: 2}]}").problems,
              testing::ElementsAre(HasSubstr("lacks class")));
}

TEST(DaemonConfigSensors, AWholeListIsTheVehicleAndSaysWhatItLeavesOut) {
  const Loaded whole(std::string("vehicle: {radars: [{name: FRONT, ") + kRear + "}]}");
  ASSERT_TRUE(whole.is_good) << testing::PrintToString(whole.problems);
  EXPECT_THAT(whole.radars(), testing::ElementsAre("FRONT"));
  EXPECT_EQ(whole.radar(0).azimuth_sigma_rad, RadarConfig{}.azimuth_sigma_rad);
  EXPECT_THAT(whole.notes, testing::ElementsAre(HasSubstr("FRONT_LEFT, FRONT_RIGHT are not part")));
  const Loaded said(std::string("vehicle: {radars: [{name: FRONT, ") + kRear +
                    "}, {name: FRONT_LEFT, remove: true}, {name: FRONT_RIGHT, remove: true}]}");
  EXPECT_THAT(said.radars(), testing::ElementsAre("FRONT"));
  EXPECT_THAT(said.notes, IsEmpty());
}

TEST(DaemonConfigSensors, WhatIsPrintedLoadsAsTheSame) {
  for (const std::string& text :
       {std::string("vehicle: {radars: [{name: FRONT_LEFT, yaw_deg: 56}]}"),
        std::string("vehicle: {radars: [{name: FRONT, remove: true}], cameras: []}"),
        std::string("vehicle: {radars: [{name: REAR, ") + kRear + "}]}",
        std::string("vehicle: {radars: [{name: REAR, add: true, ") + kRear + "}]}"}) {
    const Loaded first(text);
    ASSERT_TRUE(first.is_good) << testing::PrintToString(first.problems);
    const std::string printed = PrintDaemonConfig(first.config);
    const Loaded second(printed);
    EXPECT_TRUE(second.is_good) << testing::PrintToString(second.problems);
    EXPECT_EQ(PrintDaemonConfig(second.config), printed);
  }
}

TEST(DaemonConfigSensors, MadeAbsoluteItMeansTheSameFromAnyFolder) {
  DaemonConfig config;
  config.calibration = "cal/mine.yaml";
  config.detector.model = "/net.onnx";
  MakeAbsolute("/cars/vehicle.yaml", config);
  EXPECT_EQ(config.calibration, "/cars/cal/mine.yaml");
  EXPECT_EQ(config.detector.model, "/net.onnx");
  MakeAbsolute("/elsewhere/vehicle.yaml", config);
  EXPECT_EQ(config.calibration, "/cars/cal/mine.yaml");
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
