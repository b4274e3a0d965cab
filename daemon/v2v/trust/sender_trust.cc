// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/trust/sender_trust.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace v2vouch {
namespace {

constexpr int kMaxDoublings = 16;      // Of a penalty's time; more would overflow.
constexpr double kMostCredit_s = 0.5;  // For one message, however long the silence before it.

double Doubled(double base_s, int times, double most_s) {
  return std::min(most_s, base_s * std::exp2(std::max(times - 1, 0)));
}

}  // namespace

void SenderTrust::OnMessage(Timestamp stamp, bool is_consistent, const TrustConfig& config) {
  consistent_run_ = is_consistent ? std::min(consistent_run_ + 1, 1'000'000) : 0;
  const double in_state_s = ToSeconds(stamp - state_since_);
  switch (state_) {
    case TrustState::kUnknown:
      if (consistent_run_ >= config.candidate_messages) state_ = TrustState::kCandidate;
      break;
    case TrustState::kSuspect: {
      const double clean_s = Doubled(config.clean_s, suspicions_, config.max_clean_s);
      if (in_state_s >= config.suspect_s && clean_s_ >= clean_s) {
        state_ = TrustState::kCandidate;
        history_ = {};
      }
      break;
    }
    case TrustState::kRevoked:
      if (in_state_s >= Doubled(config.revoked_s, accusations_, config.max_revoked_s)) {
        state_ = TrustState::kUnknown;
        consistent_run_ = 0;
        history_ = {};
      }
      break;
    default:
      break;
  }
}

bool SenderTrust::OnCoObservation(const CoObservation& observation, bool may_accuse,
                                  const TrustConfig& config) {
  const double dt_s = ToSeconds(observation.stamp - history_.last());
  const Eigen::Vector2d track_O =
      observation.track_speed_mps *
      Eigen::Vector2d(std::cos(observation.track_yaw_rad), std::sin(observation.track_yaw_rad));
  if (track_motion_.Observe(observation.stamp, track_O)) history_.Restart();
  history_.Add(observation, config);
  if (history_.is_torn() && !observation.is_own_motion_whole && is_relied_on()) {
    Suspect(observation.stamp,
            {Check::kResidualJump, Verdict::kWithdraw, "jump_m", history_.torn_m(), config.torn_m});
    return true;
  }
  if (history_.is_torn() && observation.is_own_motion_whole) {
    StartAgain(observation.stamp);
    return false;
  }
  // Residuals that jump again and again never settle, so the checks below would never judge.
  if (is_relied_on() && observation.is_own_motion_whole &&
      track_motion_.HasBroken(observation.stamp) && IsFarApart(observation, config)) {
    StartAgain(observation.stamp);
    return false;
  }
  if (observation.is_partial) return true;
  std::optional<Finding> gravest;
  for (const auto check : {CheckLevel, CheckDrift, CheckVelocity, CheckAcceleration}) {
    const auto finding = check(history_, observation, config);
    if (finding && (!gravest || finding->severity > gravest->severity)) gravest = finding;
  }
  if (!gravest || gravest->severity != Verdict::kAccuse || !may_accuse) accusable_since_.reset();
  if (!gravest) {
    if (observation.is_plausible) clean_s_ += std::clamp(dt_s, 0.0, kMostCredit_s);
    return true;
  }
  // The track jumped or strayed, the sender did not.
  const bool is_track_in_doubt =
      observation.is_doubtful || track_motion_.HasBroken(observation.stamp);
  if (observation.is_own_motion_whole && is_track_in_doubt) {
    if (has_penalty()) return true;
    StartAgain(observation.stamp);
    return false;
  }
  clean_s_ = 0.0;
  // What does not fit a stranger's track may be the track: another's, or none.
  if (!is_relied_on() && !has_penalty()) {
    state_ = TrustState::kUnknown;
    consistent_run_ = 0;
    return true;
  }
  if (gravest->severity == Verdict::kAccuse && may_accuse) {
    if (!accusable_since_) accusable_since_ = observation.stamp;
    if (ToSeconds(observation.stamp - *accusable_since_) >= config.accuse_hold_s) {
      Revoke(observation.stamp, *gravest);
      return true;
    }
  }
  Suspect(observation.stamp, *gravest);
  return true;
}

void SenderTrust::OnFinding(Timestamp stamp, const Finding& finding, bool may_accuse) {
  if (finding.severity == Verdict::kAccuse && may_accuse) return Revoke(stamp, finding);
  Suspect(stamp, finding);
}

bool SenderTrust::TryValidate(const ValidationEvidence& evidence, const TrustConfig& config) {
  if (state_ != TrustState::kCandidate || evidence.is_ego_gnss_suspect) return false;
  if (consistent_run_ < config.candidate_messages) return false;
  const bool is_known = released_ && ToSeconds(evidence.stamp - *released_) <= config.again_s;
  const auto has_seen = [&](int observations, double observed_s) {
    return evidence.co_observations >= observations && evidence.span_s >= observed_s;
  };
  if (!has_seen(config.co_observations, config.co_observed_s) &&
      !has_seen(config.slow_observations, config.slow_observed_s) &&
      !(is_known && has_seen(config.again_observations, config.again_observed_s))) {
    return false;
  }
  if (!evidence.is_level_plausible || !evidence.is_size_plausible) return false;
  if (!evidence.is_nis_consistent || !evidence.is_speed_consistent) return false;
  if (evidence.margin < evidence.min_margin) return false;
  if (!evidence.is_assigned || !evidence.are_sensors_sure) return false;
  state_ = TrustState::kValidated;
  return true;
}

void SenderTrust::OnSensorsLost() {
  if (state_ == TrustState::kValidated) state_ = TrustState::kBridged;
}

void SenderTrust::OnSensorsRegained() {
  if (state_ == TrustState::kBridged) state_ = TrustState::kValidated;
}

void SenderTrust::Release(Timestamp stamp) {
  if (!is_relied_on()) return;
  released_ = stamp;
  state_ = TrustState::kCandidate;
  history_ = {};
}

void SenderTrust::StartAgain(Timestamp stamp) {
  Release(stamp);
  history_ = {};
}

Penalty SenderTrust::penalty() const {
  if (!has_penalty()) return {};
  return {state_, suspicions_, accusations_, state_since_, last_finding_};
}

void SenderTrust::Inherit(const Penalty& penalty) {
  if (penalty.state == TrustState::kNone) return;
  state_ = penalty.state;
  suspicions_ = std::max(suspicions_, penalty.suspicions);
  accusations_ = std::max(accusations_, penalty.accusations);
  state_since_ = penalty.since;
  last_finding_ = penalty.last_finding;
  clean_s_ = 0.0;
  consistent_run_ = 0;
  history_ = {};
}

std::optional<SenderTrust::Judgement> SenderTrust::TakeVerdict() {
  return std::exchange(pending_, std::nullopt);
}

void SenderTrust::Suspect(Timestamp stamp, const Finding& finding) {
  last_finding_ = stamp;
  clean_s_ = 0.0;
  if (has_penalty()) return;
  state_ = TrustState::kSuspect;
  released_.reset();
  state_since_ = stamp;
  consistent_run_ = 0;
  suspicions_ = std::min(suspicions_ + 1, kMaxDoublings);
  pending_ = Judgement{Verdict::kWithdraw, finding};
}

void SenderTrust::Revoke(Timestamp stamp, const Finding& finding) {
  last_finding_ = stamp;
  clean_s_ = 0.0;
  if (state_ == TrustState::kRevoked) return;
  state_ = TrustState::kRevoked;
  released_.reset();
  state_since_ = stamp;
  consistent_run_ = 0;
  accusations_ = std::min(accusations_ + 1, kMaxDoublings);
  pending_ = Judgement{Verdict::kAccuse, finding};
}

}  // namespace v2vouch
