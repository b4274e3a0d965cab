// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/senders/sender_table.h"

#include <algorithm>

namespace v2vouch {
namespace {

constexpr double kBucket_s = 0.5;  // So many seconds' tokens may be saved up.

bool IsPenalty(TrustState state) {
  return state == TrustState::kSuspect || state == TrustState::kRevoked;
}

void Recall(const TrustMemory& memory, Timestamp now, SenderTrust& trust) {
  const Timestamp since = now - FromSeconds(memory.since_s);
  if (IsPenalty(memory.state)) {
    trust.Inherit({memory.state, memory.suspicions, memory.accusations, since,
                   now - FromSeconds(memory.finding_s)});
  } else {
    trust.InheritRelease(since);
  }
}

TrustMemory ToMemory(SenderId sender, const CertificateDigest& certificate, const Penalty& penalty,
                     Timestamp now) {
  return {sender,
          certificate,
          penalty.state,
          penalty.suspicions,
          penalty.accusations,
          ToSeconds(now - penalty.since),
          ToSeconds(now - penalty.last_finding)};
}

}  // namespace

const SenderRecord* SenderTable::Find(SenderId sender) const {
  const auto at = std::ranges::lower_bound(records_, sender, {}, &SenderRecord::sender);
  return at != records_.end() && at->sender == sender ? &*at : nullptr;
}

SenderRecord* SenderTable::Find(SenderId sender) {
  return const_cast<SenderRecord*>(std::as_const(*this).Find(sender));
}

SenderTable::Admission SenderTable::Admit(const Claim& claim, const ClaimInOdometry& here,
                                          const SenderLimits& limits,
                                          const TombstoneConfig& tombstones,
                                          const std::function<SenderHolds(SenderId)>& holds) {
  Admission admission;
  const bool is_full = records_.size() >= limits.most;
  if (is_full && !TakeToken(here.stamp, limits.turnover_hz)) return admission;
  const Tombstones::Stone* own = tombstones_.Find(claim.sender);
  std::optional<Tombstones::Stone> stone;
  if (own != nullptr) {
    stone = *own;
  } else {
    stone = tombstones_.TakeFor(claim.sender, claim.certificate, claim.first_heard, here.stamp,
                                here.p_O, here.velocity_O(), tombstones);
  }
  if (is_full) {
    const bool is_penalised = stone && stone->penalty.state != TrustState::kNone;
    const auto least = LeastLost(is_penalised, holds);
    if (least == records_.end()) {
      // The tombstone waits for the newcomer's next message: no room washes no penalty off.
      if (stone) tombstones_.Set(*stone);
      return admission;
    }
    admission.evicted = least->sender;
    records_.erase(least);
  }
  const auto at = std::ranges::lower_bound(records_, claim.sender, {}, &SenderRecord::sender);
  SenderRecord& record = *records_.insert(at, SenderRecord{});
  record.sender = claim.sender;
  record.last = here;
  if (stone) {
    record.trust.Inherit(stone->penalty);
    record.place = stone->place;
  } else if (const auto memory = restored_.TakeFor(claim.sender, claim.certificate, here.stamp)) {
    Recall(*memory, here.stamp, record.trust);
  }
  admission.record = &record;
  return admission;
}

bool SenderTable::TakeToken(Timestamp now, double rate_hz) {
  if (refilled_) {
    const double since_s = std::max(0.0, ToSeconds(now - *refilled_));
    tokens_ = std::min(kBucket_s * rate_hz, tokens_ + since_s * rate_hz);
  } else {
    tokens_ = kBucket_s * rate_hz;
  }
  refilled_ = now;
  if (tokens_ < 1.0) return false;
  tokens_ -= 1.0;
  return true;
}

std::vector<SenderRecord>::iterator SenderTable::LeastLost(
    bool for_penalised, const std::function<SenderHolds(SenderId)>& holds) {
  auto least = records_.end();
  int least_rank = 0;
  for (auto record = records_.begin(); record != records_.end(); ++record) {
    const SenderHolds held = holds(record->sender);
    if (held == SenderHolds::kVehicle) continue;
    const int rank = record->trust.has_penalty() ? 0 : held == SenderHolds::kNothing ? 1 : 2;
    if (for_penalised && rank > 0) continue;
    if (least == records_.end() ||
        std::pair(rank, record->last.stamp) < std::pair(least_rank, least->last.stamp)) {
      least = record;
      least_rank = rank;
    }
  }
  return least;
}

void SenderTable::Remove(SenderId sender) {
  std::erase_if(records_, [&](const SenderRecord& record) { return record.sender == sender; });
}

void SenderTable::DropSilent(Timestamp now, double contact_s,
                             const std::function<SenderHolds(SenderId)>& holds) {
  std::erase_if(records_, [&](const SenderRecord& record) {
    return ToSeconds(now - record.last.stamp) > contact_s &&
           holds(record.sender) != SenderHolds::kVehicle;
  });
}

void SenderTable::UpdateTombstone(const SenderRecord& record) {
  if (!record.trust.has_penalty() && !record.place.has_doubt()) {
    return tombstones_.Remove(record.sender);
  }
  tombstones_.Set({.sender = record.sender,
                   .certificate = record.certificate,
                   .last = record.last.stamp,
                   .p_O = record.last.p_O,
                   .v_O = record.last.velocity_O(),
                   .penalty = record.trust.penalty(),
                   .place = record.place});
}

TrustState SenderTable::TrustOf(SenderId sender) const {
  if (const SenderRecord* record = Find(sender)) return record->trust.state();
  const Tombstones::Stone* stone = tombstones_.Find(sender);
  const bool has_penalty = stone != nullptr && stone->penalty.state != TrustState::kNone;
  if (has_penalty) return stone->penalty.state;
  const TrustState restored = restored_.StateOf(sender);
  return IsPenalty(restored) ? restored : TrustState::kUnknown;
}

std::vector<TrustMemory> SenderTable::TrustToKeep(Timestamp now, double again_s) const {
  std::vector<TrustMemory> kept = restored_.Left(now);
  for (const Tombstones::Stone& stone : tombstones_.stones()) {
    if (!IsPenalty(stone.penalty.state) || Find(stone.sender) != nullptr) continue;
    kept.push_back(ToMemory(stone.sender, stone.certificate, stone.penalty, now));
  }
  for (const SenderRecord& record : records_) {
    if (record.trust.has_penalty()) {
      kept.push_back(ToMemory(record.sender, record.certificate, record.trust.penalty(), now));
      continue;
    }
    const auto until = record.trust.is_relied_on() ? std::optional(now) : record.trust.released();
    if (!until) continue;
    kept.push_back({.sender = record.sender,
                    .certificate = record.certificate,
                    .state = TrustState::kCandidate,
                    .since_s = ToSeconds(now - *until)});
  }
  std::erase_if(kept, [&](const TrustMemory& memory) {
    return !IsPenalty(memory.state) && memory.since_s > again_s;
  });
  return BoundedTrust(std::move(kept));
}

}  // namespace v2vouch
