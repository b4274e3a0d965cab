// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace v2vouch {

/// Frame tags. Inside a formula the name carries the frames: X_OB is the pose of B in O.
struct Ecef {};  ///< E: earth-centred, earth-fixed, WGS-84.
struct LocalEnu {
};  ///< L: local plane, x east, y north, z up, touching the ellipsoid at its origin.
struct Odometry {};  ///< O: dead-reckoned plane; smooth, drifts, immune to GNSS jumps.
struct Body {};      ///< B: ego body, ISO 8855: x forward, y left, z up; origin mid rear axle.
struct Radar {};     ///< R: radar, axes as in B; origin at the antenna.
struct Camera {};    ///< C: camera, OpenCV axes: x right, y down, z forward.
struct Target {};    ///< T: a vehicle, axes as in B, origin at the centre of its footprint.
struct World {};     ///< W: the simulator's east-north plane; known to truth only.

}  // namespace v2vouch
