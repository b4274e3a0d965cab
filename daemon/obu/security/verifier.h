// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <list>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "daemon/obu/ieee1609/dot2.h"
#include "daemon/obu/security/trust_anchors.h"

namespace v2vouch::obu {

/// What could be said of a signature.
enum class SignatureFinding : std::uint8_t {
  kUnsigned,
  kUnread,               ///< Another curve or hash, or a header that could not be read.
  kCertificateUnknown,   ///< Signed with a digest whose certificate was not heard.
  kFirst,                ///< First message of a certificate without a chain: key remembered.
  kConsistent,           ///< Same key as the certificate's earlier messages; no chain.
  kConflict,             ///< Another key than before, and neither is proven.
  kConflictEstablished,  ///< Another key than the certificate's established one.
  kVerified,             ///< Good, under a chain to a configured anchor.
  kForged,               ///< Does not fit the key of a proven certificate.
  kNotInTime,            ///< Proven certificate, but expired or not yet valid.
  kNotPermitted,         ///< Proven certificate that may not sign for this application.
  kBrokenChain,          ///< The certificate claims a known issuer, which did not make it.
  kOverBudget,           ///< Not looked at: more signatures per second than configured.
  kCount
};
std::string_view FindingName(SignatureFinding finding);

struct VerifierConfig {
  std::size_t most_certificates = 4096;   ///< Remembered; the one not heard for longest goes.
  int established_messages = 20;          ///< Of one key, for it to be established,
  std::int64_t established_us = 5000000;  ///< over this time.
  int checks_per_s = 2000;                ///< Signatures looked at; 0 = none.
};

struct Judgement {
  SignatureFinding finding = SignatureFinding::kUnsigned;
  HashedId8 digest{};  ///< Of the signer's certificate; zeros = none.
  /// As bsm_t: 1 valid only under a chain to a configured anchor; 2 invalid only against a proven
  /// or established key; else 0 unknown. Anybody can sign under a certificate that nobody vouches
  /// for.
  [[nodiscard]] std::int8_t signature_state() const;
};

/// Judges signatures of one stream of messages, in its order. Reads no clock: time is the
/// messages'.
class Verifier {
 public:
  Verifier(VerifierConfig config, TrustAnchors anchors);

  /// @param rx_utime reception, us UTC; spends the budget.
  Judgement Judge(const Dot2Data& data, std::int64_t rx_utime);

  [[nodiscard]] std::size_t certificates() const { return signers_.size(); }

 private:
  struct Signer {
    HashedId8 digest{};
    Hash hash{};
    PsidList psids;  // May sign for these.
    std::uint32_t valid_from_s = 0;
    std::uint64_t valid_to_s = 0;
    std::optional<PublicKey> proven;
    bool is_broken = false;           // Its chain does not hold.
    std::vector<Point> candidates;    // Of the first message.
    std::optional<PublicKey> pinned;  // Two messages have it in common.
    int messages = 0;                 // Under the pinned key,
    std::int64_t first_utime = 0;     // uncontested from then
    std::int64_t last_utime = 0;      // to then.
  };

  Signer* Find(const HashedId8& digest);
  Signer& Learn(const Hash& hash, const Dot2Data& data);
  bool SpendBudget(std::int64_t rx_utime);
  [[nodiscard]] SignatureFinding JudgeProven(const Signer& signer, const Dot2Data& data,
                                             const Hash& hash) const;
  SignatureFinding JudgePinned(Signer& signer, const Dot2Data& data, const Hash& hash,
                               std::int64_t rx_utime) const;

  VerifierConfig config_;
  TrustAnchors anchors_;
  std::list<Signer> signers_;  // Latest heard first.
  std::map<HashedId8, std::list<Signer>::iterator> by_digest_;
  std::int64_t budget_second_ = 0;
  int spent_ = 0;
};

}  // namespace v2vouch::obu
