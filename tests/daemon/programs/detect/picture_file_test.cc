// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/detect/picture_file.h"

#include <gtest/gtest.h>

#include <fstream>

namespace v2vouch {
namespace {

TEST(PictureFile, DrawnBoxesAreReadBack) {
  const std::string path = testing::TempDir() + "v2vouch_drawn.png";
  const cv::Mat black(80, 100, CV_8UC3, cv::Scalar::all(0));
  std::string error;
  ASSERT_TRUE(WriteAnnotated(path, black, {{20, 30, 40, 30, ObjectClass::kCar, 0.9}}, {}, error));
  const cv::Mat drawn = ReadPicture(path, error);
  ASSERT_EQ(drawn.size(), black.size()) << error;
  EXPECT_GT(drawn.at<cv::Vec3b>(45, 20)[1], 150);  // Green frame of a car.
  EXPECT_EQ(drawn.at<cv::Vec3b>(45, 40)[1], 0);
  EXPECT_FALSE(WriteAnnotated("/nowhere/x.png", black, {}, {}, error));
  EXPECT_FALSE(WriteAnnotated(path, black, {}, std::vector<std::string>{path}, error));
  EXPECT_EQ(error, path + ": is the file that is being read");
}

TEST(PictureFile, WhatIsNoPictureIsNamed) {
  std::string error;
  EXPECT_TRUE(ReadPicture("/nowhere.png", error).empty());
  EXPECT_EQ(error, "/nowhere.png: no such file");
  const std::string path = testing::TempDir() + "v2vouch_no_picture.png";
  std::ofstream(path) << "text";
  EXPECT_TRUE(ReadPicture(path, error).empty());
  EXPECT_EQ(error, path + ": is no picture that can be read");
}

TEST(Degraded, WhatEachDoes) {
  const cv::Mat grey(64, 64, CV_8UC3, cv::Scalar::all(160));
  const auto mean_of = [](const cv::Mat& m) { return cv::mean(m)[0]; };
  const auto spread_of = [](const cv::Mat& m) {
    cv::Scalar mean;
    cv::Scalar deviation;
    cv::meanStdDev(m, mean, deviation);
    return deviation[0];
  };
  EXPECT_EQ(cv::norm(Degraded(grey, "none"), grey, cv::NORM_INF), 0.0);
  // 160 at a sixteenth of the light through gamma 2.2: 160 / 16^(1 / 2.2).
  EXPECT_NEAR(mean_of(Degraded(grey, "dark")), 45.4, 1.0);
  EXPECT_NEAR(mean_of(Degraded(grey, "noisy")), 160.0, 1.5);
  EXPECT_NEAR(spread_of(Degraded(grey, "noisy")), 25.0, 1.5);
  cv::Mat halves = grey.clone();
  halves.colRange(0, 32).setTo(cv::Scalar::all(80));
  EXPECT_NEAR(spread_of(Degraded(halves, "flat")), 40.0 / 4.0, 1.0);
  EXPECT_TRUE(Degraded(grey, "upside down").empty());
}

}  // namespace
}  // namespace v2vouch
