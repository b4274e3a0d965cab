// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace v2vouch {

/// Whether this processor has the SHA extensions (and the SSE4.1 they are used with). Always false
/// where the program was not built for x86-64.
bool HasShaExtensions();

/// FIPS 180-4, 6.2.2, over `blocks` blocks of 64 bytes with the SHA extensions: the same digest as
/// the plain rounds, about five times as fast (benchmark BM_Digest). Only where HasShaExtensions().
/// Source: Intel 64 and IA-32 Architectures Software Developer's Manual, vol. 2, SHA256RNDS2,
/// SHA256MSG1, SHA256MSG2.
void CompressWithShaExtensions(std::array<std::uint32_t, 8>& state, const std::uint8_t* bytes,
                               std::size_t blocks);

/// FIPS 180-4, 4.2.2: fractional parts of the cube roots of the first 64 primes.
extern const std::array<std::uint32_t, 64> kSha256Rounds;

}  // namespace v2vouch
