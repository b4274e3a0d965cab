// SPDX-License-Identifier: Apache-2.0
// Who is followed, where more senders speak than there is room for.
#include <algorithm>
#include <utility>

#include "daemon/pipeline/priority_perception.h"

namespace v2vouch {
namespace {

constexpr double kTurns_s = 0.5;  // So many seconds' turns may be saved up.

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

std::vector<TrustMemory> PriorityPerception::TrustToKeep(Timestamp now) const {
  std::vector<TrustMemory> kept = restored_.Left(now);
  for (const Tombstones::Stone& stone : tombstones_.stones()) {
    if (!IsPenalty(stone.penalty.state) || FindLink(stone.sender) != nullptr) continue;
    kept.push_back(ToMemory(stone.sender, stone.certificate, stone.penalty, now));
  }
  for (const Link& link : links_) {
    if (link.trust.has_penalty()) {
      kept.push_back(ToMemory(link.sender, link.certificate, link.trust.penalty(), now));
      continue;
    }
    const auto until = link.trust.is_relied_on() ? std::optional(now) : link.trust.released();
    if (!until) continue;
    kept.push_back({.sender = link.sender,
                    .certificate = link.certificate,
                    .state = TrustState::kCandidate,
                    .since_s = ToSeconds(now - *until)});
  }
  std::erase_if(kept, [&](const TrustMemory& memory) {
    return !IsPenalty(memory.state) && memory.since_s > settings_->priority.trust.again_s;
  });
  return BoundedTrust(std::move(kept));
}

PriorityPerception::Link* PriorityPerception::FollowSender(const Claim& claim,
                                                           const ClaimInOdometry& here,
                                                           const EgoState& ego) {
  const PriorityConfig& config = settings_->priority;
  Link* link = FindLink(claim.sender);
  if (link == nullptr) {
    const auto is_near = [&](const Eigen::Vector2d& p_O) {
      return (p_O - here.p_O).squaredNorm() < config.interest_m * config.interest_m;
    };
    const double distance_m = (ego.X_OB.origin().vector() - here.p_O).norm();
    const bool is_of_interest =
        distance_m < config.trust.place.max_distance_m ||
        std::ranges::any_of(
            sensed_,
            [&](const Sensed& sensed) { return is_near(sensed.track.state_O.mean.head<2>()); }) ||
        std::ranges::any_of(vehicles_, [&](const PriorityVehicle& vehicle) {
          return is_near(vehicle.filter.mean().head<2>());
        });
    if (!is_of_interest) return nullptr;
    const bool is_full = links_.size() >= static_cast<std::size_t>(config.max_senders);
    if (is_full && !TakeTurn(here.stamp)) return nullptr;
    const Tombstones::Stone* own = tombstones_.Find(claim.sender);
    std::optional<Tombstones::Stone> stone;
    if (own != nullptr) {
      stone = *own;
    } else {
      stone = tombstones_.TakeFor(claim.sender, claim.certificate, claim.first_heard, here.stamp,
                                  here.p_O, here.velocity_O(), config.trust.tombstone);
    }
    const bool is_penalised = stone && stone->penalty.state != TrustState::kNone;
    if (is_full && !MakeRoom(is_penalised)) return nullptr;
    const auto at = std::ranges::lower_bound(links_, claim.sender, {}, &Link::sender);
    link = &*links_.insert(at, Link{});
    link->sender = claim.sender;
    link->last = here;
    if (stone) {
      link->trust.Inherit(stone->penalty);
      link->place = stone->place;
    } else if (const auto memory = restored_.TakeFor(claim.sender, claim.certificate, here.stamp)) {
      Recall(*memory, here.stamp, link->trust);
    }
  }
  link->length_m = claim.length_m;
  link->width_m = claim.width_m;
  link->certificate = claim.certificate;
  return link;
}

// Where more senders speak near by than can be followed, each keeps its place long enough to be
// judged: were everyone let in at once, nobody's second message would find the first's record.
bool PriorityPerception::TakeTurn(Timestamp now) {
  const double rate_hz = settings_->priority.turnover_hz;
  if (turns_refilled_) {
    const double since_s = std::max(0.0, ToSeconds(now - *turns_refilled_));
    turns_ = std::min(kTurns_s * rate_hz, turns_ + since_s * rate_hz);
  } else {
    turns_ = kTurns_s * rate_hz;
  }
  turns_refilled_ = now;
  if (turns_ < 1.0) return false;
  turns_ -= 1.0;
  return true;
}

// Room is made by whom the least is lost with: the penalised, whose stones remember them, then
// strangers away from all tracks, then other strangers; among equals whoever was not heard for
// longest. Nobody with a vehicle is given up, so that no flood of identities drives them out.
bool PriorityPerception::MakeRoom(bool for_penalised) {
  const auto rank = [&](const Link& link) {
    if (link.trust.has_penalty()) return 0;
    return pairs_.AssignedTo(link.sender) == nullptr ? 1 : 2;
  };
  auto least = links_.end();
  int least_rank = 0;
  for (auto link = links_.begin(); link != links_.end(); ++link) {
    if (VehicleOf(link->sender) != nullptr) continue;
    const int link_rank = rank(*link);
    if (for_penalised && link_rank > 0) continue;
    if (least == links_.end() ||
        std::pair(link_rank, link->last.stamp) < std::pair(least_rank, least->last.stamp)) {
      least = link;
      least_rank = link_rank;
    }
  }
  if (least == links_.end()) return false;
  pairs_.DropSender(least->sender);
  pairs_apart_.DropSender(least->sender);
  links_.erase(least);
  return true;
}

}  // namespace v2vouch
