// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "daemon/obu/security/p256.h"

namespace v2vouch::obu {

/// Hash of a certificate in canonical form; its last eight bytes are the HashedId8.
Hash CertificateHash(const Certificate& certificate);
HashedId8 DigestOf(const Hash& hash);

/// What a signature, or the key of an implicit certificate, is made over (1609.2, 5.3.1):
///
///     H(H(toBeSigned) || H(signer's certificate)),  of the empty string for one that signs itself
Hash SigningHash(Bytes to_be_signed, const Hash& signer_hash);

/// Why a chain does or does not lead to a configured anchor.
enum class ChainState : std::uint8_t {
  kVerified,
  kNoIssuer,   ///< The issuer is not known here: nothing can be said.
  kBroken,     ///< A signature or permission in the chain does not hold.
  kNotInTime,  ///< Expired or not yet valid.
};

/// Certificates of authorities: the configured ones, and what follows from them.
class TrustAnchors {
 public:
  /// One certificate in COER, trusted by configuration. @return what is wrong with it.
  std::optional<std::string> AddAnchor(Bytes bytes);
  /// A certificate of an authority that must itself be proven by the anchors.
  std::optional<std::string> AddIntermediate(Bytes bytes);

  struct Answer {
    ChainState state = ChainState::kNoIssuer;
    std::optional<Point> key;  ///< With which the holder signs; kVerified only.
  };
  /// Follows the issuers of `certificate` up to an anchor, at most eight of them.
  /// @param dot2_time_s seconds since 2004 at which it must be valid.
  [[nodiscard]] Answer Prove(const Certificate& certificate, std::uint32_t dot2_time_s) const;

  [[nodiscard]] std::size_t size() const { return authorities_.size(); }

 private:
  struct Authority {
    std::vector<std::uint8_t> bytes;
    bool is_anchor = false;
  };
  std::optional<std::string> Add(Bytes bytes, bool is_anchor);
  [[nodiscard]] Answer Prove(const Certificate& certificate, std::uint32_t dot2_time_s,
                             int depth) const;

  std::map<HashedId8, Authority> authorities_;
};

}  // namespace v2vouch::obu
