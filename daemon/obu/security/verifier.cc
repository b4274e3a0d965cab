// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/security/verifier.h"

#include <algorithm>
#include <array>

namespace v2vouch::obu {
namespace {

// Seconds since 2004 at which a certificate must be valid: when the message was made.
std::uint32_t TimeOf(const Dot2Data& data) {
  return static_cast<std::uint32_t>(
      std::min<std::uint64_t>(data.generation_us.value_or(0) / 1000000, UINT32_MAX));
}

}  // namespace

std::string_view FindingName(SignatureFinding finding) {
  static constexpr std::array<std::string_view, static_cast<std::size_t>(SignatureFinding::kCount)>
      kNames = {"unsigned",
                "unread",
                "certificate_unknown",
                "first",
                "consistent",
                "conflict",
                "conflict_established",
                "verified",
                "forged",
                "certificate_not_in_time",
                "certificate_not_permitted",
                "broken_chain",
                "over_budget"};
  return kNames.at(static_cast<std::size_t>(finding));
}

std::int8_t Judgement::signature_state() const {
  switch (finding) {
    case SignatureFinding::kVerified:
      return 1;
    case SignatureFinding::kForged:
    case SignatureFinding::kConflictEstablished:
      return 2;
    default:
      return 0;
  }
}

Verifier::Verifier(VerifierConfig config, TrustAnchors anchors)
    : config_(config), anchors_(std::move(anchors)) {
  config_.most_certificates = std::max<std::size_t>(config_.most_certificates, 1);
}

bool Verifier::SpendBudget(std::int64_t rx_utime) {
  const std::int64_t second = rx_utime / 1000000;
  if (second != budget_second_) spent_ = 0;
  budget_second_ = second;
  if (spent_ >= config_.checks_per_s) return false;
  ++spent_;
  return true;
}

Verifier::Signer* Verifier::Find(const HashedId8& digest) {
  const auto found = by_digest_.find(digest);
  if (found == by_digest_.end()) return nullptr;
  signers_.splice(signers_.begin(), signers_, found->second);
  return &*found->second;
}

Verifier::Signer& Verifier::Learn(const Hash& hash, const Dot2Data& data) {
  const Certificate& certificate = *data.certificate;
  const HashedId8 digest = DigestOf(hash);
  // Eight bytes can be made to collide, thirty-two cannot.
  if (Signer* known = Find(digest); known != nullptr && known->hash == hash) return *known;
  if (const auto old = by_digest_.find(digest); old != by_digest_.end()) {
    signers_.erase(old->second);
    by_digest_.erase(old);
  }
  while (signers_.size() >= config_.most_certificates) {
    by_digest_.erase(signers_.back().digest);
    signers_.pop_back();
  }
  Signer signer;
  signer.digest = digest;
  signer.hash = hash;
  signer.psids = certificate.psids;
  signer.valid_from_s = certificate.valid_from_s;
  signer.valid_to_s = certificate.valid_from_s + certificate.valid_for_us / 1000000;
  // Proven for a time at which it is itself valid: whether it is now is asked for each message.
  const auto at_s = static_cast<std::uint32_t>(
      std::clamp<std::uint64_t>(TimeOf(data), signer.valid_from_s, signer.valid_to_s));
  const TrustAnchors::Answer answer = anchors_.Prove(certificate, at_s);
  if (answer.state == ChainState::kVerified && answer.key) {
    signer.proven = PublicKey::FromPoint(*answer.key);
  }
  signer.is_broken = answer.state == ChainState::kBroken;
  signers_.push_front(std::move(signer));
  by_digest_[digest] = signers_.begin();
  return signers_.front();
}

SignatureFinding Verifier::JudgeProven(const Signer& signer, const Dot2Data& data,
                                       const Hash& hash) const {
  if (!signer.proven->Verifies(hash, data.signature.r.x, data.signature.s)) {
    return SignatureFinding::kForged;
  }
  const std::uint32_t time_s = TimeOf(data);
  if (time_s < signer.valid_from_s || time_s > signer.valid_to_s) {
    return SignatureFinding::kNotInTime;
  }
  return signer.psids.Has(data.psid) ? SignatureFinding::kVerified
                                     : SignatureFinding::kNotPermitted;
}

SignatureFinding Verifier::JudgePinned(Signer& signer, const Dot2Data& data, const Hash& hash,
                                       std::int64_t rx_utime) const {
  if (signer.pinned) {
    if (signer.pinned->Verifies(hash, data.signature.r.x, data.signature.s)) {
      ++signer.messages;
      signer.last_utime = std::max(signer.last_utime, rx_utime);
      return SignatureFinding::kConsistent;
    }
    if (signer.messages >= config_.established_messages &&
        signer.last_utime - signer.first_utime >= config_.established_us) {
      return SignatureFinding::kConflictEstablished;
    }
    // A pin that is young may be the forger's: neither is refused, and a contested one starts anew.
    signer.messages = 0;
    signer.first_utime = rx_utime;
    return SignatureFinding::kConflict;
  }
  std::vector<Point> keys = RecoveredKeys(hash, data.signature.r, data.signature.s);
  if (keys.empty()) return SignatureFinding::kConflict;  // No key at all makes this signature.
  for (const Point& key : keys) {
    if (std::ranges::find(signer.candidates, key) == signer.candidates.end()) continue;
    signer.pinned = PublicKey::FromPoint(key);
    signer.candidates.clear();
    signer.messages = 2;
    signer.last_utime = rx_utime;
    return SignatureFinding::kConsistent;
  }
  const bool is_first = signer.candidates.empty();
  signer.candidates = std::move(keys);
  signer.first_utime = rx_utime;
  return is_first ? SignatureFinding::kFirst : SignatureFinding::kConflict;
}

Judgement Verifier::Judge(const Dot2Data& data, std::int64_t rx_utime) {
  Judgement judgement;
  if (data.content != Dot2Data::Content::kSigned) return judgement;
  judgement.finding = SignatureFinding::kUnread;
  if (data.signer == Dot2Data::Signer::kDigest) judgement.digest = data.signer_digest;
  if (data.security_fault || data.hash_algorithm != 0 || !data.signature.is_p256) {
    return judgement;
  }
  Hash certificate_hash{};
  if (data.certificate) {
    certificate_hash = CertificateHash(*data.certificate);
    judgement.digest = DigestOf(certificate_hash);
  } else if (data.signer != Dot2Data::Signer::kDigest) {
    return judgement;
  }
  if (!SpendBudget(rx_utime)) {
    judgement.finding = SignatureFinding::kOverBudget;
    return judgement;
  }
  Signer* const signer =
      data.certificate ? &Learn(certificate_hash, data) : Find(data.signer_digest);
  if (signer == nullptr) {
    judgement.finding = SignatureFinding::kCertificateUnknown;
    return judgement;
  }
  const Hash hash = SigningHash(data.to_be_signed, signer->hash);
  if (signer->proven) {
    judgement.finding = JudgeProven(*signer, data, hash);
  } else if (signer->is_broken) {
    judgement.finding = SignatureFinding::kBrokenChain;
  } else {
    judgement.finding = JudgePinned(*signer, data, hash, rx_utime);
  }
  return judgement;
}

}  // namespace v2vouch::obu
