// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/world/scenario.h"

namespace v2vouch::sim {

/// Names of the modes that draw a family: "bumper", ..., "random".
std::vector<std::string> DrawnFamilies();

/// Where `sensors.mode` names a family or is random: draws this run's `family`, the ego's radars
/// and cameras (`vehicle`) and the latencies from `seed`, in place of the scenario's own. Other
/// modes are left as they are. The same scenario and seed give the same draw, and what is drawn
/// stands in the effective scenario. `vehicle` then says what a data sheet would: mounting, view,
/// range, period, noise; neither the reflection law nor the faults of the boxes.
///
///     bumper      strong near face, weak returns from under and in the car (the law measured in an
///                 independent simulator: strongest 0.15 +- 0.25 m deep, half of the returns 1 to 3
///                 m)
///     corners     corners and wheels, hardly a face
///     sparse      one or two returns per car
///     merged      wide resolution cells: neighbours become one return
///     inside      returns from inside as strong as the face; neither SNR nor cross-section
///     few_face    the near face answers in few scans
///     objects     radars that report objects, whose reference point jumps
///     multipath   many images: under cars, over walls, rails and lorries, twice to the car
///     rain        rain clutter, weak returns, a camera that misses
///     boxes       rough camera: classes, amodal and split boxes, false ones, pitch, brake dive
///     one_radar, no_camera, narrow_camera   sensor set-ups, with bumper's reflections
///     random      any of the laws with any set-up and any camera
void DrawSensors(std::uint64_t seed, Scenario& scenario);

}  // namespace v2vouch::sim
