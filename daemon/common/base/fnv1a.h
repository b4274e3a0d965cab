// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace v2vouch {

/// FNV-1a, 64 bits: a quick hash for tables, equal on every machine. No protection against whoever
/// wants two equal ones. Source: Fowler, Noll, Vo; draft-eastlake-fnv.
class Fnv1a {
 public:
  static constexpr std::uint64_t kPrime = 0x100000001B3;

  /// @param seed other seeds, other hashes.
  explicit constexpr Fnv1a(std::uint64_t seed = 0) : value_(0xCBF29CE484222325 ^ seed) {}

  constexpr void Add(std::uint8_t byte) { value_ = (value_ ^ byte) * kPrime; }
  constexpr void Add(std::span<const std::uint8_t> bytes) {
    for (const std::uint8_t byte : bytes) Add(byte);
  }
  constexpr void Add(std::string_view text) {
    for (const char letter : text) Add(static_cast<std::uint8_t>(letter));
  }
  /// Its eight bytes, least significant first.
  constexpr void Add(std::int64_t figure) {
    for (int shift = 0; shift < 64; shift += 8) {
      Add(static_cast<std::uint8_t>(static_cast<std::uint64_t>(figure) >> shift));
    }
  }
  [[nodiscard]] constexpr std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_;
};

}  // namespace v2vouch
