// SPDX-License-Identifier: Apache-2.0
#include "daemon/base/sha256_x86.h"

#include "daemon/base/check.h"

#if defined(__x86_64__)

#include <cpuid.h>
#include <immintrin.h>

namespace v2vouch {

bool HasShaExtensions() {
  static const bool has_them = [] {
    unsigned a = 0, b = 0, c = 0, d = 0;
    if (__get_cpuid(1, &a, &b, &c, &d) == 0) return false;
    const bool has_sse41 = (c & (1U << 19)) != 0 && (c & (1U << 9)) != 0;  // With SSSE3.
    if (__get_cpuid_count(7, 0, &a, &b, &c, &d) == 0) return false;
    return has_sse41 && (b & (1U << 29)) != 0;
  }();
  return has_them;
}

// The instructions keep the eight letters in two registers, (a b e f) and (c d g h), and do two
// rounds at a time on the lower half of a register of w + k.
__attribute__((target("sha,sse4.1"))) void CompressWithShaExtensions(
    std::array<std::uint32_t, 8>& state, const std::uint8_t* bytes, std::size_t blocks) {
  const __m128i to_big_endian = _mm_set_epi64x(0x0c0d0e0f08090a0b, 0x0405060700010203);
  const auto* const rounds = reinterpret_cast<const __m128i*>(kSha256Rounds.data());
  auto* const letters = reinterpret_cast<__m128i*>(state.data());

  const __m128i dcba = _mm_loadu_si128(letters);
  const __m128i hgfe = _mm_loadu_si128(letters + 1);
  const __m128i cdab = _mm_shuffle_epi32(dcba, 0xB1);
  const __m128i efgh = _mm_shuffle_epi32(hgfe, 0x1B);
  __m128i abef = _mm_alignr_epi8(cdab, efgh, 8);
  __m128i cdgh = _mm_blend_epi16(efgh, cdab, 0xF0);

  for (; blocks > 0; --blocks, bytes += 64) {
    const __m128i abef_before = abef;
    const __m128i cdgh_before = cdgh;
    __m128i w[4];
    for (int i = 0; i < 4; ++i) {
      const auto* const from = reinterpret_cast<const __m128i*>(bytes) + i;
      w[i] = _mm_shuffle_epi8(_mm_loadu_si128(from), to_big_endian);
    }
    for (int i = 0; i < 16; ++i) {  // Four rounds each; w[i % 4] holds the words of these four.
      __m128i& now = w[i & 3];
      if (i >= 4) {
        const __m128i w9 = _mm_alignr_epi8(w[(i + 3) & 3], w[(i + 2) & 3], 4);
        now = _mm_sha256msg2_epu32(_mm_add_epi32(_mm_sha256msg1_epu32(now, w[(i + 1) & 3]), w9),
                                   w[(i + 3) & 3]);
      }
      const __m128i wk = _mm_add_epi32(now, _mm_loadu_si128(rounds + i));
      cdgh = _mm_sha256rnds2_epu32(cdgh, abef, wk);
      abef = _mm_sha256rnds2_epu32(abef, cdgh, _mm_shuffle_epi32(wk, 0x0E));
    }
    abef = _mm_add_epi32(abef, abef_before);
    cdgh = _mm_add_epi32(cdgh, cdgh_before);
  }

  const __m128i feba = _mm_shuffle_epi32(abef, 0x1B);
  const __m128i dchg = _mm_shuffle_epi32(cdgh, 0xB1);
  _mm_storeu_si128(letters, _mm_blend_epi16(feba, dchg, 0xF0));
  _mm_storeu_si128(letters + 1, _mm_alignr_epi8(dchg, feba, 8));
}

}  // namespace v2vouch

#else

namespace v2vouch {

bool HasShaExtensions() { return false; }
void CompressWithShaExtensions(std::array<std::uint32_t, 8>&, const std::uint8_t*, std::size_t) {
  V2VOUCH_CHECK(false);
}

}  // namespace v2vouch

#endif
