// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "daemon/common/base/reason.h"
#include "daemon/common/data/claim.h"
#include "daemon/common/data/input.h"
#include "daemon/v2v/intake/intake.h"

namespace v2vouch {

/// What a BSM lacks or says that cannot be, by itself. nullopt: nothing.
std::optional<Refusal> ContentProblem(const Bsm& bsm);

/// Reception minus claimed time of the place [s]; negative where it is from the future. secMark is
/// the time of the place and names a millisecond within some minute: the one nearest to
/// generationTime, which is when the message was signed, else to reception. Without secMark:
/// generationTime itself; without either: default_age_s.
/// Source: SAE J2735, DE_DSecond; IEEE 1609.2, generationTime.
double ClaimedAge(const Bsm& bsm, const IntakeConfig& config);

/// The claim of a BSM without content problem. A yaw rate that cannot be (over 1.5 rad/s, or
/// over 12 m/s^2 sideways) is taken for none. In reverse the heading is read as the direction of
/// motion; the intake turns it round where that would turn the vehicle.
Claim ToClaim(const Bsm& bsm, double age_s, const IntakeConfig& config);

/// The claim is our own: same place, speed and course, less the way since its time.
bool IsOwnEcho(const Claim& claim, const EgoPlace& ego, const IntakeConfig& config);

}  // namespace v2vouch
