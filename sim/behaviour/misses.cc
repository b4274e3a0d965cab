// SPDX-License-Identifier: Apache-2.0
#include "sim/behaviour/misses.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

namespace v2vouch::evaluation {
namespace {

// Constants of track_t.
constexpr int kTrustUnknown = 1;
constexpr int kTrustSuspect = 5;
constexpr int kTrustRevoked = 6;

using Held = std::set<std::pair<std::size_t, std::size_t>>;  // Instant, object.

Held HeldBy(const ListScore& score) {
  Held held;
  for (const MatchedPair& pair : score.pairs) held.emplace(pair.instant, pair.object);
  return held;
}

const ListedTrack* Of(const ReceivedList* list, std::uint32_t sender) {
  if (list == nullptr || sender == 0) return nullptr;
  const auto at = std::ranges::find(list->tracks, sender, &ListedTrack::sender);
  return at == list->tracks.end() ? nullptr : &*at;
}

std::string LastCheck(const RunLog& log, std::uint32_t sender, Timestamp t) {
  std::string check;
  for (const VerdictReport& report : log.reports) {
    if (report.received > t) break;
    if (report.sender == sender) check = report.check;
  }
  return check;
}

}  // namespace

const char* MissReasonKey(MissReason reason) {
  switch (reason) {
    case MissReason::kElsewhere:
      return "elsewhere";
    case MissReason::kWithdrawn:
      return "withdrawn";
    case MissReason::kBridgeEnded:
      return "bridge_ended";
    case MissReason::kNeverBridged:
      return "never_bridged";
    case MissReason::kNoLocalTrack:
      return "no_local_track";
    case MissReason::kNotFollowed:
      return "not_followed";
    case MissReason::kUnknownSender:
      return "unknown_sender";
    case MissReason::kNotValidated:
      return "not_validated";
  }
  return "";
}

std::vector<Miss> ExplainMisses(const RunLog& log, const std::vector<Timestamp>& grid,
                                const Bound& bound, const ListScore& local,
                                const ListScore& priority, const ScoringSettings& settings) {
  const Held held_local = HeldBy(local);
  const Held held = HeldBy(priority);
  std::set<std::size_t> was_listed;  // Objects whose sender PRIORITY has held.
  std::map<std::tuple<std::int64_t, MissReason, std::string>, Miss> misses;
  for (const InstantScore& now : priority.series) {
    const Timestamp t = grid[now.instant];
    const auto ego = log.truth.ego.At(t);
    const ReceivedList* listed = NewestBy(log.lists[Index(ListKind::kPriority)], t);
    const ReceivedList* senders = NewestBy(log.lists[Index(ListKind::kV2v)], t);
    for (std::size_t o = 0; o < log.truth.objects.size(); ++o) {
      const TruthObject& object = log.truth.objects[o];
      const TruthSample* sample = object.motion.InForce(t);
      if (!object.is_vehicle() || !object.has_v2v || sample == nullptr || !ego) continue;
      const bool is_listed = Of(listed, sample->sender) != nullptr;
      if (is_listed) was_listed.insert(o);
      if (held.contains({now.instant, o}) ||
          !bound.At(ListKind::kPriority, o, now.instant).is_held ||
          (object.motion.At(t)->position() - ego->position()).norm() > settings.radius_m) {
        continue;
      }
      const ListedTrack* sender = Of(senders, sample->sender);
      const int trust = sender == nullptr ? 0 : sender->trust;
      MissReason reason = MissReason::kNotValidated;
      std::string check;
      if (is_listed) {
        reason = MissReason::kElsewhere;
      } else if (trust == kTrustSuspect || trust == kTrustRevoked) {
        reason = MissReason::kWithdrawn;
        check = LastCheck(log, sample->sender, t);
      } else if (sample->is_hidden) {
        reason = was_listed.contains(o) ? MissReason::kBridgeEnded : MissReason::kNeverBridged;
      } else if (!held_local.contains({now.instant, o})) {
        reason = MissReason::kNoLocalTrack;
      } else if (sender == nullptr) {
        reason = MissReason::kNotFollowed;
      } else if (trust <= kTrustUnknown) {
        reason = MissReason::kUnknownSender;
      }
      Miss& miss =
          misses.try_emplace({object.id, reason, check}, object.id, reason, check, 0.0, now.t_s)
              .first->second;
      miss.seconds += settings.period_s;
    }
  }
  std::vector<Miss> out;
  for (auto& [key, miss] : misses) out.push_back(std::move(miss));
  std::ranges::stable_sort(out, {},
                           [](const Miss& miss) { return std::pair(miss.vehicle, miss.first_s); });
  return out;
}

}  // namespace v2vouch::evaluation
