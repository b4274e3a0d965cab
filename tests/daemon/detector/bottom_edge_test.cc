// SPDX-License-Identifier: Apache-2.0
#include "daemon/detector/bottom_edge.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace v2vouch {
namespace {

// A dark car, rows 60..99, on a bright road, blurred like a real lens.
cv::Mat CarOnRoad() {
  cv::Mat grey(160, 200, CV_8UC1, cv::Scalar(140));
  grey(cv::Rect(50, 60, 80, 40)).setTo(30);
  cv::GaussianBlur(grey, grey, {}, 1.0);
  return grey;
}

TEST(BottomEdge, FindsTheRoadAboveAndBelow) {
  const cv::Mat grey = CarOnRoad();
  for (const double error : {-4.0, -1.5, 0.0, 2.0, 4.0}) {
    const CameraBox box{50, 60, 80, 40 + error, ObjectClass::kCar, 1.0};
    EXPECT_NEAR(BottomEdge(grey, box), 100.0, 0.3) << "box off by " << error;
  }
}

TEST(BottomEdge, WithoutAnEdgeTheBoxStays) {
  const cv::Mat grey(160, 200, CV_8UC1, cv::Scalar(140));
  const CameraBox box{50, 60, 80, 40, ObjectClass::kCar, 1.0};
  EXPECT_EQ(BottomEdge(grey, box), 100.0);
}

TEST(BottomEdge, AtThePicturesBorderTheBoxStays) {
  const cv::Mat grey = CarOnRoad();
  EXPECT_EQ(BottomEdge(grey, {50, 60, 80, 100, ObjectClass::kCar, 1.0}), 160.0);
  EXPECT_EQ(BottomEdge(grey, {199, 60, 1, 40, ObjectClass::kCar, 1.0}), 100.0);
  EXPECT_EQ(BottomEdge(grey, {-500, -500, 80, 40, ObjectClass::kCar, 1.0}), -460.0);
}

}  // namespace
}  // namespace v2vouch
