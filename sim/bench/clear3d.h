// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sim/bench/box3d.h"

namespace v2vouch::bench {

/// One labelled vehicle of one frame.
struct TruthBox {
  int id = 0;
  Box3d box;
  bool is_ignored = false;  ///< Neither a miss nor a hit; what matches it is no false box either.
};

/// One row of a tracker's answer.
struct TrackedBox {
  std::uint64_t id = 0;
  double score = 0.0;
  Box3d box;
  PixelBox pixels;
  std::optional<Eigen::Matrix2d> covariance;  ///< Of [x, y], where ANEES is wanted.
};

struct EvaluatedFrame {
  std::vector<TruthBox> truth;
  std::vector<PixelBox> regions;  ///< Nobody labelled what is in there (KITTI's DontCare).
  std::vector<TrackedBox> tracked;
};
using EvaluatedSequence = std::vector<EvaluatedFrame>;

/// CLEAR counts at one threshold of the score (Bernardin and Stiefelhagen 2008).
struct ClearCounts {
  int hits = 0;
  int false_boxes = 0;
  int misses = 0;
  int switches = 0;   ///< A truth held by another track than the last that held it.
  int fragments = 0;  ///< A truth that was held, lost and held again.
  int truths = 0;
  double iou_sum = 0.0;  ///< Over hits.
  double nees_sum = 0.0;
  int nees_count = 0;
  [[nodiscard]] double mota() const;
  [[nodiscard]] double motp() const;
  /// Mean of e' P^-1 e / 2 of the position: 1 for honest covariances. NaN where none is known.
  [[nodiscard]] double anees() const;
};

struct Clear3dFigures {
  double samota = 0.0;
  double amota = 0.0;
  ClearCounts best;  ///< At the threshold of the highest MOTA.
};

/// 3-D CLEAR and its integrals over recall, KITTI's rules, per class: pairs of truth and tracked
/// boxes with the least sum of 1 - IoU, none below `iou`. Boxes at most 25 px high, and those of
/// which more than half lies in an unlabelled region, are not false. A track is kept or left out as
/// a whole, by the mean of its rows' scores. For recall r = 1/40 .. 40/40, with the threshold at
/// which that share of truths is hit at full recall,
///
///     AMOTA  = mean of max(0, 1 - (FP + FN + IDS) / GT)
///     sAMOTA = mean of 1 - (FP + FN + IDS - (1 - r) GT) / (r GT), within [0, 1]
///
/// recalls that are not reached count 0 (Weng, Wang, Held, Kitani, IROS 2020: AB3DMOT).
Clear3dFigures EvaluateClear3d(std::span<const EvaluatedSequence> sequences, double iou);

}  // namespace v2vouch::bench
