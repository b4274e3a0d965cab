// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "daemon/common/base/scratch.h"
#include "daemon/common/data/measurement.h"
#include "daemon/local/tracking/candidates.h"
#include "daemon/local/tracking/cluster_owner.h"
#include "daemon/local/tracking/glances.h"
#include "daemon/local/tracking/sensor_look.h"
#include "daemon/local/tracking/track_evidence.h"

namespace v2vouch {

/// What each radar's last four scans reflected that no track was given (standing), and what moved
/// (of a track or not), at most 256 of a scan, in O; and the ranges of camera tracks that follow
/// from it.
///
/// A box names a vehicle, but its range is a guess (4 m at 40 m): while no radar has seen the
/// track, it takes that of the nearest standing return inside the box's bearings and three sigma of
/// its range. What is nearer would cover the vehicle, what is farther is covered by it. Where a
/// return there moves, the box waits for a track of that. Posts stand about too: a place must be
/// clearly likelier than any other to be taken, by how well it fits the boxes, by the number of
/// returns (a vehicle gives several within 3 m of depth) and by their strength.
class StandingReturns {
 public:
  explicit StandingReturns(bool point_targets) : point_targets_(point_targets) {}

  /// One scan of `radar`, in place of the oldest one kept of it.
  void Keep(const RadarLook& look, int radar, std::span<const RadarMeasurement> measurements,
            const Candidates& candidates, const ClusterOwners& owners);

  /// What moved was read by a wrong ego speed.
  void ForgetMoving();

  /// One more box of a track whose range is only guessed: gives it a range, or ends it where
  /// something has moved there for three pictures.
  void LearnRange(const CameraLook& look, const CameraMeasurement& z, TrackEvidence& evidence);

 private:
  struct Return {
    Fix fix;
    int radar = 0;
    int scans_ago = 0;
    int returns = 1;  // Joined in one cluster.
    bool is_moving = false;
    double strength_db = 0.0;  // Of its strongest reflection, as from one metre.
  };
  struct InSight {  // Within the bearings of a track's boxes.
    const Return* at = nullptr;
    double misfit = 0.0;
    double range_m = 0.0;
  };
  struct Choice {  // The place that fits best so far, and the best one of those elsewhere.
    double best_score = 0.0;
    double second_score = 0.0;
    double best_m = -1.0;  // Range; below 0: none.
    double second_m = -1.0;
    void Offer(double score, double range_m);
    [[nodiscard]] bool IsClear() const;
  };

  /// Fills in_sight_. @return whether something of the last scans moves where the boxes are.
  bool CollectInSight(const Glances& glances, double most_misfit);
  [[nodiscard]] std::optional<Fix> FindStanding(double most_misfit) const;
  [[nodiscard]] double ScoreOf(const InSight& seen, double strongest_db) const;
  [[nodiscard]] Fix MeanBehind(double range_m) const;

  bool point_targets_;
  std::vector<Return> recent_;
  Scratch<std::vector<InSight>> in_sight_;
  Scratch<std::vector<std::size_t>> kept_;
};

}  // namespace v2vouch
