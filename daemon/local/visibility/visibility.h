// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "daemon/common/base/visit.h"
#include "daemon/common/data/ego.h"
#include "daemon/common/data/measurement.h"
#include "daemon/common/data/track.h"
#include "daemon/common/data/vehicle.h"
#include "daemon/local/visibility/box.h"
#include "daemon/local/visibility/static_raster.h"

namespace v2vouch {

struct VisibilityConfig {
  double static_hold_s = 2.0;  ///< A static return keeps occluding this long after its last hit.
  double static_cell_m = 1.0;  ///< Raster in O of accumulated static returns.
  int static_min_hits = 3;     ///< Hits before a cell occludes.
  double margin_m = 0.7;       ///< Blur of every occluder's outline.

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
  bool left_is_covered = false;   ///< The outer sixth of its own span at the left edge is covered
  bool right_is_covered = false;  ///< or out of the field of view; at the right edge.
};

/// Azimuth-range occlusion round each sensor from tracked boxes and accumulated static returns
/// on flat ground: boxes and walls block, nothing is seen over or under them.
///
/// A footprint is sampled along rays spread over its azimuth span, widened by 3 sigma of its
/// position. Each ray is
/// - *covered by a box* that begins nearer than the footprint does. Outlines are blurred by margin
///   and the box's own sigma: 0.5 on the edge, 1 from there inwards, 0 outwards. A box of the same
///   id, or one that holds the footprint's centre (the vehicle itself), covers nothing.
/// - *covered by a structure*: an active static cell with others 3 to 4.5 m off, nearer than the
///   footprint's nearest point by more than margin + cell + sigma, so that a stationary vehicle's
///   own returns do not hide it.
/// - *possibly covered* by any other active static cell (a pole): half.
/// Static cells through which a vehicle was measured cover nothing (a guard rail, a hedge).
///
/// kOutOfView: less than 10 % of the footprint is inside the field of view, or its centre is out of
/// range. kClear: at least 90 % of the 3-sigma span is inside the field of view and neither covered
/// nor possibly covered, and 3 sigma stay inside the range. kOccluded: at least 80 % of what is
/// inside the field of view is covered. Else kUnknown.
///
/// Copyable and of bounded size, since it is part of every checkpoint: about 14 kB and 100 bytes
/// per tracked box.
class VisibilityMap {
 public:
  VisibilityMap(const VisibilityConfig& config, const VehicleConfig& vehicle);

  /// Adds the stationary returns of one scan to the raster in O. Returns inside a box of the
  /// present scene are that vehicle's own and are left out.
  void AccumulateStatic(Timestamp stamp, const EgoState& ego,
                        std::span<const RadarMeasurement> measurements);

  /// A radar has measured a certain vehicle here: the static cells in front of it hide nothing. Ego
  /// pose as of SetScene.
  void SeeThrough(const RadarMeasurement& measurement);

  /// Sets the scene for queries: where the ego is, and the tracked boxes.
  void SetScene(const EgoState& ego, std::span<const Occluder> occluders);

  /// How one sensor sees a footprint (centre, yaw, extent) whose position is uncertain by
  /// `position_sigma_m`; `id` is the track whose own box must not count.
  [[nodiscard]] SensorView From(SensorKey sensor, const Occluder& footprint) const;

  /// Whether a radar has lately measured something stationary within `within_m` of a position.
  /// Returns in the box of a track do not count.
  [[nodiscard]] bool HasStandingReturn(const Eigen::Vector2d& p_O, double within_m) const;

  /// Best answer over all sensors: clear if any sees it clear, else unknown if any is unknown, else
  /// occluded if any has it in its field of view, else out of view.
  [[nodiscard]] View Overall(const Occluder& footprint) const;

  /// One sensor's answer and Overall's at the cost of little more than one query.
  struct Answer {
    SensorView sensor;
    View overall = View::kOutOfView;
  };
  [[nodiscard]] Answer Ask(SensorKey sensor, const Occluder& footprint) const;

  /// Coverage by sector of 30 degrees, twelve from -180 degrees on; `alive` says which sensors
  /// speak, in the order of VehicleConfig::AllSensors(). A sensor covers a sector when it covers
  /// the sector's middle. Watched: of each kind (radar, camera, objects) that is mounted for the
  /// sector one is alive. Degraded: not of each kind. Blind: none. Range is that of the
  /// farthest-reaching living sensor.
  [[nodiscard]] std::vector<SectorHealth> Sectors(std::span<const char> alive) const;

 private:
  static constexpr int kSectors = 12;

  struct Sensor {
    SensorKind kind = SensorKind::kRadar;
    Eigen::Vector2d p_B = Eigen::Vector2d::Zero();
    double yaw_rad = 0.0;
    double fov_left_rad = 0.0;  // From the axis, both positive.
    double fov_right_rad = 0.0;
    double min_range_m = 0.0;
    double max_range_m = 0.0;
    std::size_t viewpoint = 0;
    std::array<bool, kSectors> covers{};  // The middles of the sectors.
    // Edges of the field of view in B, and in the scene: origin and edges in O.
    Eigen::Vector2d left_B = Eigen::Vector2d::UnitX();
    Eigen::Vector2d right_B = Eigen::Vector2d::UnitX();
    Eigen::Vector2d origin_O = Eigen::Vector2d::Zero();
    Eigen::Vector2d left_O = Eigen::Vector2d::UnitX();
    Eigen::Vector2d right_O = Eigen::Vector2d::UnitX();

    void Place(const Pose<Odometry, Body>& X_OB, const Eigen::Matrix2d& R_OB);
    /// Whether a disc round origin_O + `d` surely lies outside the field of view.
    [[nodiscard]] bool IsSurelyOutside(const Eigen::Vector2d& d, double radius_m) const;
    [[nodiscard]] bool Sees(double azimuth_rad) const {
      return azimuth_rad <= fov_left_rad && azimuth_rad >= -fov_right_rad;
    }
  };

  // Sensors close to each other share what they see of the static scene: nearest range by bearing
  // in O, one degree per bin, in centimetres.
  static constexpr int kBins = 360;
  struct Viewpoint {
    Eigen::Vector2d p_B = Eigen::Vector2d::Zero();
    Eigen::Vector2d built_at_O = Eigen::Vector2d::Zero();
    std::array<std::uint16_t, kBins> structure_cm{};
    std::array<std::uint16_t, kBins> any_cm{};
  };

  // The rays of one question: angles from the line of sight to the footprint's centre.
  struct Fan {
    Eigen::Vector2d sight = Eigen::Vector2d::UnitX();
    double bearing_O = 0.0;
    double right_rad = 0.0;
    double left_rad = 0.0;
    double farthest_m = 0.0;
  };
  using InTheWay = std::array<Silhouette, 12>;  // More boxes in one line hide no more.
  struct Query;                                 // One sensor's question for one footprint.
  struct Rays;

  void AddSensor(const Sensor& sensor);
  [[nodiscard]] const Sensor& At(SensorKey sensor) const;
  [[nodiscard]] Answer AskAll(const Sensor* first, const Box& footprint) const;
  [[nodiscard]] std::size_t CollectInTheWay(const Box& footprint, const Eigen::Vector2d& p_OS,
                                            const Fan& fan, InTheWay& in_the_way) const;
  [[nodiscard]] bool HasStaticNearer(const Viewpoint& viewpoint, const Fan& fan,
                                     double limit_cm) const;
  void RebuildBins(Viewpoint& viewpoint) const;
  [[nodiscard]] SensorView See(const Sensor& sensor, const Box& footprint) const;
  [[nodiscard]] Rays CastRays(const Query& query) const;
  [[nodiscard]] double CoverOf(const Query& query, double a, const Eigen::Vector2d& ray) const;
  [[nodiscard]] static SensorView Conclude(const Silhouette& target, const Rays& rays,
                                           bool stays_in_range);

  VisibilityConfig config_;
  std::array<std::size_t, kSensorKinds + 1> first_{};  // Of each kind in sensors_; their number.
  std::vector<Sensor> sensors_;                        // As VehicleConfig::AllSensors().
  std::vector<Viewpoint> viewpoints_;
  StaticRaster raster_;

  // The scene.
  EgoState ego_;
  bool has_bins_ = false;
  Timestamp bins_built_{};
  std::vector<Box> occluders_;
};

/// The footprint of a track as the map wants it.
Occluder FootprintOf(const LocalTrack& track);

}  // namespace v2vouch
