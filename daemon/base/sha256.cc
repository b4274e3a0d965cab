// SPDX-License-Identifier: Apache-2.0
#include "daemon/base/sha256.h"

#include <algorithm>
#include <bit>

#include "daemon/base/sha256_x86.h"

namespace v2vouch {

constexpr std::array<std::uint32_t, 64> kSha256Rounds = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

Sha256::Sha256(Rounds rounds) : has_extensions_(rounds == Rounds::kFastest && HasShaExtensions()) {}

void Sha256::Add(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const std::size_t filled = length_ % 64;
    std::size_t taken = std::min(bytes.size(), 64 - filled);
    if (taken == 64) {  // Whole blocks need not be copied first.
      taken = bytes.size() / 64 * 64;
      Compress(bytes.data(), taken / 64);
    } else {
      std::copy_n(bytes.begin(), taken, rest_.begin() + static_cast<std::ptrdiff_t>(filled));
      if (filled + taken == 64) Compress(rest_.data(), 1);
    }
    length_ += taken;
    bytes = bytes.subspan(taken);
  }
}

void Sha256::Compress(const std::uint8_t* bytes, std::size_t blocks) {
  if (has_extensions_) return CompressWithShaExtensions(state_, bytes, blocks);
  for (; blocks > 0; --blocks, bytes += 64) CompressPlainly(bytes);
}

// FIPS 180-4, 6.2.2. The letters do not move from round to round: eight rounds name them eight
// ways. Of the message schedule the last sixteen words are kept.
void Sha256::CompressPlainly(const std::uint8_t* block) {
  std::array<std::uint32_t, 16> w;
  for (std::size_t t = 0; t < 16; ++t) {
    w[t] = (std::uint32_t{block[4 * t]} << 24) | (std::uint32_t{block[4 * t + 1]} << 16) |
           (std::uint32_t{block[4 * t + 2]} << 8) | std::uint32_t{block[4 * t + 3]};
  }
  auto [a, b, c, d, e, f, g, h] = state_;
  using Word = std::uint32_t;
  const auto round = [](Word a_, Word b_, Word c_, Word& d_, Word e_, Word f_, Word g_, Word& h_,
                        Word added) {
    const Word sum1 = std::rotr(e_, 6) ^ std::rotr(e_, 11) ^ std::rotr(e_, 25);
    const Word t1 = h_ + sum1 + (g_ ^ (e_ & (f_ ^ g_))) + added;
    const Word sum0 = std::rotr(a_, 2) ^ std::rotr(a_, 13) ^ std::rotr(a_, 22);
    d_ += t1;
    h_ = t1 + sum0 + ((a_ & b_) | (c_ & (a_ | b_)));
  };
  for (std::size_t t = 0; t < 64; t += 16) {
    if (t > 0) {
      for (std::size_t i = 0; i < 16; ++i) {
        const Word w15 = w[(i + 1) % 16];
        const Word w2 = w[(i + 14) % 16];
        w[i] += (std::rotr(w15, 7) ^ std::rotr(w15, 18) ^ (w15 >> 3)) + w[(i + 9) % 16] +
                (std::rotr(w2, 17) ^ std::rotr(w2, 19) ^ (w2 >> 10));
      }
    }
    for (std::size_t i = 0; i < 16; i += 8) {
      const auto added = [&](std::size_t j) { return kSha256Rounds[t + i + j] + w[i + j]; };
      round(a, b, c, d, e, f, g, h, added(0));
      round(h, a, b, c, d, e, f, g, added(1));
      round(g, h, a, b, c, d, e, f, added(2));
      round(f, g, h, a, b, c, d, e, added(3));
      round(e, f, g, h, a, b, c, d, added(4));
      round(d, e, f, g, h, a, b, c, added(5));
      round(c, d, e, f, g, h, a, b, added(6));
      round(b, c, d, e, f, g, h, a, added(7));
    }
  }
  const std::array<Word, 8> worked = {a, b, c, d, e, f, g, h};
  for (std::size_t i = 0; i < 8; ++i) state_[i] += worked[i];
}

std::string Sha256::Hex() const {
  Sha256 end = *this;  // Padding goes into a copy: the digest runs on.
  const std::uint64_t bits = length_ * 8;
  end.Add(std::array<std::uint8_t, 1>{0x80});
  while (end.length_ % 64 != 56) end.Add(std::array<std::uint8_t, 1>{0});
  std::array<std::uint8_t, 8> length{};
  for (std::size_t i = 0; i < 8; ++i) length[i] = static_cast<std::uint8_t>(bits >> (56 - 8 * i));
  end.Add(length);
  constexpr char kDigits[] = "0123456789abcdef";
  std::string hex;
  for (const std::uint32_t word : end.state_) {
    for (int shift = 28; shift >= 0; shift -= 4) hex += kDigits[(word >> shift) & 15];
  }
  return hex;
}

}  // namespace v2vouch
