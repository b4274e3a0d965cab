// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/intake/knock_memory.h"

namespace v2vouch {
namespace {

constexpr std::size_t kEntries = 16384;  // A flood of 8000 new ids a second for 2 s.
constexpr int kTickShift = 14;           // 2^14 us.
constexpr std::uint32_t kMemory = 122;   // Ticks: 2 s.

}  // namespace

KnockMemory::KnockMemory() : entries_(kEntries) {}

bool KnockMemory::Knock(SenderId sender, Timestamp now) {
  // Fibonacci hashing (Knuth, TAOCP 6.4): the top bits of the product.
  const std::uint32_t hash = sender * 2654435769U;
  Entry& entry = entries_[hash >> 18U];
  const auto tick = static_cast<std::uint32_t>(ToMicros(now) >> kTickShift) + 1U;
  const bool has_knocked =
      entry.tick != 0 && entry.sender == sender && tick - entry.tick <= kMemory;
  entry = {sender, tick};
  return has_knocked;
}

}  // namespace v2vouch
