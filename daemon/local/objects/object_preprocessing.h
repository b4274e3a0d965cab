// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "daemon/common/data/ego.h"
#include "daemon/common/data/input.h"
#include "daemon/common/data/measurement.h"
#include "daemon/common/data/vehicle.h"

namespace v2vouch {

/// One frame of a configured source of objects -> boxes in O, over ground:
///
///     p_O = X_OB * X_BS * p_S,   v_O = R_OS v_S                         (velocity: ground)
///                                v_O = R_OS v_S + v_S of the sensor + w x (p - p_S)   (sensor)
///
/// with w the ego's yaw rate. Covariances turn along; where an object tells none, the configured
/// sigmas count. An object of unknown size has its class's; one of unknown axis has that of its
/// velocity, where that is known and fast, else the ego's, as uncertain as a guess is.
///
/// Left out: objects below min_score, those outside of the configured field of view and range, and
/// those whose centre lies on the car's own footprint. Order is kept; the content of `boxes` is
/// replaced.
void ProcessObjects(const ObjectList& list, const VehicleConfig& vehicle, const EgoState& ego,
                    std::vector<BoxMeasurement>& boxes);

}  // namespace v2vouch
