// SPDX-License-Identifier: Apache-2.0
#include "daemon/trust/standard_classes.h"

#include <algorithm>
#include <array>

namespace v2vouch {
namespace {

enum : std::int8_t {
  kNone = -1,
  kBeacon = 0,
  kStatic = 1,
  kPosition = 3,
  kSpeed = 4,
  kAcceleration = 5,
};

struct Row {
  std::string_view check;
  std::int8_t etsi_class;
};

// The public standard names the classes, and within them a beacon interval that is too small, a
// change of static data, position and speed changes that are too large, and values of speed and
// longitudinal acceleration that are too large. Those rows are marked "listed". All others are our
// own assignment to the class of the field that is doubted; what doubts an identity or a direction
// has no class there.
//
// None of ours is an observation of SAE J3287: codes outside J2735's ranges and messages whose
// signature is invalid are refused at reception and never become a claim, and its list has nothing
// kinematic.
constexpr std::array kRows{
    Row{"acceleration_residual", kAcceleration},
    Row{"bridge_misfit", kPosition},
    Row{"contested_core", kNone},
    Row{"contested_identity", kNone},
    Row{"course_against_path", kPosition},
    Row{"empty_place", kPosition},
    Row{"heading_residual", kNone},
    Row{"implausible", kSpeed},         // Listed, for speed; acceleration counts here, too.
    Row{"implausible_motion", kSpeed},  // Listed.
    Row{"late_messages", kNone},
    Row{"message_rate", kBeacon},  // Listed.
    Row{"out_of_reach", kPosition},
    Row{"own_motion", kPosition},
    Row{"position_jump", kPosition},  // Listed.
    Row{"residual_drift", kPosition},
    Row{"residual_jump", kPosition},
    Row{"residual_level", kPosition},
    Row{"seen_elsewhere", kPosition},
    Row{"shared_place", kNone},
    Row{"size_change", kStatic},  // Listed.
    Row{"speed_against_path", kSpeed},
    Row{"two_places", kNone},
    Row{"velocity_residual", kSpeed},
};

}  // namespace

std::optional<StandardClass> StandardClassOf(std::string_view check) {
  const auto* const row = std::ranges::find(kRows, check, &Row::check);
  if (row == kRows.end()) return std::nullopt;
  return StandardClass{row->etsi_class, false};
}

}  // namespace v2vouch
