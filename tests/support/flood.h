// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "daemon/common/data/input.h"
#include "tests/support/synthetic_drive.h"

namespace v2vouch::testing {

/// What floods a drive's radio.
enum class FloodKind {
  kNone,
  kRefused,  ///< Messages whose content cannot be (speed over 70 m/s), of random identities.
  kRandom,   ///< Every message a new identity at a random place within 300 m.
  kSybils,   ///< A tenth as many identities as messages a second, each a car of its own within
             ///< 60 m of the drive's first car, moving as it does.
  kOneId,    ///< One identity, one place.
  kCrowd,    ///< As kSybils, over 500 m round the ego: honest neighbours.
};

/// BSMs at `rate_hz` from `from_s` on to the end of the drive, in order of reception. Identities
/// start at 0x10000000, so that they meet none of the drive's own.
std::vector<Input> FloodOf(FloodKind kind, double rate_hz, double from_s,
                           const SyntheticDrive& drive);

/// Both in one order of time.
std::vector<Input> Merged(std::vector<Input> inputs, const std::vector<Input>& more);

}  // namespace v2vouch::testing
