// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/security/trust_anchors.h"

#include <algorithm>

namespace v2vouch::obu {
namespace {

constexpr int kLongestChain = 8;

bool IsInTime(const Certificate& certificate, std::uint32_t dot2_time_s) {
  const std::uint64_t end_s = certificate.valid_from_s + certificate.valid_for_us / 1000000;
  return dot2_time_s >= certificate.valid_from_s && dot2_time_s <= end_s;
}

}  // namespace

Hash CertificateHash(const Certificate& certificate) {
  const auto& r = certificate.signature.r;
  if (certificate.has_canonical_form || !certificate.has_signature || r.x.size() != 32) {
    return Sha256Of({certificate.whole});
  }
  // The signature's point as x-only: 80, x in place of 82/83, x (or 84, x, y).
  const auto before = static_cast<std::size_t>(r.x.data() - certificate.whole.data()) - 1;
  static constexpr std::uint8_t kXOnly[] = {0x80};
  return Sha256Of({certificate.whole.first(before), kXOnly, r.x, certificate.signature.s});
}

Hash SigningHash(Bytes to_be_signed, const Hash& signer_hash) {
  return Sha256Of({Sha256Of({to_be_signed}), signer_hash});
}

HashedId8 DigestOf(const Hash& hash) {
  HashedId8 digest{};
  std::copy(hash.end() - 8, hash.end(), digest.begin());
  return digest;
}

std::optional<std::string> TrustAnchors::AddAnchor(Bytes bytes) { return Add(bytes, true); }
std::optional<std::string> TrustAnchors::AddIntermediate(Bytes bytes) { return Add(bytes, false); }

std::optional<std::string> TrustAnchors::Add(Bytes bytes, bool is_anchor) {
  Authority authority{{bytes.begin(), bytes.end()}, is_anchor};
  ByteReader reader(authority.bytes);
  Certificate certificate;
  if (const Fault fault = ReadCertificate(reader, certificate)) return FaultText(fault);
  if (reader.left() > 0) return "goes on after the certificate";
  if (!certificate.is_key_p256) return "its key is not of NIST P-256";
  if (is_anchor && certificate.is_implicit) return "an implicit certificate cannot be an anchor";
  if (is_anchor && !Decompressed(certificate.key)) return "its key is no point of the curve";
  authorities_[DigestOf(CertificateHash(certificate))] = std::move(authority);
  return std::nullopt;
}

TrustAnchors::Answer TrustAnchors::Prove(const Certificate& certificate,
                                         std::uint32_t dot2_time_s) const {
  return Prove(certificate, dot2_time_s, 0);
}

TrustAnchors::Answer TrustAnchors::Prove(const Certificate& certificate, std::uint32_t dot2_time_s,
                                         int depth) const {
  if (depth > kLongestChain) return {ChainState::kBroken, {}};
  const auto configured = authorities_.find(DigestOf(CertificateHash(certificate)));
  if (configured != authorities_.end() && configured->second.is_anchor &&
      std::ranges::equal(configured->second.bytes, certificate.whole)) {
    if (!IsInTime(certificate, dot2_time_s)) return {ChainState::kNotInTime, {}};
    return {ChainState::kVerified, Decompressed(certificate.key)};
  }
  if (certificate.issuer == Certificate::Issuer::kSelf || certificate.hash_algorithm != 0) {
    return {ChainState::kNoIssuer, {}};
  }
  const auto found = authorities_.find(certificate.issuer_digest);
  if (found == authorities_.end()) return {ChainState::kNoIssuer, {}};
  ByteReader reader(found->second.bytes);
  Certificate issuer;
  if (ReadCertificate(reader, issuer)) return {ChainState::kBroken, {}};
  const Answer above = Prove(issuer, dot2_time_s, depth + 1);
  if (above.state != ChainState::kVerified) return above;
  if (!issuer.may_issue) return {ChainState::kBroken, {}};

  const Hash hash = SigningHash(certificate.to_be_signed, CertificateHash(issuer));
  Answer answer{ChainState::kBroken, {}};
  if (!certificate.is_key_p256) return answer;
  if (certificate.is_implicit) {
    // Has no signature of its own: the issuer gave the key to the holder who signs with it.
    answer.key = ReconstructedKey(hash, certificate.key, *above.key);
  } else {
    const auto issuer_key = PublicKey::FromPoint(*above.key);
    if (!certificate.has_signature || !certificate.signature.is_p256 || !issuer_key ||
        !issuer_key->Verifies(hash, certificate.signature.r.x, certificate.signature.s)) {
      return answer;
    }
    answer.key = Decompressed(certificate.key);
  }
  if (!answer.key) return answer;
  if (!IsInTime(certificate, dot2_time_s)) return {ChainState::kNotInTime, {}};
  answer.state = ChainState::kVerified;
  return answer;
}

}  // namespace v2vouch::obu
