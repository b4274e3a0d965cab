// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/octets/fault.h"

#include <array>

namespace v2vouch::obu {

std::string_view FaultName(FaultKind kind) {
  static constexpr std::array<std::string_view, static_cast<std::size_t>(FaultKind::kCount)>
      kNames = {"none",
                "empty",
                "truncated",
                "too_long",
                "trailing_bytes",
                "bad_length",
                "fragmented_length",
                "out_of_range",
                "unknown_framing",
                "unsupported",
                "nested_too_deep",
                "encrypted",
                "not_bsm",
                "not_cam",
                "not_a_vehicle",
                "wrong_psid",
                "own_transmission",
                "not_v2x",
                "ip_fragment",
                "bad_text"};
  return kNames.at(static_cast<std::size_t>(kind));
}

std::string FaultText(const Fault& fault) {
  if (!fault) return "";
  std::string text(FaultName(fault.kind));
  if (!fault.where.empty()) text += ": " + std::string(fault.where);
  switch (fault.kind) {
    case FaultKind::kOutOfRange:
    case FaultKind::kBadLength:
    case FaultKind::kTrailingBytes:
    case FaultKind::kTooLong:
    case FaultKind::kNotBsm:
    case FaultKind::kNotCam:
    case FaultKind::kNotVehicle:
    case FaultKind::kWrongPsid:
      text += " (" + std::to_string(fault.value) + ")";
      break;
    default:
      break;
  }
  return text;
}

}  // namespace v2vouch::obu
