// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/octets/byte_reader.h"

namespace v2vouch::obu {

Bytes ByteReader::Take(std::size_t count, std::string_view where) {
  if (fault_) return {};
  if (count > left()) {
    Fail(FaultKind::kTruncated, where);
    return {};
  }
  const Bytes taken = bytes_.subspan(at_, count);
  at_ += count;
  return taken;
}

std::uint64_t ByteReader::Big(std::size_t count, std::string_view where) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : Take(count, where)) value = (value << 8) | byte;
  return value;
}

std::uint64_t ByteReader::Little(std::size_t count, std::string_view where) {
  std::uint64_t value = 0;
  const Bytes taken = Take(count, where);
  for (std::size_t i = taken.size(); i-- > 0;) value = (value << 8) | taken[i];
  return value;
}

std::size_t ByteReader::Length(std::string_view where) {
  const std::size_t first = Byte(where);
  if (first < 0x80) return first;
  const std::size_t count = first - 0x80;
  if (count < 1 || count > 4) {
    Fail(FaultKind::kBadLength, where, static_cast<std::int64_t>(count));
    return 0;
  }
  return static_cast<std::size_t>(Big(count, where));
}

std::size_t ByteReader::Quantity(std::size_t at_most, std::string_view where) {
  const std::size_t octets = Length(where);
  if (octets < 1 || octets > 4) {
    Fail(FaultKind::kBadLength, where, static_cast<std::int64_t>(octets));
    return 0;
  }
  const auto count = static_cast<std::size_t>(Big(octets, where));
  if (count > at_most) {
    Fail(FaultKind::kBadLength, where, static_cast<std::int64_t>(count));
    return 0;
  }
  return fault_ ? 0 : count;
}

void ByteReader::SkipExtensions(std::string_view where) {
  // X.696 16.4: the presence bitmap as a bit string (length, unused bits, bits), then one open type
  // for each bit that is set.
  ByteReader bitmap(Block(where));
  const unsigned unused = bitmap.Byte(where);
  if (unused > 7 || bitmap.left() > 8 || bitmap.left() == 0) {
    Fail(FaultKind::kBadLength, where, static_cast<std::int64_t>(unused));
    return;
  }
  std::uint64_t present = bitmap.Big(bitmap.left(), where) >> unused;
  for (; present != 0 && ok(); present &= present - 1) Block(where);
}

}  // namespace v2vouch::obu
