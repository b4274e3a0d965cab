// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "sim/bench/clear3d.h"

namespace v2vouch::bench {

/// A detector's box of one frame.
struct DetectedBox {
  double score = 0.0;  ///< As the detector gives it; PointRCNN: a logit.
  Box3d box;
  PixelBox pixels;
};

/// One sequence: ten frames a second.
struct BoxSequence {
  struct Frame {
    std::vector<DetectedBox> detections;
    std::vector<TruthBox> truth;    ///< Cars; Vans, cut and unknown ones as ignored.
    std::vector<PixelBox> regions;  ///< DontCare.
    Eigen::Isometry2d X_OS;         ///< Pose of the sensor on the ground plane, from frame 0 on.
  };
  std::string name;
  std::vector<Frame> frames;
};

/// Reads `labels`/NNNN.txt (tracking devkit) and `detections`/NNNN.txt (frame, type, 2-D box,
/// score, h, w, l, x, y, z, rotation_y, ...; commas or blanks; types other than 2 = car are left
/// out) of every sequence that `seqmap` (name, "empty", first frame, frames) names. The sensor's
/// motion is that of `poses`/NNNN.txt (12 numbers a frame, KITTI odometry's camera poses) where
/// `poses` is not empty, else what stands still among the labels shows (sim/import/kitti.h); a
/// sequence without anything that stands has none.
/// @return nullopt with `error` naming file, line and fault.
std::optional<std::vector<BoxSequence>> ReadKittiBoxes(const std::string& detections,
                                                       const std::string& labels,
                                                       const std::string& seqmap,
                                                       const std::string& poses,
                                                       std::string& error);

/// The tracked rows of every sequence as `directory`/NNNN.txt in the devkit's columns for results.
bool WriteKittiTracks(const std::vector<BoxSequence>& sequences,
                      const std::vector<EvaluatedSequence>& tracked, const std::string& directory,
                      std::string& error);

}  // namespace v2vouch::bench
