// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "daemon/common/data/measurement.h"

namespace v2vouch {

/// Leaves of a vehicle's reflections those that mark its outline, strongest first: within 10 dB of
/// the strongest, and with none clearly nearer to the radar at the same bearing.
void KeepOutline(std::vector<OutlineReturn>& returns);

}  // namespace v2vouch
