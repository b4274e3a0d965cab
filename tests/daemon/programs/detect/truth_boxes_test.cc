// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/detect/truth_boxes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace v2vouch {
namespace {

using testing::HasSubstr;

std::string Written(const std::string& text) {
  const std::string path = testing::TempDir() + "v2vouch_truth_boxes_test.csv";
  std::ofstream(path) << text;
  return path;
}

constexpr char kHeader[] = "image,extra,type,occluded,left,top,right,bottom\n";

TEST(ReadTruth, OnlyVehiclesThatCanBeSeenCount) {
  const std::string path = Written(std::string(kHeader) +
                                   "a.png,x,Car,0,10,20,60,50\n"
                                   "a.png,x,Car,2,10,20,60,50\n"      // Mostly hidden.
                                   "a.png,x,Truck,1,10,20,60,44.9\n"  // Under 25 px.
                                   "a.png,x,Cyclist,0,10,20,60,90\n"  //
                                   "b.png,x,DontCare,-1,0,0,5,5\r\n");
  TruthTable truth;
  std::string error;
  ASSERT_TRUE(ReadTruth(path, truth, error)) << error;
  ASSERT_EQ(truth.at("a.png").size(), 4u);
  EXPECT_TRUE(truth.at("a.png")[0].counts);
  for (std::size_t i = 1; i < 4; ++i) EXPECT_FALSE(truth.at("a.png")[i].counts) << i;
  EXPECT_EQ(truth.at("a.png")[0].box.width_px, 50.0);
  EXPECT_EQ(truth.at("b.png").size(), 1u);
}

TEST(ReadTruth, FaultsNameFileAndLine) {
  TruthTable truth;
  std::string error;
  EXPECT_FALSE(ReadTruth("/nowhere.csv", truth, error));
  EXPECT_THAT(error, HasSubstr("/nowhere.csv: cannot be read"));
  EXPECT_FALSE(ReadTruth(Written("image,type\n"), truth, error));
  EXPECT_THAT(error, HasSubstr(":1: no column occluded"));
  for (const char* row : {"a.png,x,Car,0,10,20,60\n", "a.png,x,Car,0,10,nan,60,50\n",
                          "a.png,x,Car,0,60,20,10,50\n", "a.png,x,Car,zero,10,20,60,50\n"}) {
    EXPECT_FALSE(ReadTruth(Written(std::string(kHeader) + row), truth, error)) << row;
    EXPECT_THAT(error, HasSubstr(":2: is no labelled box"));
  }
}

TruthBox Truth(double left, bool counts, ObjectClass type = ObjectClass::kCar) {
  return {{left, 0, 50, 40, type, 1.0}, counts};
}
CameraBox Seen(double left, ObjectClass type = ObjectClass::kCar) {
  return {left, 0, 50, 40, type, 0.5};
}

TEST(AddScore, EachTruthIsFoundOnce) {
  FindScore score;
  AddScore({Seen(0), Seen(2), Seen(300)}, {Truth(0, true), Truth(100, true)}, score);
  EXPECT_EQ(score.truths, 2);
  EXPECT_EQ(score.found, 1);
  EXPECT_EQ(score.false_boxes, 2);
  EXPECT_DOUBLE_EQ(score.recall(), 0.5);
  EXPECT_DOUBLE_EQ(score.precision(), 1.0 / 3.0);
}

TEST(AddScore, IgnoredObjectsAreNeitherMissedNorFalse) {
  FindScore score;
  CameraBox small = Seen(700);
  small.height_px = 20;
  AddScore({Seen(0), Seen(210), small, Seen(0, ObjectClass::kPedestrian)},
           {Truth(0, false), Truth(200, false, ObjectClass::kUnknown)}, score);
  EXPECT_EQ(score.truths, 0);
  EXPECT_EQ(score.found, 0);
  EXPECT_EQ(score.false_boxes, 0);
}

}  // namespace
}  // namespace v2vouch
