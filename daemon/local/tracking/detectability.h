// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "daemon/common/base/scratch.h"
#include "daemon/common/data/measurement.h"
#include "daemon/common/data/sensor.h"
#include "daemon/common/data/track.h"
#include "daemon/local/tracking/track_table.h"

namespace v2vouch {

/// How likely one sensor is to detect a track at this moment, from visibility, in [0, 1], and how
/// the sensors together see it (VisibilityMap::Overall), which the track shows. Asked once per
/// track and frame.
struct Detectability {
  double probability = 0.0;
  Visibility visibility = Visibility::kVisible;
  double visible_share = 1.0;    ///< Of its azimuth span, to this sensor.
  bool left_is_covered = false;  ///< Its left edge is hidden from this sensor or out of its view.
  bool right_is_covered = false;
};
using DetectabilityOf = std::function<Detectability(const LocalTrack&)>;

/// What one frame ought to show of each track, and how much it means where it does not. Index i as
/// in the TrackTable that was asked about; probabilities in [0, 1].
///
/// Misses of a listed track follow from each other: what the visibility did not know of hides it in
/// the next frame too. A frame after dt counts as min(1, dt / miss_memory_s) of one, which also
/// makes a track's end a matter of time and not of the sensors' rates.
///
/// Keeps the time of each sensor's last frame; all else is of the current frame.
class FrameDetectability {
 public:
  explicit FrameDetectability(double miss_memory_s) : miss_memory_s_(miss_memory_s) {}

  /// Begins a frame of `sensor` at table.now(); every track shows its visibility from then on.
  void Ask(SensorKey sensor, const DetectabilityOf& detectability, TrackTable& table);

  /// Probability that this frame detects the track.
  [[nodiscard]] double detection(std::size_t i) const { return detection_[i]; }
  /// The same for the case that it does not: what the miss counts. 0 for a radar where the range is
  /// only guessed: it cannot miss what may be elsewhere.
  [[nodiscard]] double missing(std::size_t i) const { return missing_[i]; }
  /// Per track 1 - r p, with its existence r and p = missing.
  [[nodiscard]] std::span<const double> missed() const { return missed_; }

  /// The measurement as one of this track, with what visibility knows about its edges.
  [[nodiscard]] RadarMeasurement Given(std::size_t i, const TrackTable& table,
                                       const RadarMeasurement& z) const;
  [[nodiscard]] CameraMeasurement Given(std::size_t i, const TrackTable& table,
                                        const CameraMeasurement& z) const;
  [[nodiscard]] BoxMeasurement Given(std::size_t i, const TrackTable& table,
                                     const BoxMeasurement& z) const;

 private:
  double miss_memory_s_;
  std::array<Timestamp, kSensorSlots> last_frame_{};  // By SlotOf.
  Scratch<std::vector<double>> detection_, missing_, missed_;
  Scratch<std::vector<Detectability>> answers_;
};

}  // namespace v2vouch
