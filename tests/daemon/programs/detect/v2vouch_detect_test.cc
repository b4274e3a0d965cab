// SPDX-License-Identifier: Apache-2.0
// The program as users call it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/child_process.h"
#include "tests/support/data_folder.h"

namespace v2vouch {
namespace {

using testing::HasSubstr;

Finished Detect(const std::string& arguments) { return Called(V2VOUCH_DETECT, arguments); }

TEST(V2vouchDetect, HelpAndUsage) {
  EXPECT_EQ(Detect("--help").code, 0);
  EXPECT_THAT(Detect("--help").output, HasSubstr("Examples:"));
  EXPECT_THAT(Detect("--version").output, HasSubstr("v2vouch-detect "));
  EXPECT_EQ(Detect("").code, 2);
  EXPECT_EQ(Detect("a.png --degrade upside_down").code, 2);
  EXPECT_THAT(Detect("a.png --degrade nosy").output, HasSubstr("did you mean noisy?"));
  EXPECT_EQ(Detect("--log a.lcm").code, 2);
  const Finished bare = Detect("a.png");
  EXPECT_EQ(bare.code, 2);
  EXPECT_THAT(bare.output, HasSubstr("no network: name one in detector.model"));
  const Finished absent = Detect("a.png --model /nowhere/yolov4.weights");
  EXPECT_EQ(absent.code, 2);
  EXPECT_THAT(absent.output, HasSubstr("scripts/fetch_yolov4"));
  EXPECT_THAT(Detect("a.png --model x.onnx --input 12").output, HasSubstr("--input 12"));
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
  const Finished looked = Detect(image + model + " --json --draw " + folder);
  ASSERT_EQ(looked.code, 0) << looked.output;
  const auto report = nlohmann::json::parse(looked.output);
  ASSERT_EQ(report.size(), 1u);
  EXPECT_EQ(report[0]["image"], image);
  EXPECT_GT(report[0]["ms"], 0.0);
  ASSERT_FALSE(report[0]["boxes"].empty());
  for (const char* key : {"class", "score", "x", "y", "width", "height"}) {
    EXPECT_TRUE(report[0]["boxes"][0].contains(key)) << key;
  }
  EXPECT_TRUE(std::filesystem::exists(folder + "/0001_000010.png"));

  const std::string table = (data / "images/kitti_ground_truth.csv").string();
  const Finished scored = Detect("--json --truth " + table + model);
  ASSERT_EQ(scored.code, 0) << scored.output;
  const auto score = nlohmann::json::parse(scored.output);
  EXPECT_EQ(score["truths"], 18);
  EXPECT_GT(score["recall"], 0.3);
  EXPECT_GT(score["precision"], 0.5);
  EXPECT_EQ(Detect("/nowhere.png" + model).code, 1);
}

}  // namespace
}  // namespace v2vouch
