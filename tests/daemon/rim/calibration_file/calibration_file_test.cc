// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/calibration_file/calibration_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>

#include "daemon/common/base/random.h"
#include "daemon/common/base/sha256.h"

namespace v2vouch {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kInf = std::numeric_limits<double>::infinity();
const std::string kDigest(64, 'a');

CalibratedParameter Parameter(const std::string& name, double value, double prior_std) {
  return {name, value, 0.01, 0.0, prior_std, CalibrationVerdict::kEstimated, "static Doppler"};
}

CalibrationFile Good() {
  CalibrationFile file;
  file.vehicle_id = "car 7";
  file.log_sha256 = {kDigest};
  file.created = "2026-01-31T23:59:59Z";
  file.parameters = {
      Parameter("radar_front.yaw_deg", 0.4, 1.0), Parameter("radar_front.x_m", 3.8, 0.05),
      Parameter("camera_front.pitch_deg", -0.3, 1.0), Parameter("ego.speed_scale", 1.02, 0.02),
      Parameter("ego.slip_s2pm", 0.0004, 0.001)};
  file.correlated = {"radar_front.yaw_deg", "camera_front.pitch_deg"};
  file.covariance = {1e-4, -5e-5, -5e-5, 1e-4};
  return file;
}

std::vector<std::string> ProblemsOf(const CalibrationFile& file) {
  std::vector<std::string> problems;
  CheckCalibration(file, "c.yaml", problems);
  return problems;
}

std::string TextOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class CalibrationFileTest : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    std::string error;
    ASSERT_TRUE(SaveCalibration(path_, Good(), error)) << error;
  }
  std::optional<CalibrationFile> Parse(const std::string& text) {
    problems_.clear();
    return ParseCalibration(text, "c.yaml", problems_);
  }
  // As the header of every file says it is done.
  void SealAgain() {
    const std::string command = "cd " + folder_.string() +
                                " && sed -i '$d' FILE && echo \"checksum: $(sha256sum < FILE | cut "
                                "-c-64)\" >> FILE";
    ASSERT_THAT(TextOf(path_), HasSubstr(command.substr(command.find("sed"))));
    ASSERT_EQ(std::system(command.c_str()), 0);
  }

  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / "calibration_file_test";
  const std::string path_ = (folder_ / "FILE").string();
  std::vector<std::string> problems_;
};

TEST_F(CalibrationFileTest, WhatWasSavedIsLoadedBitForBit) {
  const CalibrationFile saved = Good();
  const auto loaded = LoadCalibration(path_, problems_);
  ASSERT_TRUE(loaded) << testing::PrintToString(problems_);
  EXPECT_EQ(loaded->version, 1);
  EXPECT_EQ(loaded->vehicle_id, saved.vehicle_id);
  EXPECT_EQ(loaded->log_sha256, saved.log_sha256);
  EXPECT_EQ(loaded->created, saved.created);
  EXPECT_EQ(loaded->correlated, saved.correlated);
  EXPECT_EQ(loaded->covariance, saved.covariance);
  EXPECT_EQ(loaded->checksum.size(), 64u);
  ASSERT_EQ(loaded->parameters.size(), saved.parameters.size());
  for (std::size_t i = 0; i < saved.parameters.size(); ++i) {
    EXPECT_EQ(loaded->parameters[i].name, saved.parameters[i].name);
    EXPECT_EQ(loaded->parameters[i].value, saved.parameters[i].value);
    EXPECT_EQ(loaded->parameters[i].std, saved.parameters[i].std);
    EXPECT_EQ(loaded->parameters[i].prior_std, saved.parameters[i].prior_std);
    EXPECT_EQ(loaded->parameters[i].verdict, saved.parameters[i].verdict);
    EXPECT_EQ(loaded->parameters[i].determined_by, saved.parameters[i].determined_by);
  }
}

TEST_F(CalibrationFileTest, EveryTruncationIsRefused) {
  const std::string whole = TextOf(path_);
  ASSERT_GT(whole.size(), 1000u);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    ASSERT_FALSE(Parse(whole.substr(0, length))) << length;
    ASSERT_EQ(problems_.size(), 1u);
    ASSERT_THAT(problems_[0], HasSubstr(length == 0 ? "is empty" : "was cut short"));
  }
  EXPECT_FALSE(Parse(whole + "\n"));
  EXPECT_TRUE(Parse(whole));
}

TEST_F(CalibrationFileTest, EveryFlippedBitIsRefused) {
  const std::string whole = TextOf(path_);
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string damaged = whole;
      damaged[at] = static_cast<char>(damaged[at] ^ (1 << bit));
      ASSERT_FALSE(Parse(damaged)) << "byte " << at << ", bit " << bit;
      ASSERT_EQ(problems_.size(), 1u);
    }
  }
}

TEST_F(CalibrationFileTest, AnEditIsRefusedUntilItIsSealedAgain) {
  std::string text = TextOf(path_);
  text.replace(text.find("value: 0.4"), 10, "value: 0.5");
  std::ofstream(path_, std::ios::binary) << text;
  EXPECT_FALSE(LoadCalibration(path_, problems_));
  EXPECT_THAT(problems_, ElementsAre(HasSubstr("edited without sealing it again")));
  SealAgain();
  problems_.clear();
  const auto edited = LoadCalibration(path_, problems_);
  ASSERT_TRUE(edited) << testing::PrintToString(problems_);
  EXPECT_EQ(edited->parameters[0].value, 0.5);
}

// A seal keeps accidents out, not malice: whatever stands below it must be judged all the same.
TEST_F(CalibrationFileTest, SealedNonsenseIsRefusedOrHarmless) {
  const std::string whole = TextOf(path_);
  const std::string body = whole.substr(whole.find("version:"));
  Random random(20260131);
  int refused = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    std::string text = body.substr(0, body.rfind("checksum:"));
    for (int i = 0; i < 1 + trial % 4; ++i) {
      text[static_cast<std::size_t>(random.Uniform(0.0, static_cast<double>(text.size() - 1)))] =
          static_cast<char>(random.Uniform(1.0, 127.0));
    }
    Sha256 digest;
    digest.Add({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    const auto loaded = Parse(text + "checksum: " + digest.Hex() + "\n");
    if (!loaded) {
      ++refused;
      ASSERT_THAT(problems_, testing::Not(IsEmpty()));
      continue;
    }
    ASSERT_THAT(ProblemsOf(*loaded), IsEmpty());
    VehicleConfig vehicle;
    ApplyCalibration(*loaded, vehicle, problems_);
    ASSERT_LE(std::abs(vehicle.radars[0].x_m), 30.0);
    ASSERT_LE(std::abs(vehicle.speed_scale - 1.0), 0.1 + 1e-12);
  }
  EXPECT_GT(refused, 500);
  EXPECT_LT(refused, 2000);
}

TEST_F(CalibrationFileTest, AnotherVersionIsNamedAndNothingElse) {
  std::string text = TextOf(path_);
  text.replace(text.find("version: 1"), 10, "version: 2\nnews: 5");
  std::ofstream(path_, std::ios::binary) << text;
  SealAgain();
  EXPECT_FALSE(LoadCalibration(path_, problems_));
  EXPECT_THAT(problems_, ElementsAre(HasSubstr("version = 2: this program knows version 1")));
}

TEST_F(CalibrationFileTest, MissingFilesAndFoldersAreNamed) {
  EXPECT_FALSE(LoadCalibration((folder_ / "none.yaml").string(), problems_));
  EXPECT_FALSE(LoadCalibration(folder_.string(), problems_));
  EXPECT_THAT(problems_, ElementsAre(HasSubstr("No such file"), HasSubstr("is a folder")));
}

TEST_F(CalibrationFileTest, NonsenseIsNotWrittenOverAGoodFile) {
  const std::string before = TextOf(path_);
  CalibrationFile bad = Good();
  bad.parameters[0].std = 0.0;
  std::string error;
  EXPECT_FALSE(SaveCalibration(path_, bad, error));
  EXPECT_THAT(error, HasSubstr("radar_front.yaw_deg: std = 0: must be finite and above 0"));
  EXPECT_EQ(TextOf(path_), before);
}

TEST(CheckCalibration, NamesWhatIsWrong) {
  const auto problem_of = [](const std::function<void(CalibrationFile&)>& spoil) {
    CalibrationFile file = Good();
    spoil(file);
    const auto problems = ProblemsOf(file);
    return problems.size() == 1 ? problems[0] : testing::PrintToString(problems);
  };
  EXPECT_THAT(ProblemsOf(Good()), IsEmpty());
  EXPECT_EQ(problem_of([](auto& f) { f.parameters[1].value = kInf; }),
            "c.yaml: radar_front.x_m: value = inf: must be finite");
  EXPECT_EQ(problem_of([](auto& f) { f.parameters[1].prior = std::nan(""); }),
            "c.yaml: radar_front.x_m: prior = nan: must be finite");
  EXPECT_EQ(problem_of([](auto& f) { f.parameters[1].prior_std = -1.0; }),
            "c.yaml: radar_front.x_m: prior_std = -1: must be finite and above 0");
  EXPECT_EQ(problem_of([](auto& f) { f.parameters[1].name = "radar_front.z_m"; }),
            "c.yaml: parameter \"radar_front.z_m\": unknown name");
  EXPECT_EQ(problem_of([](auto& f) { f.parameters[1].name = "lidar.x_m"; }),
            "c.yaml: parameter \"lidar.x_m\": unknown name");
  EXPECT_EQ(problem_of([](auto& f) { f.parameters[1].name = f.parameters[3].name; }),
            "c.yaml: parameter \"ego.speed_scale\": stands twice");
  EXPECT_EQ(problem_of([](auto& f) { f.correlated[1] = "radar_front.y_m"; }),
            "c.yaml: correlated: \"radar_front.y_m\": is no parameter of this file");
  EXPECT_THAT(problem_of([](auto& f) { f.covariance.pop_back(); }),
              HasSubstr("covariance has 3 numbers for 2 correlated names"));
  EXPECT_EQ(problem_of([](auto& f) { f.covariance[1] = 5e-5; }),
            "c.yaml: covariance is not symmetric in radar_front.yaw_deg and "
            "camera_front.pitch_deg");
  EXPECT_THAT(problem_of([](auto& f) {
                f.covariance = {1e-4, 2e-4, 2e-4, 1e-4};
              }),
              HasSubstr("covariance is not positive"));
  EXPECT_THAT(problem_of([](auto& f) { f.covariance[3] = 0.0; }),
              HasSubstr("no positive variance for camera_front.pitch_deg"));
  EXPECT_THAT(problem_of([](auto& f) { f.covariance[3] = kInf; }), HasSubstr("not finite"));
  EXPECT_THAT(problem_of([](auto& f) { f.log_sha256[0][5] = 'X'; }), HasSubstr("64 hex digits"));
  EXPECT_THAT(problem_of([](auto& f) { f.created = "yesterday"; }), HasSubstr("must be like"));
  EXPECT_THAT(problem_of([](auto& f) {
                f.parameters.clear();
                f.correlated.clear();
                f.covariance.clear();
              }),
              HasSubstr("parameters: there are none"));
}

TEST(ApplyCalibration, OnlyWhatTheDriveToldTakesThePlaceOfTheConfigured) {
  VehicleConfig vehicle;
  std::vector<std::string> problems;
  CalibrationFile file = Good();
  file.parameters[0].verdict = CalibrationVerdict::kWeak;
  file.parameters[1].verdict = CalibrationVerdict::kPrior;
  ASSERT_TRUE(ApplyCalibration(file, vehicle, problems)) << testing::PrintToString(problems);
  EXPECT_EQ(vehicle.radars[0].yaw_rad, FromDegrees(0.4));
  EXPECT_EQ(vehicle.radars[0].x_m, 3.75);
  EXPECT_EQ(vehicle.cameras[0].pitch_rad, FromDegrees(-0.3));
  EXPECT_EQ(vehicle.speed_scale, 1.02);
  for (const auto verdict : {CalibrationVerdict::kAtBound, CalibrationVerdict::kRejected}) {
    VehicleConfig untouched;
    for (CalibratedParameter& parameter : file.parameters) {
      parameter.verdict = verdict;
      parameter.value = 1e9;  // A rejected value may be anything.
    }
    EXPECT_TRUE(ApplyCalibration(file, untouched, problems));
    EXPECT_EQ(untouched.radars[0].yaw_rad, 0.0);
    EXPECT_EQ(untouched.speed_scale, 1.0);
  }
}

TEST(ApplyCalibration, EveryNameReachesItsParameter) {
  VehicleConfig vehicle;
  CalibrationFile file;
  for (const char* name :
       {"radar_front_left.x_m", "radar_front_left.y_m", "camera_front.x_m", "camera_front.y_m",
        "camera_front.z_m", "ego.antenna_x_m", "ego.antenna_y_m", "ego.yaw_rate_bias_degps"}) {
    file.parameters.push_back(Parameter(name, 0.9, 100.0));
  }
  for (const char* name : {"radar_front_left.yaw_deg", "camera_front.yaw_deg",
                           "camera_front.roll_deg", "ego.heading_bias_deg"}) {
    file.parameters.push_back(Parameter(name, -1.5, 100.0));
  }
  std::vector<std::string> problems;
  ASSERT_TRUE(ApplyCalibration(file, vehicle, problems)) << testing::PrintToString(problems);
  const RadarConfig& radar = vehicle.radars[1];
  const CameraConfig& camera = vehicle.cameras[0];
  EXPECT_THAT((std::vector{radar.x_m, radar.y_m, camera.x_m, camera.y_m, camera.z_m,
                           vehicle.antenna_x_m, vehicle.antenna_y_m}),
              testing::Each(0.9));
  EXPECT_EQ(vehicle.yaw_rate_bias_radps, FromDegrees(0.9));
  EXPECT_THAT(
      (std::vector{radar.yaw_rad, camera.yaw_rad, camera.roll_rad, vehicle.heading_bias_rad}),
      testing::Each(FromDegrees(-1.5)));
}

TEST(ApplyCalibration, WhatDoesNotBelongToThisCarIsRefusedAsAWhole) {
  const auto problem_of = [](const std::function<void(CalibrationFile&, VehicleConfig&)>& spoil) {
    CalibrationFile file = Good();
    VehicleConfig vehicle;
    spoil(file, vehicle);
    std::vector<std::string> problems;
    EXPECT_FALSE(ApplyCalibration(file, vehicle, problems));
    EXPECT_EQ(vehicle.radars[0].yaw_rad, 0.0);
    EXPECT_EQ(vehicle.speed_scale, 1.0);
    return problems.size() == 1 ? problems[0] : testing::PrintToString(problems);
  };
  EXPECT_EQ(problem_of([](auto&, auto& v) { v.id = "car 8"; }),
            "is for vehicle \"car 7\", this one is \"car 8\"");
  EXPECT_EQ(problem_of([](auto& f, auto&) { f.parameters[4].name = "radar_rear.x_m"; }),
            "radar_rear.x_m: this vehicle has no such sensor");
  EXPECT_EQ(problem_of([](auto& f, auto&) {
              f.parameters[4].name = "radar_rear.x_m";
              f.parameters[4].verdict = CalibrationVerdict::kPrior;
            }),
            "radar_rear.x_m: this vehicle has no such sensor");
  EXPECT_THAT(problem_of([](auto&, auto& v) { v.cameras.push_back(v.cameras[0]); }),
              HasSubstr("camera_front.pitch_deg: two sensors of this vehicle are called so"));
  EXPECT_EQ(problem_of([](auto& f, auto&) { f.parameters[3].value = 1.11; }),
            "ego.speed_scale = 1.11: must be at least 0.9, at most 1.1");
  EXPECT_THAT(problem_of([](auto& f, auto&) { f.parameters[0].value = -3.01; }),
              HasSubstr("radar_front.yaw_deg = -3.01: farther from the configured 0 than 3 "
                        "prior_std of 1; is it another mount?"));
  EXPECT_THAT(problem_of([](auto& f, auto&) { f.parameters[1].value = 3.75 - 0.151; }),
              HasSubstr("radar_front.x_m = 3.599: farther from the configured 3.75"));
}

TEST(ApplyCalibration, AnglesAreComparedTheShortWayRound) {
  VehicleConfig vehicle;
  vehicle.radars[0].yaw_rad = FromDegrees(179.5);
  CalibrationFile file = Good();
  file.parameters = {Parameter("radar_front.yaw_deg", -179.5, 1.0)};
  std::vector<std::string> problems;
  EXPECT_TRUE(ApplyCalibration(file, vehicle, problems)) << testing::PrintToString(problems);
  EXPECT_EQ(vehicle.radars[0].yaw_rad, FromDegrees(-179.5));
}

}  // namespace
}  // namespace v2vouch
