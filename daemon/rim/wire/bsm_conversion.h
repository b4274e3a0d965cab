// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/base/refusal_tally.h"
#include "daemon/common/base/result.h"
#include "daemon/common/data/input.h"
#include "v2vouch/bsm_t.hpp"

namespace v2vouch::wire {

/// Raw J2735 integers -> SI and radians, "unavailable" -> nullopt, clockwise from north ->
/// counter-clockwise from east, right-positive yaw rate -> left-positive.
/// A value that J2735 does not define (SAE J2735 Part I, data elements of BSMcoreData; spare code
/// points of the UPER ranges included) refuses the message where it is the place or the speed:
/// kBsmRange. Elsewhere that field alone counts as unavailable, and is counted in `unused`.
Result<Bsm> FromWire(const bsm_t& message, Timestamp received, RefusalTally& unused);

}  // namespace v2vouch::wire
