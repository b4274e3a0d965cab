// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "daemon/common/data/input.h"

namespace v2vouch {

/// One labelled object of a picture.
struct TruthBox {
  CameraBox box;
  /// Counts: a car, van, lorry or bus at least 25 px high, at most partly occluded (KITTI's 0 or
  /// 1). Others are ignored: neither missed nor false when found.
  bool counts = false;
};

/// Labelled pictures: file (as in the table) -> its objects.
using TruthTable = std::map<std::string, std::vector<TruthBox>>;

/// Reads a table with the columns image, type, occluded, left, top, right, bottom (others are
/// skipped), pixels; types in KITTI's words (Car, Van, Truck, Bus, DontCare, anything else).
/// @return false with `error` naming file, line and fault.
bool ReadTruth(const std::string& path, TruthTable& truth, std::string& error);

/// How many of the labelled vehicles were found.
struct FindScore {
  int truths = 0;
  int found = 0;
  int false_boxes = 0;

  /// Of the labelled vehicles; NaN where there is none.
  [[nodiscard]] double recall() const { return truths > 0 ? 1.0 * found / truths : NAN; }
  /// Of what was reported; NaN where nothing was.
  [[nodiscard]] double precision() const {
    return found + false_boxes > 0 ? 1.0 * found / (found + false_boxes) : NAN;
  }
};

/// Adds one picture. Boxes of cars, vans, lorries and buses, strongest first, each take the free
/// truth they overlap most, from an intersection over union of 0.5 on; the class is not compared. A
/// box without truth is false unless it is under 25 px high, takes an ignored vehicle in the same
/// way, or lies by more than half inside a region of type DontCare.
void AddScore(const std::vector<CameraBox>& boxes, const std::vector<TruthBox>& truths,
              FindScore& score);

}  // namespace v2vouch
