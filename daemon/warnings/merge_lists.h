// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "daemon/warnings/warning.h"

namespace v2vouch::warnings {

/// Joins the lists: one object per physical vehicle. A PRIORITY track that rests on a LOCAL one is
/// that vehicle. Where own sensors see it now, its state is LOCAL's, which no message can change;
/// hidden or out of view it is PRIORITY's. Ordered by LOCAL id, then PRIORITY id.
std::vector<Target> MergeLists(const TargetList* local, const TargetList* priority, Timestamp now);

}  // namespace v2vouch::warnings
