// SPDX-License-Identifier: Apache-2.0
// The program as users call it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/daemon/detection/data_folder.h"

namespace v2vouch {
namespace {

using testing::HasSubstr;

struct Outcome {
  int code = -1;
  std::string text;  // Standard output and errors.
};

Outcome Called(const std::string& arguments) {
  Outcome outcome;
  std::FILE* const pipe =
      popen((std::string(V2VOUCH_DETECT) + " " + arguments + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return outcome;
  char buffer[4096];
  while (std::fgets(buffer, sizeof(buffer), pipe) != nullptr) outcome.text += buffer;
  const int status = pclose(pipe);
  if (WIFEXITED(status)) outcome.code = WEXITSTATUS(status);
  return outcome;
}

TEST(V2vouchDetect, HelpAndUsage) {
  EXPECT_EQ(Called("--help").code, 0);
  EXPECT_THAT(Called("--help").text, HasSubstr("Examples:"));
  EXPECT_THAT(Called("--version").text, HasSubstr("v2vouch-detect "));
  EXPECT_EQ(Called("").code, 2);
  EXPECT_EQ(Called("a.png --degrade upside_down").code, 2);
  EXPECT_EQ(Called("--log a.lcm").code, 2);
  const Outcome bare = Called("a.png");
  EXPECT_EQ(bare.code, 2);
  EXPECT_THAT(bare.text, HasSubstr("no network: name one in detector.model"));
  const Outcome absent = Called("a.png --model /nowhere/yolov4.weights");
  EXPECT_EQ(absent.code, 2);
  EXPECT_THAT(absent.text, HasSubstr("scripts/fetch_yolov4"));
  EXPECT_THAT(Called("a.png --model x.onnx --input 12").text, HasSubstr("--input 12"));
}

TEST(V2vouchDetect, LooksScoresAndDraws) {
  const auto data = DataFolder();
  if (!std::filesystem::exists(data / "models")) {
    GTEST_SKIP() << "SKIPPED: no models under V2VOUCH_DATA";
  }
  const std::string model =
      " --model " + (data / "models/yolo-fastest-1.1.weights").string() + " --input 416x416";
  const std::string image = (data / "images/kitti_tracking/0001_000010.png").string();
  const std::string folder = testing::TempDir() + "v2vouch_detect_drawn";
  const Outcome looked = Called(image + model + " --json --draw " + folder);
  ASSERT_EQ(looked.code, 0) << looked.text;
  const auto report = nlohmann::json::parse(looked.text);
  ASSERT_EQ(report.size(), 1u);
  EXPECT_EQ(report[0]["image"], image);
  EXPECT_GT(report[0]["ms"], 0.0);
  ASSERT_FALSE(report[0]["boxes"].empty());
  for (const char* key : {"class", "score", "x", "y", "width", "height"}) {
    EXPECT_TRUE(report[0]["boxes"][0].contains(key)) << key;
  }
  EXPECT_TRUE(std::filesystem::exists(folder + "/0001_000010.png"));

  const std::string table = (data / "images/kitti_ground_truth.csv").string();
  const Outcome scored = Called("--json --truth " + table + model);
  ASSERT_EQ(scored.code, 0) << scored.text;
  const auto score = nlohmann::json::parse(scored.text);
  EXPECT_EQ(score["truths"], 18);
  EXPECT_GT(score["recall"], 0.3);
  EXPECT_GT(score["precision"], 0.5);
  EXPECT_EQ(Called("/nowhere.png" + model).code, 1);
}

}  // namespace
}  // namespace v2vouch
