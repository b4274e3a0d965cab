// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "daemon/obu/octets/bit_reader.h"

namespace v2vouch::obu {

/// Writes ASN.1 unaligned PER into a buffer of the caller's. A buffer too small sticks as a
/// failure.
class BitWriter {
 public:
  explicit BitWriter(std::span<std::uint8_t> bytes) : bytes_(bytes) {}

  void Bits(std::uint64_t value, int count);
  void Flag(bool value) { Bits(value ? 1 : 0, 1); }
  /// A length determinant in octets, up to 16383.
  void Length(std::size_t octets);
  void Copy(BitView view);
  /// Zero bits up to the next whole byte.
  void Pad();

  [[nodiscard]] bool ok() const { return !failed_; }
  [[nodiscard]] std::size_t bits() const { return at_; }
  /// Bytes used, the last one perhaps in part.
  [[nodiscard]] std::size_t octets() const { return (at_ + 7) / 8; }

 private:
  std::span<std::uint8_t> bytes_;
  std::size_t at_ = 0;
  bool failed_ = false;
};

}  // namespace v2vouch::obu
