// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "daemon/rim/mcap/records.h"

namespace v2vouch::mcap {

/// zlib's CRC32, continued from `before`.
std::uint32_t Crc32(std::span<const std::uint8_t> bytes, std::uint32_t before = 0);

/// Into `packed`, whose storage is reused. @return false where zstd fails (out of memory).
bool Compress(std::span<const std::uint8_t> bytes, std::vector<std::uint8_t>& packed);

enum class UnpackFault : std::uint8_t { kNone, kCompression, kSize, kData };

/// A chunk's records, of at most `most` bytes. Memory grows with what comes out, not with what is
/// announced. With kData or kSize `bytes` holds what could be had up to there.
UnpackFault Unpack(std::string_view compression, std::span<const std::uint8_t> packed,
                   std::uint64_t announced, std::size_t most, std::vector<std::uint8_t>& bytes);

}  // namespace v2vouch::mcap
