// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <v2vouch/camera_detections_t.hpp>
#include <vector>

#include "sim/sensors/camera_boxes.h"
#include "sim/sensors/camera_family.h"
#include "sim/sensors/camera_projection.h"
#include "sim/sensors/radar.h"
#include "sim/sensors/skyline.h"
#include "sim/world/world.h"

namespace v2vouch::sim {

/// One smart camera. Realistic mode: the box is the bounding box of the part of the projected
/// cuboid that nothing nearer covers, cut at the picture's border; every edge that is not cut has
/// white noise of `edge_sigma_px`; body pitch moves the whole picture. Detection:
///     P = detection_probability * clamp((height_px - 5) / 7) * clamp((visible - 0.15) / 0.35)
/// with the class confused now and then, a score, and false boxes.
///
/// Ideal points: box 2 px wide and 2 px high whose bottom centre is the projected ground point
/// under the vehicle's centre; bottom centre noise `edge_sigma_px` in each direction, common to
/// both side edges, and body pitch; P as for ideal radar points. Modes with a family: CameraFamily;
/// P as in realistic mode.
class CameraSimulator {
 public:
  CameraSimulator(const World& world, int index, std::uint64_t seed);

  void Shoot(const Snapshot& snapshot, std::int64_t seq, camera_detections_t& picture);
  void Look(const Snapshot& snapshot, std::vector<Sight>& sights);

 private:
  struct Seen {
    Sight sight;
    PixelBox box;  ///< Of the visible part, not yet cut at the border.
  };
  /// Tangents of elevation the rays met of each actor: all of it and what nothing nearer covers.
  struct Cover {
    std::vector<double> whole, open;
  };
  Cover CastRays(const Snapshot& snapshot, double extra_pitch_rad, std::vector<Seen>& seen);
  void AddOutline(const EgoTruth& ego, const ActorState& actor, double extra_pitch_rad,
                  PixelBox& box) const;
  void LookClosely(const Snapshot& snapshot, double extra_pitch_rad, std::vector<Seen>& seen);
  [[nodiscard]] Eigen::Vector3d ToBody(const EgoTruth& ego, const Vec2& point, double z_m) const;

  [[nodiscard]] double sigma_px() const;
  [[nodiscard]] std::optional<camera_box_t> PointBox(const EgoTruth& ego, const ActorState& actor,
                                                     double nod_rad, Random& random) const;
  void ShootFamily(const Snapshot& snapshot, std::int64_t seq, camera_detections_t& picture);

  void Spoil(std::int64_t seq, camera_detections_t& picture) const;

  const World& world_;
  CameraConfig camera_;
  std::uint64_t index_;
  std::uint64_t seed_;
  Skyline skyline_;
  std::vector<Seen> seen_;
  std::optional<CameraFamily> family_;  ///< Of modes that have one.
};

}  // namespace v2vouch::sim
