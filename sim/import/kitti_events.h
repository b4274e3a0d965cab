// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "daemon/common/data/vehicle.h"
#include "sim/import/imported_event.h"
#include "sim/import/kitti.h"

namespace v2vouch::sim {

/// The shipped description of KITTI's car (daemon/vehicles/vehicle_kitti.yaml) has the same camera.
struct KittiOptions {
  std::string camera_name = "FRONT";
  double camera_x_m = 1.13;  ///< Ahead of the rear axle: KITTI's set-up page, 0.27 + 0.81 + 0.05.
  double camera_z_m = 1.65;  ///< Above the road, from the same.
  int image_width_px = 1242;
  int image_height_px = 375;
  double edge_sigma_px = 2.0;          ///< Noise on every edge of a labelled box, 1 sigma.
  double detection_probability = 0.9;  ///< Of a visible object; see KittiEvents.
  double clutter_per_image = 0.1;      ///< False boxes, the size of cars.
  std::uint64_t seed = 1;
};

/// JPEG bytes of a frame; empty: there is no picture of it.
using KittiPictures = std::function<std::vector<std::uint8_t>(int frame)>;

/// A sequence as LCM messages, ten frames a second from 2011-09-26 00:00 UTC on:
///
///   EGO_MOTION  50 Hz, linear between the frames' motions
///   CAMERA_<NAME>  labelled boxes with noise, as a smart camera would tell them: an object is told
///       with detection_probability, half as often where largely hidden (occluded 2 or 3), never
///       under 12 px high or beyond the picture; or, where `pictures` is set,
///       CAMERA_<NAME>_IMAGE and nothing drawn at random
///   TRUTH  at every frame: Car, Van, Truck, Tram (as bus), Pedestrian, Cyclist, positions from the
///       labels through the integrated motion, speeds by central differences over four frames;
///       hidden where largely hidden or out of the picture
///   SIM_SCENARIO  the camera, for the evaluator's bound
///
/// There is no GNSS and no V2V in it. Events are sorted by time.
std::vector<ImportedEvent> KittiEvents(const std::string& name,
                                       const std::vector<KittiLabel>& labels,
                                       const KittiCamera& camera,
                                       const std::vector<KittiMotion>& motion,
                                       const KittiOptions& options, const KittiPictures& pictures);

}  // namespace v2vouch::sim
