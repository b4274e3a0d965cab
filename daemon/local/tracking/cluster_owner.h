// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/data/measurement.h"

namespace v2vouch {

/// Two clusters of one vehicle as one: means weighted by the number of reflections, edges joined.
RadarMeasurement JoinClusters(const RadarMeasurement& a, const RadarMeasurement& b);

}  // namespace v2vouch
