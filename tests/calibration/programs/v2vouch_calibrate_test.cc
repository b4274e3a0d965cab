// SPDX-License-Identifier: Apache-2.0
// v2vouch-calibrate as its users meet it: a child process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "daemon/rim/calibration_file/calibration_file.h"
#include "tests/support/child_process.h"

namespace v2vouch {
namespace {

using testing::HasSubstr;

class Calibrate : public testing::Test {
 protected:
  Calibrate() { std::filesystem::create_directories(folder_); }
  ~Calibrate() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string File(const char* name) const { return (folder_ / name).string(); }
  void Drive(const char* scenario, const char* options, const char* log) const {
    const Finished made = Called(
        V2VOUCH_SIM, std::string("run ") + scenario + " " + options + " --out '" + File(log) + "'");
    ASSERT_EQ(made.code, 0) << made.output;
  }
  [[nodiscard]] Finished Calibrated(const std::string& arguments) const {
    return Execute(std::string("'") + V2VOUCH_CALIBRATE + "' " + arguments);
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("v2vouch_calibrate_" + std::to_string(getpid()));
};

constexpr const char* kPoints = " --config daemon/vehicles/vehicle_points.yaml";

TEST_F(Calibrate, WritesAFileThatTheDaemonTakesAndAReport) {
  Drive("calibration_drive", "--duration 90 --seed 2", "drive.lcm");
  const std::string out = File("calibration.yaml");
  const Finished done = Calibrated("'" + File("drive.lcm") + "'" + kPoints + " --out '" + out +
                                   "' --report '" + File("report") + "' --json");
  ASSERT_EQ(done.code, 0) << done.output;
  const auto json = nlohmann::json::parse(done.output);
  EXPECT_TRUE(json["accepted"].get<bool>());
  bool has_yaw = false;
  for (const auto& p : json["parameters"]) {
    if (p["name"] != "radar_front.yaw_deg") continue;
    has_yaw = true;
    EXPECT_EQ(p["verdict"], "ESTIMATED");
    EXPECT_NEAR(p["value"].get<double>(), 1.0, 4.5 * p["std"].get<double>());
    EXPECT_EQ(p["determined_by"], "radar_front.doppler");
  }
  EXPECT_TRUE(has_yaw);
  EXPECT_FALSE(json["remotes"].empty());

  std::vector<std::string> problems;
  const auto file = LoadCalibration(out, problems);
  ASSERT_TRUE(file) << problems.front();
  EXPECT_EQ(file->log_sha256.size(), 1u);
  EXPECT_EQ(file->created.substr(0, 16), "2026-06-15T08:01");
  VehicleConfig vehicle;
  EXPECT_TRUE(ApplyCalibration(*file, vehicle, problems));
  EXPECT_NEAR(vehicle.radars[0].yaw_rad, FromDegrees(1.0), FromDegrees(0.15));

  std::ifstream page(File("report/index.html"));
  std::stringstream text;
  text << page.rdbuf();
  EXPECT_THAT(text.str(), HasSubstr("<svg"));
  EXPECT_THAT(text.str(), HasSubstr("radar_front_left.yaw_deg"));
}

TEST_F(Calibrate, BsmsNeverMoveAMounting) {
  // The same drive, once with all senders off by 4 m and late: stage A says the same to the digit.
  Drive("calibration_drive", "--duration 40 --seed 3", "a.lcm");
  Drive("calibration_drive",
        "--duration 40 --seed 3 --set bsm.gnss.bias_sigma_m=4 --set bsm.rate_hz=5", "b.lcm");
  const auto parameters = [&](const char* log) {
    const Finished done =
        Calibrated("'" + File(log) + "'" + kPoints + " --out '" + File("c.yaml") + "' --json");
    EXPECT_EQ(done.code, 0) << done.output;
    return nlohmann::json::parse(done.output)["parameters"];
  };
  const auto a = parameters("a.lcm");
  const auto b = parameters("b.lcm");
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_NEAR(a[i]["value"].get<double>(), b[i]["value"].get<double>(),
                0.01 * a[i]["std"].get<double>())
        << a[i]["name"];
  }
}

TEST_F(Calibrate, ALiarLeavesStageAAsItIsBitForBit) {
  std::ofstream(File("liar.yaml")) << "attacks:\n  - who: {vehicles: [1]}\n"
                                      "    change: [{rotate: {about_ego_deg: 3}}]\n";
  Drive("calibration_drive", "--duration 40 --seed 3", "a.lcm");
  Drive("calibration_drive", ("--duration 40 --seed 3 --with '" + File("liar.yaml") + "'").c_str(),
        "b.lcm");
  const auto result = [&](const char* log) {
    const Finished done =
        Calibrated("'" + File(log) + "'" + kPoints + " --out '" + File("c.yaml") + "' --json");
    EXPECT_EQ(done.code, 0) << done.output;
    return nlohmann::json::parse(done.output);
  };
  const auto honest = result("a.lcm");
  const auto attacked = result("b.lcm");
  for (const char* of_stage_a : {"accepted", "parameters", "covariance", "weak", "chi2"}) {
    EXPECT_EQ(honest[of_stage_a], attacked[of_stage_a]) << of_stage_a;
  }
  EXPECT_NE(honest["remotes"], attacked["remotes"]);  // Stage B did hear it.
}

TEST_F(Calibrate, WhatIsNotAcceptedReplacesNothing) {
  const std::string out = File("calibration.yaml");
  std::ofstream(out) << "what was there before";
  // The vehicle file has the front radar looking to the side: 3 sigma and more from where it does.
  std::ofstream(File("wrong.yaml"))
      << "vehicle:\n  radars:\n"
         "    - {name: FRONT, x_m: 3.75, yaw_deg: 5, half_fov_deg: 30, "
         "max_range_m: 160, azimuth_sigma_deg: 0.3}\n"
         "tracking: {point_targets: true}\n";
  Drive("calibration_drive", "--duration 40 --seed 4", "drive.lcm");
  const Finished done = Calibrated("'" + File("drive.lcm") + "' --config '" + File("wrong.yaml") +
                                   "' --out '" + out + "' 2>&1");
  EXPECT_EQ(done.code, 1);
  EXPECT_THAT(done.output, HasSubstr("is as it was"));
  EXPECT_THAT(done.output, HasSubstr("radar_front"));
  std::ifstream file(out);
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(line, "what was there before");
}

TEST_F(Calibrate, BadInputIsNamed) {
  EXPECT_EQ(Calibrated("2>&1").code, 2);
  const Finished missing = Calibrated("/nowhere.lcm --out '" + File("c.yaml") + "' 2>&1");
  EXPECT_EQ(missing.code, 1);
  EXPECT_THAT(missing.output, HasSubstr("/nowhere.lcm"));
  std::ofstream(File("bad.yaml")) << "vehicle: {lengthh_m: 3}\n";
  const Finished config =
      Calibrated("x.lcm --config '" + File("bad.yaml") + "' --out '" + File("c.yaml") + "' 2>&1");
  EXPECT_EQ(config.code, 2);
  EXPECT_THAT(config.output, HasSubstr("lengthh_m"));
  std::ofstream(File("no.lcm")) << "this is no log";
  EXPECT_EQ(Calibrated("'" + File("no.lcm") + "' --out '" + File("c.yaml") + "' 2>&1").code, 1);
  EXPECT_FALSE(std::filesystem::exists(File("c.yaml")));
  const Finished help = Calibrated("--help");
  EXPECT_EQ(help.code, 0);
  EXPECT_THAT(help.output, HasSubstr("Exit codes"));
}

}  // namespace
}  // namespace v2vouch
