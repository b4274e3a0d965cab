// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace v2vouch::log_format {

inline constexpr std::uint32_t kSyncWord = 0xEDA1DA01;
inline constexpr std::size_t kHeaderBytes = 28;  // Sync, number, time, channel and data length.

template <class T>
T Load(const std::uint8_t* p) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) value = (value << 8) | p[i];
  return static_cast<T>(value);
}

template <class T>
void Store(std::uint8_t* p, T value) {
  auto bits = static_cast<std::uint64_t>(value);
  for (std::size_t i = sizeof(T); i-- > 0; bits >>= 8) p[i] = static_cast<std::uint8_t>(bits);
}

}  // namespace v2vouch::log_format
