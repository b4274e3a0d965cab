// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/intake/intake.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "daemon/v2v/intake/bsm_checks.h"
#include "daemon/v2v/intake/sender_filter.h"

namespace v2vouch {
namespace {

constexpr double kTotalBurst_s = 0.2;  // Of the total rate that may come at once.
constexpr double kSweep_s = 0.5;       // Between two searches for silent senders.
// A sender heard within this time is in use: no newcomer takes its place.
constexpr double kInUse_s = 1.0;

std::size_t Remembered(const IntakeConfig& config) {
  return static_cast<std::size_t>(config.max_total_rate_hz * config.repeat_memory_s);
}

}  // namespace

BsmIntake::BsmIntake(const IntakeConfig& config)
    : config_(config),
      repeats_(Remembered(config), config.repeat_memory_s),
      total_tokens_(config.max_total_rate_hz * kTotalBurst_s),
      new_tokens_(config.max_new_senders_per_s) {
  senders_.reserve(static_cast<std::size_t>(config.max_senders));
  accounts_.reserve(static_cast<std::size_t>(config.max_senders));
  checks_.resize(static_cast<std::size_t>(config.max_senders));
  directions_.resize(checks_.size());
  accuracies_.resize(checks_.size());
  free_slots_.resize(checks_.size());
  // The lowest is handed out first.
  std::iota(free_slots_.rbegin(), free_slots_.rend(), 0U);
}

void BsmIntake::RefillTokens(Timestamp now) {
  const double since = refilled_ ? std::max(0.0, ToSeconds(now - *refilled_)) : 0.0;
  refilled_ = now;
  const double total_room = config_.max_total_rate_hz * kTotalBurst_s;
  total_tokens_ = std::min(total_room, total_tokens_ + since * config_.max_total_rate_hz);
  new_tokens_ = std::min(static_cast<double>(config_.max_new_senders_per_s),
                         new_tokens_ + since * config_.max_new_senders_per_s);
}

std::optional<Reason> BsmIntake::TakeKnown(std::size_t index, const Bsm& bsm, Claim& claim) {
  Account& account = accounts_[index];
  account.tokens =
      std::min(config_.burst, account.tokens + std::max(0.0, ToSeconds(bsm.stamp - account.last)) *
                                                   config_.max_rate_hz);
  account.last = bsm.stamp;
  if (account.tokens < 1.0) {
    ++senders_[index].over_rate;
    checks_[account.slot].OnOverRate(bsm.stamp);
    return Reason::kBsmRate;
  }
  account.tokens -= 1.0;
  claim.accuracy_is_poor |=
      accuracies_[account.slot].IsBadNow(bsm.stamp, bsm.semi_major_m, config_.max_position_sigma_m);
  const bool is_reread = directions_[account.slot].Read(bsm.transmission, claim);
  if (is_reread) checks_[account.slot].OnReread();
  if (!AdvanceSender(senders_[index], bsm, claim, is_reread)) {
    Remove(index);
    return Reason::kSenderNumerics;
  }
  return std::nullopt;
}

std::optional<Reason> BsmIntake::TakeNew(const Bsm& bsm, Claim& claim) {
  if (const auto refusal = MakeRoom(bsm.sender, bsm.stamp)) return *refusal;
  const std::size_t index = IndexOf(bsm.sender);
  const std::uint32_t slot = free_slots_.back();
  free_slots_.pop_back();
  directions_[slot] = DirectionReading{};
  directions_[slot].Read(bsm.transmission, claim);
  accuracies_[slot] = AccuracyWatch{};
  claim.accuracy_is_poor |=
      accuracies_[slot].IsBadNow(bsm.stamp, bsm.semi_major_m, config_.max_position_sigma_m);
  const auto at = static_cast<std::ptrdiff_t>(index);
  senders_.insert(senders_.begin() + at, StartSender(bsm, claim));
  checks_[slot] = SenderChecks{};
  checks_[slot].OnHeard(bsm.stamp);
  accounts_.insert(accounts_.begin() + at,
                   Account{bsm.sender, false, slot, config_.burst - 1.0, bsm.stamp});
  return std::nullopt;
}
Result<Claim> BsmIntake::Accept(const Bsm& bsm, const EgoPlace& ego) {
  if (const auto problem = ContentProblem(bsm)) {
    const std::size_t known = IndexOf(bsm.sender);
    if (*problem == Reason::kBsmImplausible && Holds(known, bsm.sender)) {
      checks_[accounts_[known].slot].OnImplausible();
    }
    return *problem;
  }
  const double age = ClaimedAge(bsm, config_);
  if (bsm.sec_mark_ms || bsm.generation) utc_.OnMessage(bsm.sender, bsm.stamp, age);
  if (age > config_.max_age_s) return Reason::kBsmStale;
  if (age < -config_.max_future_s) return Reason::kBsmFuture;
  if (config_.own_id != 0 && bsm.sender == config_.own_id) return Reason::kBsmOwnEcho;
  if (!ego.is_known) return Reason::kNoGnss;
  Claim claim = ToClaim(bsm, age, config_);
  if (IsOwnEcho(claim, ego, config_)) return Reason::kBsmOwnEcho;
  if (HorizontalDistance(ego.p_E, claim.p_E) > config_.max_distance_m) {
    return Reason::kBsmImplausible;
  }
  // Before the rates: a device that echoes a sender's messages must not spend the sender's budget.
  const RepeatMemory::Answer heard = repeats_.Look(bsm);
  if (heard.finding == RepeatMemory::Finding::kRepeat) {
    repeats_.Keep(bsm);
    return Reason::kBsmRepeat;
  }

  RefillTokens(bsm.stamp);
  const double total_room = config_.max_total_rate_hz * kTotalBurst_s;

  std::size_t index = IndexOf(bsm.sender);
  const bool is_known = Holds(index, bsm.sender);
  if (is_known) checks_[accounts_[index].slot].OnHeard(bsm.stamp);
  if (total_tokens_ < (is_known ? 1.0 : 0.5 * total_room)) return Reason::kBsmRate;
  if (const auto refusal = is_known ? TakeKnown(index, bsm, claim) : TakeNew(bsm, claim)) {
    return *refusal;
  }
  if (!is_known) index = IndexOf(bsm.sender);
  total_tokens_ -= 1.0;
  repeats_.Keep(bsm);
  if (heard.finding == RepeatMemory::Finding::kOtherSender) Contest(heard.id_tag, index);
  claim.finding = checks_[accounts_[index].slot].Judge(claim, senders_[index], config_.checks);
  return claim;
}

// Two ids with the same core: one of them copied. Both are marked.
void BsmIntake::Contest(std::uint16_t id_tag, std::size_t copy) {
  const Timestamp now = senders_[copy].latest.received;
  for (std::size_t i = 0; i < accounts_.size(); ++i) {
    if (i != copy && RepeatMemory::IdTag(accounts_[i].sender) != id_tag) continue;
    ++senders_[i].contested;
    senders_[i].last_contested = now;
    checks_[accounts_[i].slot].OnContested(now);
  }
}

std::optional<Reason> BsmIntake::MakeRoom(SenderId newcomer, Timestamp now) {
  const auto capacity = static_cast<std::size_t>(config_.max_senders);
  const bool has_knocked = knocks_.Knock(newcomer, now);
  if (new_tokens_ < 0.5 * config_.max_new_senders_per_s && !has_knocked) {
    return Reason::kBsmTableFull;
  }
  if (2 * senders_.size() >= capacity && new_tokens_ < 1.0) return Reason::kBsmTableFull;
  new_tokens_ = std::max(0.0, new_tokens_ - 1.0);
  if (senders_.size() < capacity) return std::nullopt;
  const auto stalest =
      std::min_element(accounts_.begin(), accounts_.end(), [](const Account& a, const Account& b) {
        if (a.is_pinned != b.is_pinned) return b.is_pinned;
        return a.last < b.last;
      });
  if (stalest->is_pinned ||
      ToSeconds(now - stalest->last) < std::min(kInUse_s, config_.sender_timeout_s)) {
    return Reason::kBsmTableFull;
  }
  Remove(static_cast<std::size_t>(stalest - accounts_.begin()));
  return std::nullopt;
}

void BsmIntake::Expire(Timestamp now) {
  if (swept_ && std::abs(ToSeconds(now - *swept_)) < kSweep_s) return;
  swept_ = now;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < accounts_.size(); ++i) {
    if (ToSeconds(now - accounts_[i].last) > config_.sender_timeout_s) {
      free_slots_.push_back(accounts_[i].slot);
      continue;
    }
    if (kept != i) {
      accounts_[kept] = accounts_[i];
      senders_[kept] = senders_[i];
    }
    ++kept;
  }
  accounts_.erase(accounts_.begin() + static_cast<std::ptrdiff_t>(kept), accounts_.end());
  senders_.erase(senders_.begin() + static_cast<std::ptrdiff_t>(kept), senders_.end());
}

void BsmIntake::Pin(SenderId sender, bool is_pinned) {
  const std::size_t index = IndexOf(sender);
  if (Holds(index, sender)) accounts_[index].is_pinned = is_pinned;
}

const SenderTrack* BsmIntake::Find(SenderId sender) const {
  const std::size_t index = IndexOf(sender);
  return Holds(index, sender) ? &senders_[index] : nullptr;
}

void BsmIntake::CollectNotices(std::vector<Notice>& notices) const {
  const auto behind_s = utc_.difference_s();
  if (!behind_s) return;
  const NoticeKind kind = *behind_s > 0.0 ? NoticeKind::kClockBehind : NoticeKind::kClockAhead;
  const NoticeSubject radio{NoticeSubject::Kind::kV2v, 0};
  const bool is_told = std::ranges::any_of(notices, [&](const Notice& notice) {
    return notice.kind == kind && notice.subject == radio;  // Of the time of reception.
  });
  if (!is_told) notices.push_back({kind, radio, std::abs(*behind_s)});
}

std::size_t BsmIntake::IndexOf(SenderId sender) const {
  const auto at = std::lower_bound(accounts_.begin(), accounts_.end(), sender,
                                   [](const Account& a, SenderId id) { return a.sender < id; });
  return static_cast<std::size_t>(at - accounts_.begin());
}

bool BsmIntake::Holds(std::size_t index, SenderId sender) const {
  return index < accounts_.size() && accounts_[index].sender == sender;
}

void BsmIntake::Remove(std::size_t index) {
  free_slots_.push_back(accounts_[index].slot);
  accounts_.erase(accounts_.begin() + static_cast<std::ptrdiff_t>(index));
  senders_.erase(senders_.begin() + static_cast<std::ptrdiff_t>(index));
}

}  // namespace v2vouch
