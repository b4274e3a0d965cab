// SPDX-License-Identifier: Apache-2.0
#include "sim/spoofing/message_judgement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <v2vouch/track_t.hpp>

#include "daemon/common/base/angle.h"
#include "sim/spoofing/joint_view.h"

namespace v2vouch::evaluation {
namespace {

// An honest user of an id that an attacker borrows is not to be told from it within this time.
constexpr double kContested_s = 2.0;
// A silence longer than this is no time in view.
constexpr double kLongestStep_s = 0.5;

bool IsFalse(const BsmTruth& m, const Senders& senders) {
  if (!m.is_attack) return false;
  if (m.vehicle == 0 || !m.honest.p_W.allFinite() || !m.claimed.p_W.allFinite()) return true;
  if (senders.HonestUser(m.sender)) return true;
  const double off_m = (m.claimed.p_W - m.honest.p_W).norm();
  const double off_mps = std::abs(m.claimed.speed_mps - m.honest.speed_mps);
  if (off_m > Falseness::kPosition_m || off_mps > Falseness::kSpeed_mps) return true;
  if (m.age_s > Falseness::kAge_s && (off_m > Falseness::kSame_m || off_mps > Falseness::kSame_mps))
    return true;
  return std::abs(m.honest.speed_mps) > Falseness::kHeadingFrom_mps &&
         std::abs(AngleDifference(m.claimed.yaw_rad, m.honest.yaw_rad)) > Falseness::kHeading_rad;
}

// Joint-view time of one id so far.
struct Eligibility {
  Timestamp last{};
  bool was_in_view = false;
  double seen_s = 0.0;
};

}  // namespace

bool IsHardRefusal(std::string_view reason) {
  constexpr std::array<std::string_view, 6> kHarmless = {
      "", "no_gnss", "gnss_unusable", "gnss_jump", "bsm_own_echo", "bsm_unavailable"};
  return std::find(kHarmless.begin(), kHarmless.end(), reason) == kHarmless.end();
}

std::vector<JudgedMessage> JudgeMessages(const RunLog& log) {
  const Senders senders(log);
  std::map<std::pair<Timestamp, std::int64_t>, const BsmVerdict*> verdicts;
  for (const BsmVerdict& verdict : log.bsm_verdicts) {
    verdicts.emplace(std::pair(verdict.stamp, verdict.seq), &verdict);
  }
  JointView view(log);
  std::map<std::uint32_t, Eligibility> eligibility;
  std::vector<JudgedMessage> judged;
  judged.reserve(log.bsm_truths.size());
  for (std::size_t i = 0; i < log.bsm_truths.size(); ++i) {
    const BsmTruth& m = log.bsm_truths[i];
    if (log.truth.empty() || m.stamp < log.truth.begin() || m.stamp > log.truth.end()) continue;
    JudgedMessage out;
    out.truth = i;
    out.is_false = IsFalse(m, senders);
    const bool is_claim_in_view = view.Sees(m.stamp, m.claimed.p_W, m.vehicle);
    Eligibility& so_far = eligibility[m.sender];
    if (is_claim_in_view && so_far.was_in_view) {
      so_far.seen_s += std::clamp(ToSeconds(m.stamp - so_far.last), 0.0, kLongestStep_s);
    }
    so_far.last = m.stamp;
    so_far.was_in_view = is_claim_in_view;
    out.is_eligible = so_far.seen_s >= kEligibleAfter_s;
    out.is_in_view = is_claim_in_view || (out.is_eligible && m.vehicle != 0 &&
                                          view.Sees(m.stamp, m.honest.p_W, m.vehicle));
    out.is_contested = !m.is_attacker && senders.IsUnderAttack(m.sender, m.stamp, kContested_s);
    if (const auto found = verdicts.find({m.stamp, m.seq}); found != verdicts.end()) {
      const BsmVerdict& verdict = *found->second;
      out.has_verdict = true;
      out.is_mistrusted = verdict.refusal.empty() && (verdict.trust == track_t::TRUST_SUSPECT ||
                                                      verdict.trust == track_t::TRUST_REVOKED);
      out.is_positive = out.is_mistrusted || IsHardRefusal(verdict.refusal);
      out.is_relied_on =
          verdict.trust == track_t::TRUST_VALIDATED || verdict.trust == track_t::TRUST_BRIDGED;
    }
    judged.push_back(out);
  }
  return judged;
}

Senders::Senders(const RunLog& log) {
  std::map<std::int64_t, std::int64_t> original;
  for (const BsmTruth& m : log.bsm_truths) {
    is_attacker_[m.device] |= m.is_attacker;
    if (m.vehicle != 0) original.try_emplace(m.device, m.vehicle);
  }
  for (const BsmTruth& m : log.bsm_truths) {
    Use& use = uses_[m.sender];
    if (!IsAttacker(m.device)) use.honest_device = m.device;
    if (!m.is_attack) continue;
    use.attack_messages.push_back(m.stamp);
    const bool is_known =
        std::any_of(use.attacks.begin(), use.attacks.end(),
                    [&](const Attack& attack) { return attack.device == m.device; });
    if (is_known) continue;
    const auto found = original.find(m.device);
    use.attacks.push_back({m.stamp, m.device, found == original.end() ? 0 : found->second});
  }
}

const Senders::Attack* Senders::AttackUnder(std::uint32_t sender, Timestamp t) const {
  const auto found = uses_.find(sender);
  if (found == uses_.end()) return nullptr;
  const Attack* newest = nullptr;
  for (const Attack& attack : found->second.attacks) {
    if (attack.first <= t) newest = &attack;
  }
  return newest;
}

std::optional<std::int64_t> Senders::AttackerMeant(std::uint32_t sender, Timestamp t) const {
  const Attack* attack = AttackUnder(sender, t);
  if (attack == nullptr) return std::nullopt;
  if (HonestUser(sender) && !IsUnderAttack(sender, t, kLinger_s)) return std::nullopt;
  return attack->device;
}

std::optional<std::int64_t> Senders::HonestUser(std::uint32_t sender) const {
  const auto found = uses_.find(sender);
  return found == uses_.end() ? std::nullopt : found->second.honest_device;
}

bool Senders::IsAttacker(std::int64_t device) const {
  const auto found = is_attacker_.find(device);
  return found != is_attacker_.end() && found->second;
}

bool Senders::IsUnderAttack(std::uint32_t sender, Timestamp t, double seconds) const {
  const auto found = uses_.find(sender);
  if (found == uses_.end()) return false;
  const auto& messages = found->second.attack_messages;
  const auto next = std::lower_bound(messages.begin(), messages.end(), t - FromSeconds(seconds));
  return next != messages.end() && *next <= t + FromSeconds(seconds);
}

}  // namespace v2vouch::evaluation
