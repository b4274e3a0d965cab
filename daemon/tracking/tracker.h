// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "daemon/base/reason.h"
#include "daemon/base/visit.h"
#include "daemon/data/track.h"
#include "daemon/data/vehicle.h"
#include "daemon/models/ctra.h"

namespace v2vouch {

/// Settings of LOCAL fusion (DESIGN 5.4).
struct TrackerConfig {
  MotionNoise motion;
  double gate_probability = 0.9999;      ///< Of the chi-square gate.
  double birth_per_m2_s = 2e-6;          ///< Density of new vehicles.
  double confirm_existence = 0.95;       ///< Published from here on ...
  double keep_existence = 0.5;           ///< ... until it falls below this.
  double delete_existence = 0.01;
  double survival_per_s = 0.995;         ///< Probability to still be there after one second.
  double hidden_hold_s = 3.0;            ///< A hidden track is kept at most this long without a hit.
  double max_position_sigma_m = 5.0;     ///< A less certain track is dropped.
  int max_tracks = 512;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("motion", motion);
    a.Field("gate_probability", gate_probability, {.above = 0.5, .below = 1.0});
    a.Field("birth_per_m2_s", birth_per_m2_s, {.above = 0.0, .at_most = 1.0});
    a.Field("confirm_existence", confirm_existence, {.above = 0.0, .below = 1.0});
    a.Field("keep_existence", keep_existence, {.above = 0.0, .below = 1.0});
    a.Field("delete_existence", delete_existence, {.above = 0.0, .below = 1.0});
    a.Field("survival_per_s", survival_per_s, {.above = 0.0, .at_most = 1.0});
    a.Field("hidden_hold_s", hidden_hold_s, {.above = 0.0, .at_most = 30.0});
    a.Field("max_position_sigma_m", max_position_sigma_m, {.above = 0.1, .at_most = 100.0});
    a.Field("max_tracks", max_tracks, {.at_least = 1, .at_most = 4096});
  }
};

/// How likely each sensor is to detect a track at this moment, from visibility: value in [0, 1]
/// and what hides it. Asked once per track and frame.
struct Detectability {
  double probability = 0.0;
  Visibility visibility = Visibility::kVisible;
};
using DetectabilityOf = std::function<Detectability(const LocalTrack&)>;

/// Multi-target tracker: Bernoulli existence per track, CTRA EKF in O, association by
/// log-likelihood ratio with exact assignment in gated clusters, birth from what is left.
/// Copyable: a copy is a checkpoint. Same inputs, same bits.
class Tracker {
 public:
  Tracker(const TrackerConfig& config, const VehicleConfig& vehicle);

  /// Brings every track to `stamp` (>= the last one) and drops those that have ended.
  void Predict(Timestamp stamp);

  /// One radar scan: associate, update, start. `detectability` answers for this radar.
  void UpdateRadar(int radar, const EgoState& ego, std::span<const RadarMeasurement> measurements,
                   const DetectabilityOf& detectability);

  /// One picture. A box alone may start a track only within 60 m.
  void UpdateCamera(int camera, const EgoState& ego,
                    std::span<const CameraMeasurement> measurements,
                    const DetectabilityOf& detectability);

  /// All tracks, unconfirmed ones included, ordered by id.
  [[nodiscard]] std::span<const LocalTrack> tracks() const { return tracks_; }
  /// Which measurement each track was given by the last update.
  [[nodiscard]] std::span<const SensorUpdate> updates() const { return updates_; }
  /// Numerical failures and overflow since the last call.
  [[nodiscard]] std::span<const Reason> failures() const { return failures_; }

 private:
  TrackerConfig config_;
  VehicleConfig vehicle_;
  std::vector<LocalTrack> tracks_;
  std::vector<SensorUpdate> updates_;
  std::vector<Reason> failures_;
};

}  // namespace v2vouch
