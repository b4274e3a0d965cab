// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace v2vouch {

/// Running SHA-256 (FIPS 180-4), with the processor's SHA extensions where it has them.
class Sha256 {
 public:
  enum class Rounds { kFastest, kPlain };
  explicit Sha256(Rounds rounds = Rounds::kFastest);

  void Add(std::span<const std::uint8_t> bytes);
  /// Digest of everything added so far, 64 hex digits; more may be added afterwards.
  [[nodiscard]] std::string Hex() const;

 private:
  void Compress(const std::uint8_t* bytes, std::size_t blocks);
  void CompressPlainly(const std::uint8_t* block);

  std::array<std::uint32_t, 8> state_ = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                         0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<std::uint8_t, 64> rest_{};
  std::uint64_t length_ = 0;  // Bytes so far; length_ % 64 of them wait in rest_.
  bool has_extensions_ = false;
};

}  // namespace v2vouch
