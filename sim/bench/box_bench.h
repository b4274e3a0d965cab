// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/bench/bench.h"
#include "sim/bench/kitti_boxes.h"

namespace v2vouch::bench {

/// What the tracker is told about a detector of boxes, and what it shows of its tracks. The
/// defaults are PointRCNN's on KITTI, set on half of the development sequences
/// (docs/results/boxes.md).
struct BoxSettings {
  double position_sigma_m = 0.12;       ///< Each axis, at the sensor ...
  double position_sigma_per_m = 0.002;  ///< ... and by range.
  double yaw_sigma_rad = 0.4;           ///< Many boxes of far cars are turned.
  double length_sigma_m = 0.4;
  double width_sigma_m = 0.18;
  double detection_probability = 0.95;
  double clutter_per_m2 = 0.01;
  double score_offset = -0.75;  ///< Score at which a box is as likely a vehicle as clutter.
  double score_scale = 0.5;     ///< Of ln p(score | vehicle) / p(score | clutter), per unit.
  double gate_probability = 0.9999;
  double drift_psd = 0.3;       ///< Of the ego motion from labels, see MotionNoise::position_psd.
  int show_hits = 3;            ///< Rows begin with this box, ...
  double show_score = 0.3;      ///< ... or with the first of at least this score.
  double coast_s = 1.5;         ///< A track without a box is shown for at most so long, ...
  double coast_share = 0.8;     ///< ... this share of the time between its first and last box ...
  double coast_least_s = 0.25;  ///< ... and this.
  double coast_score = 0.75;    ///< Taken off the score of a row without a box.
  double doubt_hits = 10.0;     ///< A track's score is a mean with so many boxes of ...
  double doubt_score = -2.0;    ///< ... this score: what was seen seldom is doubted.
};

struct BoxRun {
  std::vector<EvaluatedSequence> sequences;
  std::vector<double> step_ms;  ///< Predict + associate + update of every frame.
  [[nodiscard]] double ms_mean() const;
};

/// Runs the tracker core (Tracker::UpdateBoxes) over every sequence. Height and bottom of a box,
/// which the tracker does not know, follow its boxes with a gain of a half.
BoxRun TrackBoxes(const std::vector<BoxSequence>& sequences, const BoxSettings& settings,
                  const Stopwatch& watch = {});

}  // namespace v2vouch::bench
