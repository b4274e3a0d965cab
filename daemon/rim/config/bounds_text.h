// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "daemon/common/base/visit.h"

namespace v2vouch::config {

bool AreKept(const Bounds& bounds, double value);

/// "must be above 0, at most 10"; "" where there are none.
std::string BoundsText(const Bounds& bounds);

}  // namespace v2vouch::config
