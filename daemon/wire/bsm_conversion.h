// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/base/result.h"
#include "daemon/data/input.h"
#include "v2vouch/bsm_t.hpp"

namespace v2vouch::wire {

/// Raw J2735 integers -> SI and radians, "unavailable" -> nullopt, clockwise from north ->
/// counter-clockwise from east, right-positive yaw rate -> left-positive.
/// kBsmRange for a value that J2735 does not define (SAE J2735 Part I, data elements of
/// BSMcoreData; spare code points of the UPER ranges included).
Result<Bsm> FromWire(const bsm_t& message, Timestamp received);

}  // namespace v2vouch::wire
