// SPDX-License-Identifier: Apache-2.0
#include "daemon/detector/yolo_boxes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace v2vouch {
namespace {

// A network of three classes: car, something we do not use, pedestrian.
DetectorConfig ThreeClasses() {
  DetectorConfig config;
  config.classes = {{0, ObjectClass::kCar}, {2, ObjectClass::kPedestrian}};
  return config;
}

TEST(DarknetBoxes, SharesOfTheInputBecomePixels) {
  const std::vector<float> row = {0.5F, 0.25F, 0.1F, 0.2F, 0.9F, 0.8F, 0.1F, 0.0F};
  std::vector<CameraBox> boxes;
  AddDarknetBoxes({row, 8}, {200, 100}, ThreeClasses(), boxes);
  ASSERT_EQ(boxes.size(), 1u);
  EXPECT_NEAR(boxes[0].left_px, 100.0 - 10.0, 1e-4);
  EXPECT_NEAR(boxes[0].top_px, 25.0 - 10.0, 1e-4);
  EXPECT_NEAR(boxes[0].width_px, 20.0, 1e-4);
  EXPECT_NEAR(boxes[0].height_px, 20.0, 1e-4);
  EXPECT_EQ(boxes[0].object_class, ObjectClass::kCar);
  EXPECT_NEAR(boxes[0].score, 0.8, 1e-6);  // Objectness is in the class score already.
}

TEST(DarknetBoxes, WeakUnwantedAndBrokenRowsAreLeftOut) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> rows = {
      0.5F, 0.5F, 0.1F, 0.1F, 1.0F, 0.29F, 0.0F, 0.0F,   // Under 0.3.
      0.5F, 0.5F, 0.1F, 0.1F, 1.0F, 0.5F,  0.6F, 0.0F,   // Best class is none of ours.
      nan,  0.5F, 0.1F, 0.1F, 1.0F, 0.9F,  0.0F, 0.0F,   //
      0.5F, 0.5F, 0.1F, 0.1F, 1.0F, nan,   nan,  nan,    //
      0.5F, 0.5F, 0.0F, 0.1F, 1.0F, 0.9F,  0.0F, 0.0F};  // No width.
  std::vector<CameraBox> boxes;
  AddDarknetBoxes({rows, 8}, {100, 100}, ThreeClasses(), boxes);
  EXPECT_TRUE(boxes.empty());
}

// One cell of the middle grid set by hand: 64 x 32 input, strides 8 (8 x 4), 16 (4 x 2), 32 (2 x
// 1).
TEST(YoloxBoxes, CellsOfTheThreeGrids) {
  constexpr std::size_t kRows = 32 + 8 + 2;
  std::vector<float> values(kRows * 8, 0.0F);
  float* const row = &values[(32 + 4 + 3) * 8];  // Stride 16, second line, fourth cell.
  row[0] = 0.5F;
  row[1] = -0.25F;
  row[2] = std::log(2.0F);
  row[3] = 0.0F;
  row[4] = 0.8F;
  row[7] = 0.5F;
  std::vector<CameraBox> boxes;
  ASSERT_TRUE(AddYoloxBoxes({values, 8}, {64, 32}, ThreeClasses(), boxes));
  ASSERT_EQ(boxes.size(), 1u);
  EXPECT_NEAR(boxes[0].left_px + 0.5 * boxes[0].width_px, 3.5 * 16.0, 1e-4);
  EXPECT_NEAR(boxes[0].top_px + 0.5 * boxes[0].height_px, 0.75 * 16.0, 1e-4);
  EXPECT_NEAR(boxes[0].width_px, 32.0, 1e-4);
  EXPECT_NEAR(boxes[0].height_px, 16.0, 1e-4);
  EXPECT_EQ(boxes[0].object_class, ObjectClass::kPedestrian);
  EXPECT_NEAR(boxes[0].score, 0.4, 1e-6);
  values.resize((kRows - 1) * 8);
  EXPECT_FALSE(AddYoloxBoxes({values, 8}, {64, 32}, ThreeClasses(), boxes));
  EXPECT_EQ(boxes.size(), 1u);
}

TEST(SuppressNonMaxima, OneVehicleUnderTwoNamesIsOne) {
  std::vector<CameraBox> boxes = {{0, 0, 100, 50, ObjectClass::kCar, 0.6},
                                  {5, 0, 100, 50, ObjectClass::kTruck, 0.7},
                                  {5, 0, 100, 50, ObjectClass::kPedestrian, 0.5},
                                  {80, 0, 100, 50, ObjectClass::kCar, 0.4}};
  SuppressNonMaxima(0.45, boxes);
  ASSERT_EQ(boxes.size(), 3u);
  EXPECT_EQ(boxes[0].object_class, ObjectClass::kTruck);
  EXPECT_EQ(boxes[1].object_class, ObjectClass::kPedestrian);
  EXPECT_EQ(boxes[2].left_px, 80.0);
}

TEST(IntersectionOverUnion, KnownShares) {
  const CameraBox a{0, 0, 10, 10, ObjectClass::kCar, 1.0};
  EXPECT_DOUBLE_EQ(IntersectionOverUnion(a, a), 1.0);
  EXPECT_DOUBLE_EQ(IntersectionOverUnion(a, {5, 0, 10, 10, ObjectClass::kCar, 1.0}), 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(IntersectionOverUnion(a, {10, 0, 10, 10, ObjectClass::kCar, 1.0}), 0.0);
}

}  // namespace
}  // namespace v2vouch
