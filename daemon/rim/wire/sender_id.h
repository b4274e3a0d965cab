// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>

namespace v2vouch::wire {

/// J2735's TemporaryID (four octets) as a number.
inline std::uint32_t SenderOf(const std::uint8_t* octets) {
  std::uint32_t sender = 0;
  for (int i = 0; i < 4; ++i) sender = (sender << 8U) | octets[i];
  return sender;
}

/// As eight hex digits.
inline std::string SenderName(std::uint32_t sender) {
  char text[9];
  std::snprintf(text, sizeof text, "%08x", sender);
  return text;
}

}  // namespace v2vouch::wire
