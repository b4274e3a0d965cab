// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <v2vouch/camera_detections_t.hpp>

#include "daemon/common/base/random.h"
#include "daemon/common/data/object_class.h"
#include "daemon/common/data/vehicle.h"
#include "sim/sensors/camera_family.h"

namespace v2vouch::sim {

/// Edges in a picture, not yet cut at its border.
struct PixelBox {
  double left = 1e9;
  double top = 1e9;
  double right = -1e9;
  double bottom = -1e9;
  bool is_empty = true;
  void Add(const Eigen::Vector2d& pixel);
};

/// Class as a number and as its name.
void SetClass(ObjectClass object_class, camera_box_t& box);

/// The box that a detector gives a vehicle of which this is visible: edges with white noise, but
/// for those that the picture's border cuts; now and then another class. nullopt: too small.
std::optional<camera_box_t> VehicleBox(const CameraConfig& camera, double sigma_px,
                                       const PixelBox& seen, double visible_fraction,
                                       ObjectClass object_class, Random& random);

/// Posters, shadows, bins: near the horizon, vehicle-shaped.
camera_box_t ClutterBox(const CameraConfig& camera, Random& random);

/// One box, or two side by side where the vehicle is split, and now and then one of them twice.
void AddFamilyBoxes(const CameraConfig& camera, const CameraFamilySpec& spec, double noise_scale,
                    const PixelBox& exact, const CameraFamily::Vehicle& vehicle,
                    ObjectClass object_class, Random& random, camera_detections_t& picture);

}  // namespace v2vouch::sim
