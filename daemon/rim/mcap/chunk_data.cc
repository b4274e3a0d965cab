// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/mcap/chunk_data.h"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <memory>

namespace v2vouch::mcap {
namespace {

constexpr int kLevel = 1;  // Fast; level 3 makes our logs a tenth smaller at twice the time.

UnpackFault UnpackZstd(std::span<const std::uint8_t> packed, std::size_t size,
                       std::vector<std::uint8_t>& bytes) {
  const std::unique_ptr<ZSTD_DStream, std::size_t (*)(ZSTD_DStream*)> stream(ZSTD_createDStream(),
                                                                             ZSTD_freeDStream);
  if (!stream) return UnpackFault::kData;
  ZSTD_DCtx_setParameter(stream.get(), ZSTD_d_windowLogMax, 27);
  ZSTD_inBuffer in{packed.data(), packed.size(), 0};
  std::vector<std::uint8_t> piece(ZSTD_DStreamOutSize());
  for (;;) {
    ZSTD_outBuffer out{piece.data(), piece.size(), 0};
    const std::size_t result = ZSTD_decompressStream(stream.get(), &out, &in);
    if (ZSTD_isError(result) != 0U) return UnpackFault::kData;
    if (out.pos > size - bytes.size()) return UnpackFault::kSize;
    bytes.insert(bytes.end(), piece.begin(), piece.begin() + static_cast<std::ptrdiff_t>(out.pos));
    if (out.pos < out.size && in.pos == in.size) {
      return result == 0 && bytes.size() == size ? UnpackFault::kNone : UnpackFault::kData;
    }
  }
}

}  // namespace

std::uint32_t Crc32(std::span<const std::uint8_t> bytes, std::uint32_t before) {
  return static_cast<std::uint32_t>(crc32_z(before, bytes.data(), bytes.size()));
}

bool Compress(std::span<const std::uint8_t> bytes, std::vector<std::uint8_t>& packed) {
  packed.resize(ZSTD_compressBound(bytes.size()));
  const std::size_t size =
      ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), kLevel);
  if (ZSTD_isError(size) != 0U) return false;
  packed.resize(size);
  return true;
}

UnpackFault Unpack(std::string_view compression, std::span<const std::uint8_t> packed,
                   std::uint64_t announced, std::size_t most, std::vector<std::uint8_t>& bytes) {
  bytes.clear();
  if (announced > most) return UnpackFault::kSize;
  if (compression.empty()) {
    const auto size = std::min<std::uint64_t>(announced, packed.size());
    bytes.assign(packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(size));
    return packed.size() == announced ? UnpackFault::kNone : UnpackFault::kData;
  }
  if (compression != "zstd") return UnpackFault::kCompression;
  return UnpackZstd(packed, static_cast<std::size_t>(announced), bytes);
}

}  // namespace v2vouch::mcap
