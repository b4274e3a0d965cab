// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/warnings_wire/feed.h"

#include "daemon/rim/warnings_wire/warnings_conversion.h"
#include "daemon/rim/wire/codec.h"

namespace v2vouch::wire {

std::optional<warnings::WarningList> WarnFeed::Take(const std::string& channel,
                                                    std::span<const std::uint8_t> bytes) {
  const bool is_local = channel == channels_.tracks_local;
  if (is_local || channel == channels_.tracks_priority) {
    const auto list = Decode<track_list_t>(bytes);
    if (!list) {
      ++refused_;
      return std::nullopt;
    }
    ++taken_;
    return is_local ? warner_.OnLocal(ToTargets(*list, ListOrigin::kLocal))
                    : warner_.OnPriority(ToTargets(*list, ListOrigin::kPriority));
  }
  if (channel == channels_.ego_motion) {
    const auto motion = Decode<ego_motion_t>(bytes);
    const auto reading = motion ? ToEgoReading(*motion) : std::nullopt;
    ++(reading ? taken_ : refused_);
    if (reading) warner_.OnEgo(*reading);
  } else if (channel == channels_.ego_intent) {
    const auto intent = Decode<ego_intent_t>(bytes);
    ++(intent ? taken_ : refused_);
    if (intent) warner_.OnIntent(ToIntent(*intent));
  }
  return std::nullopt;
}

}  // namespace v2vouch::wire
