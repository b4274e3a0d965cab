// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "daemon/common/base/time.h"
#include "daemon/common/data/outputs.h"
#include "daemon/v2v/trust/checks.h"
#include "daemon/v2v/trust/track_motion.h"
#include "daemon/v2v/trust/trust_config.h"

namespace v2vouch {

/// What is left of a penalty, for the successor of a penalised sender.
struct Penalty {
  TrustState state = TrustState::kNone;  ///< SUSPECT or REVOKED; kNone: no penalty.
  int suspicions = 0;
  int accusations = 0;
  Timestamp since{};
  Timestamp last_finding{};
};

/// What the sensors and the association say for a sender at this moment.
struct ValidationEvidence {
  Timestamp stamp{};
  int co_observations = 0;
  double span_s = 0.0;
  bool is_nis_consistent = false;
  bool is_speed_consistent = true;  ///< The sensors see it as fast as it says.
  bool is_level_plausible = true;   ///< Its constant offset may be its bias.
  bool is_size_plausible = true;
  double margin = 0.0;  ///< Log-likelihood over the second best.
  double min_margin = 4.0;
  bool is_assigned = false;          ///< Chosen one-to-one.
  bool are_sensors_sure = false;     ///< Radar and camera, or one of them long enough.
  bool is_ego_gnss_suspect = false;  ///< The ego's position is in doubt: no validation.
};

/// Trust in one sender. Pure: evidence in, state and verdicts out.
///
///     UNKNOWN -> CANDIDATE -> VALIDATED <-> BRIDGED -> CANDIDATE (bridge ended, no blame)
///     any -> SUSPECT (withdrawn) -> agreeing with the sensors for clean_s, doubling -> CANDIDATE
///     any -> REVOKED (accused, from hard evidence that lasts) -> revoked_s, doubling -> UNKNOWN
///
/// Silence and hiding clear no sender: only time in which the sensors see a vehicle at the claimed
/// position counts. A sender not yet validated whose claims do not fit the LOCAL track it is paired
/// with is not suspected for that (the track may be another's), it starts from zero.
///
/// Copyable, fixed size.
class SenderTrust {
 public:
  [[nodiscard]] TrustState state() const { return state_; }
  [[nodiscard]] bool is_relied_on() const {
    return state_ == TrustState::kValidated || state_ == TrustState::kBridged;
  }
  /// Whether forgetting this sender now would clear a penalty.
  [[nodiscard]] bool has_penalty() const {
    return state_ == TrustState::kSuspect || state_ == TrustState::kRevoked;
  }
  [[nodiscard]] const ResidualHistory& history() const { return history_; }

  /// A message, and whether it continues the sender's own motion.
  void OnMessage(Timestamp stamp, bool is_consistent, const TrustConfig& config);

  /// A claim beside its LOCAL track. Acts on the gravest finding; TakeVerdict() returns it.
  /// A residual jump together with a break in the sender's own messages withdraws it at once.
  /// @return false for a residual jump while the messages continue each other: the track has
  /// switched to something else, has lately exceeded kinematic limits, or is of partial
  /// observations. No sender is blamed, this one starts from zero; Release() has been called.
  bool OnCoObservation(const CoObservation& observation, bool may_accuse,
                       const TrustConfig& config);

  /// Any other finding (negative evidence, leaving the reachable set, the message stream, ...).
  /// A hard one accuses only where `may_accuse`, else it withdraws.
  void OnFinding(Timestamp stamp, const Finding& finding, bool may_accuse);

  /// CANDIDATE -> VALIDATED where all of the evidence is there. @return whether it happened.
  bool TryValidate(const ValidationEvidence& evidence, const TrustConfig& config);

  void OnSensorsLost();      ///< VALIDATED -> BRIDGED.
  void OnSensorsRegained();  ///< BRIDGED -> VALIDATED.
  /// Bridge or contact ended without blame -> CANDIDATE, which is validated again sooner.
  void Release(Timestamp stamp);
  /// Takes over state, history and penalties of the identity this one continues.
  void InheritFrom(const SenderTrust& old) { *this = old; }
  [[nodiscard]] Penalty penalty() const;
  void Inherit(const Penalty& penalty);
  /// Until when it was validated, where it has not been blamed since.
  [[nodiscard]] std::optional<Timestamp> released() const { return released_; }
  void InheritRelease(Timestamp until) { released_ = until; }

  /// Residuals have lost their common ground (the ego moved its own place): start them again.
  void ForgetResiduals() {
    history_ = {};
    track_motion_ = {};
    accusable_since_.reset();
  }

  /// The verdict that the last call brought, once.
  struct Judgement {
    Verdict verdict = Verdict::kWithdraw;
    Finding finding;
  };
  std::optional<Judgement> TakeVerdict();

 private:
  void StartAgain(Timestamp stamp);
  void Suspect(Timestamp stamp, const Finding& finding);
  void Revoke(Timestamp stamp, const Finding& finding);

  TrustState state_ = TrustState::kUnknown;
  int consistent_run_ = 0;
  int suspicions_ = 0;
  int accusations_ = 0;
  double clean_s_ = 0.0;  // Agreeing with the sensors since the last finding.
  Timestamp state_since_{};
  std::optional<Timestamp> released_;  // Relied on until then, and not blamed since.
  Timestamp last_finding_{};
  std::optional<Timestamp> accusable_since_;
  ResidualHistory history_;
  TrackMotion track_motion_;
  std::optional<Judgement> pending_;
};

}  // namespace v2vouch
