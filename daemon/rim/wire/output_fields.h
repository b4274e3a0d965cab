// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "daemon/common/base/time.h"
#include "daemon/common/data/input.h"

namespace v2vouch::wire {

/// Parts that several of our output messages have in common.

/// Below the decoder's limit, so that nothing of ours is refused by a reader of ours.
inline constexpr std::size_t kMaxNameBytes = 255;

template <class Count, class Vector>
void SetCount(Count& count, const Vector& vector) {
  count = static_cast<Count>(vector.size());
}

inline std::int64_t MicrosOrNever(const std::optional<Timestamp>& stamp) {
  return stamp ? ToMicros(*stamp) : 0;
}

inline void PutSender(SenderId sender, std::uint8_t* octets) {
  for (int i = 0; i < 4; ++i) octets[i] = static_cast<std::uint8_t>(sender >> (24 - 8 * i));
}

inline std::string Name(std::string_view text) {
  return std::string(text.substr(0, kMaxNameBytes));
}

}  // namespace v2vouch::wire
