// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "daemon/base/visit.h"
#include "daemon/data/ego.h"
#include "daemon/data/measurement.h"
#include "daemon/data/track.h"
#include "daemon/data/vehicle.h"

namespace v2vouch {

struct VisibilityConfig {
  double static_hold_s = 2.0;     ///< A static return keeps occluding this long after its last hit.
  double static_cell_m = 1.0;     ///< Raster in O of accumulated static returns.
  int static_min_hits = 3;        ///< Hits before a cell occludes.
  double margin_m = 0.7;          ///< Blur of every occluder's outline.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("static_hold_s", static_hold_s, {.at_least = 0.0, .at_most = 60.0});
    a.Field("static_cell_m", static_cell_m, {.at_least = 0.2, .at_most = 5.0});
    a.Field("static_min_hits", static_min_hits, {.at_least = 1, .at_most = 100});
    a.Field("margin_m", margin_m, {.at_least = 0.0, .at_most = 5.0});
  }
};

/// What can be said about seeing a place. Only kClear counts as negative evidence.
enum class View : std::uint8_t { kClear, kOccluded, kUnknown, kOutOfView };

/// How one sensor sees one footprint.
struct SensorView {
  View view = View::kOutOfView;
  double uncovered = 0.0;  ///< Share of its azimuth span inside the field of view and not covered.
};

/// An oriented box in O that may hide what is behind it.
struct Occluder {
  std::uint64_t id = 0;  ///< Track it belongs to; a track never hides itself. 0: none.
  Eigen::Vector2d centre_O = Eigen::Vector2d::Zero();
  double yaw_rad = 0.0;
  double length_m = 4.5;
  double width_m = 1.8;
  double position_sigma_m = 0.3;
};

/// Azimuth-range occlusion round each sensor from tracked boxes and accumulated static returns
/// (DESIGN 5.3). Copyable and of bounded size: it is part of every checkpoint.
class VisibilityMap {
 public:
  VisibilityMap(const VisibilityConfig& config, const VehicleConfig& vehicle);

  /// Adds the standing returns of one scan to the raster in O.
  void AccumulateStatic(Timestamp stamp, const EgoState& ego,
                        std::span<const RadarMeasurement> measurements);

  /// Sets the scene for queries: where the ego is, and the tracked boxes.
  void SetScene(const EgoState& ego, std::span<const Occluder> occluders);

  /// How radar `index` / camera `index` sees a footprint (centre, yaw, extent) whose position is
  /// uncertain by `position_sigma_m`; `self` is the track whose own box must not count.
  [[nodiscard]] SensorView FromRadar(int index, const Occluder& footprint) const;
  [[nodiscard]] SensorView FromCamera(int index, const Occluder& footprint) const;

  /// Best answer over all sensors: clear if any sees it clear, else unknown if any is unknown, else
  /// occluded if any has it in its field of view, else out of view.
  [[nodiscard]] View Overall(const Occluder& footprint) const;

  /// Coverage by sector of 30 degrees; `radar_alive`, `camera_alive` say which sensors speak.
  [[nodiscard]] std::vector<SectorHealth> Sectors(std::span<const char> radar_alive,
                                                  std::span<const char> camera_alive) const;

 private:
  VisibilityConfig config_;
  VehicleConfig vehicle_;
};

}  // namespace v2vouch
