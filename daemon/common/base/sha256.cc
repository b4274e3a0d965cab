// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/base/sha256.h"

#include <openssl/evp.h>

#include "daemon/common/base/check.h"

namespace v2vouch {

void Sha256::Free::operator()(evp_md_ctx_st* context) const { EVP_MD_CTX_free(context); }

Sha256::Sha256() : context_(EVP_MD_CTX_new()) {
  V2VOUCH_CHECK(context_ != nullptr);
  V2VOUCH_CHECK(EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1);
}

Sha256::Sha256(const Sha256& other) : context_(EVP_MD_CTX_new()) { *this = other; }

Sha256& Sha256::operator=(const Sha256& other) {
  if (this != &other) {
    V2VOUCH_CHECK(EVP_MD_CTX_copy_ex(context_.get(), other.context_.get()) == 1);
  }
  return *this;
}

void Sha256::Add(std::span<const std::uint8_t> bytes) {
  V2VOUCH_CHECK(EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()) == 1);
}

std::array<std::uint8_t, 32> Sha256::Digest() const {
  // Of a copy: finishing ends a running digest.
  const Sha256 copy(*this);
  std::array<std::uint8_t, 32> digest{};
  V2VOUCH_CHECK(EVP_DigestFinal_ex(copy.context_.get(), digest.data(), nullptr) == 1);
  return digest;
}

}  // namespace v2vouch
