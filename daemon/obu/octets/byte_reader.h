// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "daemon/obu/octets/fault.h"

namespace v2vouch::obu {

using Bytes = std::span<const std::uint8_t>;

/// Longest datagram looked at: a message and its envelopes stay under 1500 bytes.
inline constexpr std::size_t kLongestDatagram = 2304;

/// Reads whole bytes, big endian where not said otherwise, and the lengths of ASN.1 OER (ITU-T
/// X.696). The first thing that goes wrong sticks: every later read gives 0. Never allocates.
class ByteReader {
 public:
  explicit ByteReader(Bytes bytes) : bytes_(bytes) {}

  /// The next `count` bytes, 1 to 8, as an unsigned number.
  std::uint64_t Big(std::size_t count, std::string_view where);
  std::uint64_t Little(std::size_t count, std::string_view where);
  std::uint8_t Byte(std::string_view where) { return static_cast<std::uint8_t>(Big(1, where)); }
  Bytes Take(std::size_t count, std::string_view where);
  void Skip(std::size_t count, std::string_view where) { Take(count, where); }
  Bytes Rest() { return Take(left(), ""); }

  /// OER length: one byte below 0x80, else 0x80 + n and n bytes.
  std::size_t Length(std::string_view where);
  /// Length, then that many bytes.
  Bytes Block(std::string_view where) { return Take(Length(where), where); }
  /// Number of elements of an OER SEQUENCE OF.
  std::size_t Quantity(std::size_t at_most, std::string_view where);
  /// The additions after an OER sequence whose extension bit was set, passed over by length.
  void SkipExtensions(std::string_view where);

  /// The byte `ahead` of the next one; -1 past the end.
  [[nodiscard]] int Peek(std::size_t ahead = 0) const {
    return !fault_ && ahead < left() ? bytes_[at_ + ahead] : -1;
  }
  void Fail(FaultKind kind, std::string_view where, std::int64_t value = 0) {
    if (!fault_) fault_ = {kind, where, value};
  }
  [[nodiscard]] const Fault& fault() const { return fault_; }
  [[nodiscard]] bool ok() const { return !fault_; }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  [[nodiscard]] std::size_t position() const { return at_; }
  /// Bytes from position `from` to here.
  [[nodiscard]] Bytes Since(std::size_t from) const { return bytes_.subspan(from, at_ - from); }

 private:
  Bytes bytes_;
  std::size_t at_ = 0;
  Fault fault_;
};

}  // namespace v2vouch::obu
