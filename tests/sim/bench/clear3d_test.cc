// SPDX-License-Identifier: Apache-2.0
#include "sim/bench/clear3d.h"

#include <gtest/gtest.h>

#include <cmath>

#include "daemon/common/base/angle.h"

namespace v2vouch::bench {
namespace {

Box3d Car(double x_m, double y_m, double yaw_rad = 0.0) {
  return {.x_m = x_m,
          .y_m = y_m,
          .bottom_m = -1.65,
          .yaw_rad = yaw_rad,
          .length_m = 4.0,
          .width_m = 2.0,
          .height_m = 1.5};
}

constexpr PixelBox kLarge{100.0, 100.0, 200.0, 160.0};

TrackedBox Row(std::uint64_t id, const Box3d& box, double score = 1.0) {
  return {.id = id, .score = score, .box = box, .pixels = kLarge, .covariance = {}};
}

EvaluatedFrame Frame(std::vector<TruthBox> truth, std::vector<TrackedBox> tracked) {
  return {std::move(truth), {}, std::move(tracked)};
}

Clear3dFigures Evaluate(const EvaluatedSequence& sequence) {
  return EvaluateClear3d(std::span(&sequence, 1), 0.25);
}

TEST(Iou3d, IsTheShareOfTheCommonVolume) {
  EXPECT_NEAR(Iou3d(Car(10, 0), Car(10, 0)), 1.0, 1e-12);
  EXPECT_NEAR(Iou3d(Car(10, 0), Car(12, 0)), 1.0 / 3.0, 1e-12);             // 2 of 4 m.
  EXPECT_NEAR(Iou3d(Car(10, 0), Car(10, 0, 0.5 * kPi)), 1.0 / 3.0, 1e-12);  // 2 x 2 of 8 + 8.
  EXPECT_NEAR(Iou3d(Car(10, 0, 0.3), Car(10, 0, 0.3 + kPi)), 1.0, 1e-12);
  EXPECT_EQ(Iou3d(Car(10, 0), Car(15, 0)), 0.0);
  Box3d above = Car(10, 0);
  above.bottom_m += 0.75;
  EXPECT_NEAR(Iou3d(Car(10, 0), above), 1.0 / 3.0, 1e-12);
  above.bottom_m += 1.0;
  EXPECT_EQ(Iou3d(Car(10, 0), above), 0.0);
}

TEST(Clear3d, ATrackOnEveryTruthIsPerfect) {
  EvaluatedSequence sequence;
  for (int k = 0; k < 10; ++k) {
    sequence.push_back(Frame({{1, Car(10 + k, 0)}, {2, Car(20, 5)}},
                             {Row(7, Car(10 + k, 0)), Row(8, Car(20, 5))}));
  }
  const Clear3dFigures f = Evaluate(sequence);
  EXPECT_NEAR(f.samota, 1.0, 1e-12);
  EXPECT_NEAR(f.best.mota(), 1.0, 1e-12);
  EXPECT_NEAR(f.best.motp(), 1.0, 1e-12);
  EXPECT_EQ(f.best.truths, 20);
}

TEST(Clear3d, CountsSwitchesAndFragments) {
  EvaluatedSequence sequence;
  sequence.push_back(Frame({{1, Car(10, 0)}}, {Row(7, Car(10, 0))}));
  sequence.push_back(Frame({{1, Car(10, 0)}}, {Row(9, Car(10, 0))}));  // Another track.
  sequence.push_back(Frame({{1, Car(10, 0)}}, {}));
  sequence.push_back(Frame({{1, Car(10, 0)}}, {Row(9, Car(10, 0))}));  // Held again.
  const ClearCounts best = Evaluate(sequence).best;
  EXPECT_EQ(best.switches, 1);
  EXPECT_EQ(best.fragments, 1);
  EXPECT_EQ(best.misses, 1);
  EXPECT_NEAR(best.mota(), 0.5, 1e-12);
}

TEST(Clear3d, WhatNobodyLabelledIsNotFalse) {
  const std::vector<TruthBox> truth = {{1, Car(10, 0)}, {2, Car(30, 0), true}};
  std::vector<TrackedBox> rows = {Row(7, Car(10, 0)), Row(8, Car(30, 0)), Row(9, Car(50, 0))};
  EXPECT_EQ(Evaluate({Frame(truth, rows)}).best.false_boxes, 1);  // 8 lies on an ignored truth.
  rows[2].pixels.bottom = rows[2].pixels.top + 25.0;
  EXPECT_EQ(Evaluate({Frame(truth, rows)}).best.false_boxes, 0);
  rows[2].pixels = kLarge;
  EvaluatedFrame frame = Frame(truth, rows);
  frame.regions.push_back({0.0, 0.0, 160.0, 400.0});
  EXPECT_EQ(Evaluate({frame}).best.false_boxes, 0);
}

TEST(Clear3d, ATrackIsKeptOrLeftOutByItsMeanScore) {
  // The false track begins with a high score, but its mean is the lowest.
  EvaluatedSequence sequence;
  sequence.push_back(Frame({{1, Car(10, 0)}}, {Row(7, Car(10, 0), 2.0), Row(9, Car(40, 0), 3.0)}));
  sequence.push_back(Frame({{1, Car(10, 0)}}, {Row(7, Car(10, 0), 2.0), Row(9, Car(40, 0), -3.0)}));
  const Clear3dFigures f = Evaluate(sequence);
  EXPECT_EQ(f.best.false_boxes, 0);
  EXPECT_NEAR(f.best.mota(), 1.0, 1e-12);
}

TEST(Clear3d, UnreachedRecallsCountNothing) {
  // Half of the truths are found and nothing is false: recalls up to 20/40 are perfect.
  EvaluatedSequence sequence;
  for (int k = 0; k < 20; ++k) {
    sequence.push_back(Frame({{1, Car(10, 0)}, {2, Car(30, 0)}}, {Row(7, Car(10, 0))}));
  }
  const Clear3dFigures f = Evaluate(sequence);
  EXPECT_NEAR(f.samota, 0.5, 1e-12);
  // One track, one score: every threshold keeps it.
  EXPECT_NEAR(f.amota, 0.5 * 0.5, 1e-12);
}

TEST(Clear3d, HonestCovariancesGiveAneesOne) {
  EvaluatedSequence sequence;
  for (const double off : {0.1, -0.1}) {
    TrackedBox row = Row(7, Car(10 + off, off));
    row.covariance = 0.01 * Eigen::Matrix2d::Identity();
    sequence.push_back(Frame({{1, Car(10, 0)}}, {row}));
  }
  EXPECT_NEAR(Evaluate(sequence).best.anees(), 1.0, 1e-9);
}

TEST(Clear3d, NothingLabelledHasNoFigure) {
  EXPECT_TRUE(std::isnan(Evaluate({Frame({}, {Row(7, Car(10, 0))})}).best.mota()));
}

}  // namespace
}  // namespace v2vouch::bench
