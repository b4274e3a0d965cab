// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "daemon/common/data/measurement.h"

namespace v2vouch {

/// Two clusters of one vehicle as one: means weighted by the number of reflections, edges joined.
/// Range rates are compared with what the vehicle's velocity gives at each azimuth: seen from close
/// by it changes along a vehicle by more than the mean of two rates bears.
/// @param v_TA_R velocity of the vehicle relative to the antenna, axes of R [m/s].
RadarMeasurement JoinClusters(const RadarMeasurement& a, const RadarMeasurement& b,
                              const Eigen::Vector2d& v_TA_R);

}  // namespace v2vouch
