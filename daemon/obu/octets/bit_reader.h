// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "daemon/obu/octets/fault.h"

namespace v2vouch::obu {

/// Some bits of a buffer, which need not begin at a byte. Owns nothing: valid as long as the
/// buffer.
struct BitView {
  std::span<const std::uint8_t> bytes;
  std::size_t first_bit = 0;
  std::size_t bits = 0;
};

/// Reads ASN.1 unaligned PER (ITU-T X.691), most significant bit first. The first thing that goes
/// wrong sticks: from then on every read gives 0 and nothing moves. Never allocates.
class BitReader {
 public:
  explicit BitReader(std::span<const std::uint8_t> bytes)
      : BitReader(BitView{bytes, 0, bytes.size() * 8}) {}
  explicit BitReader(BitView view);

  /// The next `count` bits, 0 to 64, as an unsigned number.
  std::uint64_t Bits(int count);
  bool Flag() { return Bits(1) != 0; }
  /// A constrained whole number of low..high in `count` bits; codes above `high` are a fault.
  std::int64_t Whole(int count, std::int64_t low, std::int64_t high, std::string_view where);
  /// A length determinant in octets. Lengths in pieces (16k and more) are a fault.
  std::size_t Length(std::string_view where);
  /// The content of an open type or octet string: length determinant, then that many octets.
  BitView Octets(std::string_view where);
  void Skip(std::size_t bits, std::string_view where);
  /// The additions after a sequence whose extension bit was set: passed over, each by its length.
  void SkipExtensions(std::string_view where);

  void Fail(FaultKind kind, std::string_view where, std::int64_t value = 0);
  [[nodiscard]] const Fault& fault() const { return fault_; }
  [[nodiscard]] bool ok() const { return !fault_; }
  [[nodiscard]] std::size_t left() const { return end_ - at_; }
  /// Bits read so far.
  [[nodiscard]] std::size_t position() const { return at_ - begin_; }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t begin_ = 0;
  std::size_t at_ = 0;
  std::size_t end_ = 0;
  Fault fault_;
};

}  // namespace v2vouch::obu
