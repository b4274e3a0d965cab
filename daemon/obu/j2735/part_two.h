// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/obu/j2735/bsm.h"

namespace v2vouch::obu {

/// Reads the content of a Part II item, as far as it can be read: what came before the fault stays.
Fault ReadSafetyExtensions(BitView content, SafetyExtensions& safety);
Fault ReadSupplementalExtensions(BitView content, SupplementalExtensions& supplemental);

}  // namespace v2vouch::obu
