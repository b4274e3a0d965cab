// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/data/check.h"

#include <array>
#include <cstddef>

namespace v2vouch {
namespace {

// In the order of the enum. ETSI TS 103 759 lists a beacon interval that is too small, a change of
// static data, changes of position and speed that are too large, and values of speed and
// longitudinal acceleration that are too large.
constexpr std::array<CheckInfo, static_cast<std::size_t>(Check::kCount)> kTable{
    CheckInfo{"acceleration_residual", EtsiClass::kAcceleration, false, "v2v/trust/checks",
              "braking or accelerating that the sensors do not see"},
    CheckInfo{
        "bridge_misfit", EtsiClass::kPosition, false, "v2v/perception/bridge_claim",
        "a hidden sender whose claims leave the carried vehicle while its messages break off"},
    CheckInfo{"contested_core", EtsiClass::kNone, false, "v2v/intake/sender_checks",
              "the same core data under two identities"},
    CheckInfo{"contested_identity", EtsiClass::kNone, false, "v2v/perception/claim_steps",
              "an identity that took over from one that speaks again"},
    CheckInfo{"course_against_path", EtsiClass::kPosition, false, "v2v/intake/path_check",
              "claimed course against the way made good"},
    CheckInfo{"empty_place", EtsiClass::kPosition, false, "v2v/trust/claimed_place",
              "nothing where the sender says it is, in clear view"},
    CheckInfo{"heading_residual", EtsiClass::kNone, false, "v2v/trust/checks",
              "a direction that the sensors do not see, while the sender leaves its vehicle"},
    CheckInfo{"implausible", EtsiClass::kSpeed, true, "v2v/intake/content_check",
              "messages refused for a speed or an acceleration that cannot be"},
    CheckInfo{"implausible_motion", EtsiClass::kSpeed, true, "v2v/intake/motion_check",
              "claimed speed that changes faster than any vehicle's"},
    CheckInfo{"late_messages", EtsiClass::kNone, false, "v2v/intake/content_check",
              "content that is old"},
    CheckInfo{"message_rate", EtsiClass::kBeacon, true, "v2v/intake/rate_check",
              "too many messages"},
    CheckInfo{"out_of_reach", EtsiClass::kPosition, false, "v2v/perception/bridge_claim",
              "a hidden sender outside what its vehicle can reach while its messages break off"},
    CheckInfo{"own_motion", EtsiClass::kPosition, false, "v2v/intake/motion_check",
              "claims that do not continue the motion"},
    CheckInfo{"position_jump", EtsiClass::kPosition, true, "v2v/intake/motion_check",
              "a displacement that the claimed motion does not explain"},
    CheckInfo{"residual_drift", EtsiClass::kPosition, false, "v2v/trust/checks",
              "a claim that moves away from its LOCAL track"},
    CheckInfo{"residual_jump", EtsiClass::kPosition, false, "v2v/trust/sender_trust",
              "the sender's own motion breaks and parts it from its track"},
    CheckInfo{"residual_level", EtsiClass::kPosition, false, "v2v/trust/checks",
              "a claim far from its LOCAL track"},
    CheckInfo{"seen_elsewhere", EtsiClass::kPosition, false, "v2v/perception/reappearance",
              "the real vehicle is seen away from the bridge"},
    CheckInfo{"shared_place", EtsiClass::kNone, false, "v2v/trust/shared_place",
              "several identities on one vehicle"},
    CheckInfo{"size_change", EtsiClass::kStatic, true, "v2v/intake/content_check",
              "length or width that changes within one identity"},
    CheckInfo{"speed_against_path", EtsiClass::kSpeed, false, "v2v/intake/path_check",
              "claimed speed against the way made good"},
    CheckInfo{"two_places", EtsiClass::kNone, false, "v2v/intake/motion_check",
              "a message that goes on where the sender was before it jumped"},
    CheckInfo{"velocity_residual", EtsiClass::kSpeed, false, "v2v/trust/checks",
              "a velocity that the sensors do not see, while the sender leaves its vehicle"},
};

}  // namespace

const CheckInfo& Describe(Check check) { return kTable[static_cast<std::size_t>(check)]; }

}  // namespace v2vouch
