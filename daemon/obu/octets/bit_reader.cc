// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/octets/bit_reader.h"

#include <algorithm>

namespace v2vouch::obu {

BitReader::BitReader(BitView view) : bytes_(view.bytes) {
  const std::size_t all = bytes_.size() * 8;
  begin_ = std::min(view.first_bit, all);
  at_ = begin_;
  end_ = begin_ + std::min(view.bits, all - begin_);
}

void BitReader::Fail(FaultKind kind, std::string_view where, std::int64_t value) {
  if (!fault_) fault_ = {kind, where, value};
}

std::uint64_t BitReader::Bits(int count) {
  if (fault_ || count <= 0) return 0;
  auto wanted = static_cast<std::size_t>(count);
  if (wanted > 64 || wanted > left()) {
    Fail(FaultKind::kTruncated, "bits");
    return 0;
  }
  std::uint64_t value = 0;
  while (wanted > 0) {
    const std::size_t in_byte = 8 - at_ % 8;
    const std::size_t taken = std::min(in_byte, wanted);
    const unsigned byte = bytes_[at_ / 8];
    const unsigned piece = (byte >> (in_byte - taken)) & ((1U << taken) - 1U);
    value = (value << taken) | piece;
    at_ += taken;
    wanted -= taken;
  }
  return value;
}

std::int64_t BitReader::Whole(int count, std::int64_t low, std::int64_t high,
                              std::string_view where) {
  if (fault_) return 0;
  if (count < 0 || static_cast<std::size_t>(count) > left()) {
    Fail(FaultKind::kTruncated, where);
    return 0;
  }
  const std::int64_t value = low + static_cast<std::int64_t>(Bits(count));
  if (value > high) {
    Fail(FaultKind::kOutOfRange, where, value);
    return 0;
  }
  return value;
}

std::size_t BitReader::Length(std::string_view where) {
  if (!Flag()) return static_cast<std::size_t>(Bits(7));
  if (!Flag()) return static_cast<std::size_t>(Bits(14));
  Fail(FaultKind::kFragmented, where);
  return 0;
}

BitView BitReader::Octets(std::string_view where) {
  const std::size_t bits = Length(where) * 8;
  if (fault_) return {};
  const BitView view{bytes_, at_, bits};
  Skip(bits, where);
  return fault_ ? BitView{} : view;
}

void BitReader::Skip(std::size_t bits, std::string_view where) {
  if (fault_) return;
  if (bits > left()) {
    Fail(FaultKind::kTruncated, where);
    return;
  }
  at_ += bits;
}

void BitReader::SkipExtensions(std::string_view where) {
  // X.691 19.7: a normally small length (0 and six bits, one less; larger ones have their own form)
  // of the presence bitmap, then one open type for each bit that is set.
  const std::size_t count =
      Flag() ? Length(where) : static_cast<std::size_t>(Bits(6)) + (ok() ? 1 : 0);
  if (count > 64) Fail(FaultKind::kBadLength, where, static_cast<std::int64_t>(count));
  std::uint64_t present = Bits(static_cast<int>(std::min<std::size_t>(count, 64)));
  for (; present != 0 && ok(); present &= present - 1) Octets(where);
}

}  // namespace v2vouch::obu
