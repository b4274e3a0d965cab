// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/octets/bit_writer.h"

#include <algorithm>

namespace v2vouch::obu {

void BitWriter::Bits(std::uint64_t value, int count) {
  if (failed_ || count <= 0) return;
  auto wanted = static_cast<std::size_t>(count);
  if (wanted > 64 || wanted > bytes_.size() * 8 - at_) {
    failed_ = true;
    return;
  }
  while (wanted > 0) {
    const std::size_t in_byte = 8 - at_ % 8;
    const std::size_t taken = std::min(in_byte, wanted);
    const auto piece = static_cast<unsigned>(value >> (wanted - taken)) & ((1U << taken) - 1U);
    std::uint8_t& byte = bytes_[at_ / 8];
    const unsigned mask = ((1U << taken) - 1U) << (in_byte - taken);
    byte = static_cast<std::uint8_t>((byte & ~mask) | (piece << (in_byte - taken)));
    at_ += taken;
    wanted -= taken;
  }
}

void BitWriter::Length(std::size_t octets) {
  if (octets < 128) {
    Bits(octets, 8);
  } else if (octets < 16384) {
    Bits(0x8000 | octets, 16);
  } else {
    failed_ = true;
  }
}

void BitWriter::Copy(BitView view) {
  BitReader reader(view);
  while (reader.left() > 0 && ok()) {
    const auto count = static_cast<int>(std::min<std::size_t>(reader.left(), 32));
    Bits(reader.Bits(count), count);
  }
}

void BitWriter::Pad() {
  if (at_ % 8 != 0) Bits(0, static_cast<int>(8 - at_ % 8));
}

}  // namespace v2vouch::obu
