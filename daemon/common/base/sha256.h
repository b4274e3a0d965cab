// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "daemon/common/base/hex_text.h"

struct evp_md_ctx_st;

namespace v2vouch {

/// Running SHA-256 (FIPS 180-4), by OpenSSL's libcrypto. A copy goes on by itself.
class Sha256 {
 public:
  Sha256();
  Sha256(const Sha256& other);
  Sha256& operator=(const Sha256& other);

  void Add(std::span<const std::uint8_t> bytes);
  /// Digest of everything added so far; more may be added afterwards.
  [[nodiscard]] std::array<std::uint8_t, 32> Digest() const;
  /// The same in 64 hex digits.
  [[nodiscard]] std::string Hex() const { return HexText(Digest()); }

 private:
  struct Free {
    void operator()(evp_md_ctx_st* context) const;
  };
  std::unique_ptr<evp_md_ctx_st, Free> context_;
};

}  // namespace v2vouch
