// SPDX-License-Identifier: Apache-2.0
#include "daemon/warnings/warner.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "daemon/common/base/angle.h"
#include "daemon/warnings/merge_lists.h"
#include "daemon/warnings/placement.h"

namespace v2vouch::warnings {
namespace {

constexpr std::size_t Index(Level level) { return static_cast<std::size_t>(level) - 1; }

// Of warnings, targets and their pasts: by either list's id.
template <class A, class B>
bool IsSameVehicle(const A& a, const B& b) {
  return (a.track_id != 0 && a.track_id == b.track_id) ||
         (a.local_id != 0 && a.local_id == b.local_id);
}

// The best state of a sector that holds this bearing out to this range.
SectorState WatchedAt(const std::vector<SectorHealth>& sectors, double bearing_rad,
                      double range_m) {
  SectorState best = SectorState::kBlind;
  for (const SectorHealth& sector : sectors) {
    const auto turned = [](double angle) {
      const double wrapped = WrapAngle(angle);
      return wrapped < 0.0 ? wrapped + 2.0 * kPi : wrapped;
    };
    const double span_rad = turned(sector.to_rad - sector.from_rad);
    const bool is_round = span_rad < 1e-6;
    if (!is_round && turned(bearing_rad - sector.from_rad) > span_rad) continue;
    if (sector.range_m < range_m) continue;
    best = std::min(best, sector.state);
  }
  return best;
}

int Rank(Level level) { return level == Level::kLost ? 0 : static_cast<int>(level); }

// The higher level first, then the sooner conflict.
bool IsMoreUrgent(const Warning& a, const Warning& b) {
  const auto time = [](const Warning& w) {
    return std::isnan(w.figures.time_to_conflict_s) ? 1e9 : w.figures.time_to_conflict_s;
  };
  return std::pair(-Rank(a.level), time(a)) < std::pair(-Rank(b.level), time(b));
}

}  // namespace

const char* KindName(Kind kind) {
  constexpr std::array<const char*, 7> kNames = {"", "FCW", "EEBL", "IMA", "LTA", "BSW", "LCW"};
  return kNames[static_cast<std::size_t>(kind)];
}

const char* LevelName(Level level) {
  constexpr std::array<const char*, 5> kNames = {"INFO", "ADVISE", "WARN", "URGENT", "LOST"};
  return kNames[static_cast<std::size_t>(level)];
}

void Warner::OnEgo(const EgoReading& ego) {
  constexpr double kSmooth_s = 0.2;
  constexpr double kOffsetShare = 0.3;  // Of a sample's sigma: what averaging does not take away.
  EgoReading next = ego;
  const double dt_s = ego_ ? ToSeconds(ego.stamp - ego_->stamp) : 0.0;
  const double change = ego_ ? ego.yaw_rate_radps - ego_->yaw_rate_radps : 0.0;
  if (dt_s > 0.0 && dt_s <= config_.stale_s && std::abs(change) <= 3.0 * ego.yaw_rate_sigma_radps) {
    const double share = 1.0 - std::exp(-dt_s / kSmooth_s);
    next.yaw_rate_radps = ego_->yaw_rate_radps + share * change;
    const double sigma =
        std::hypot((1.0 - share) * ego_->yaw_rate_sigma_radps, share * ego.yaw_rate_sigma_radps);
    next.yaw_rate_sigma_radps = std::max(sigma, kOffsetShare * ego.yaw_rate_sigma_radps);
  }
  ego_ = next;
}

std::optional<WarningList> Warner::OnLocal(const TargetList& list) {
  local_ = list;
  if (!list.is_stale) last_fresh_ = std::max(last_fresh_, list.stamp);
  if (!waits_since_ || list.stamp + FromSeconds(config_.stale_s) < *waits_since_) {
    waits_since_ = list.stamp;
  }
  if (list.stamp - *waits_since_ <= FromSeconds(config_.stale_s)) return std::nullopt;
  return Make();
}

std::optional<WarningList> Warner::OnPriority(const TargetList& list) {
  priority_ = list;
  waits_since_ = list.stamp;
  if (!list.is_stale) last_fresh_ = std::max(last_fresh_, list.stamp);
  return Make();
}

std::int32_t Warner::Availability(const TargetList& newest, std::int32_t& degraded) const {
  std::int32_t available = kAllKinds;
  const auto& sectors = local_ && !local_->sectors.empty() ? local_->sectors : newest.sectors;
  const auto is_blind = [&](double bearing_deg, double range_m) {
    return WatchedAt(sectors, FromDegrees(bearing_deg), range_m) == SectorState::kBlind;
  };
  const auto drop = [&](std::int32_t kinds) {
    available &= ~kinds;
    degraded |= kSectorsMissing;
  };
  if (is_blind(0.0, 40.0)) drop(Bit(Kind::kFcw) | Bit(Kind::kEebl) | Bit(Kind::kLta));
  if (is_blind(40.0, 20.0) || is_blind(-40.0, 20.0)) drop(Bit(Kind::kIma));
  // "Free" beside or behind needs sensors that cover these sectors.
  const auto is_watched = [&](double bearing_deg) {
    return WatchedAt(sectors, FromDegrees(bearing_deg), 5.0) == SectorState::kWatched;
  };
  const bool has_beside = is_watched(90.0) && is_watched(-90.0);
  if (!has_beside || !is_watched(150.0) || !is_watched(-150.0)) {
    drop(Bit(Kind::kBsw) | Bit(Kind::kLcw));
  }
  return available;
}

void Warner::StartAnew(const TargetList& newest) {
  const Duration stale = FromSeconds(config_.stale_s);
  entries_.clear();
  pasts_.clear();
  last_fresh_ = newest.is_stale ? Timestamp{} : newest.stamp;
  if (local_ && local_->stamp > newest.stamp + stale) local_.reset();
  if (priority_ && priority_->stamp > newest.stamp + stale) priority_.reset();
}

WarningList Warner::Make() {
  const TargetList& newest =
      priority_ && (!local_ || priority_->stamp >= local_->stamp) ? *priority_ : *local_;
  const Timestamp now = newest.stamp;
  const Duration stale = FromSeconds(config_.stale_s);
  // Time steps back only where the daemon started anew.
  if (now + stale < last_now_) StartAnew(newest);
  last_now_ = now;

  WarningList out;
  out.stamp = now;
  out.seq = seq_++;
  const bool has_local = local_ && now - local_->stamp <= stale;
  const bool has_priority = priority_ && now - priority_->stamp <= stale;
  if (has_local) out.local_seq = local_->seq;
  if (has_priority) out.priority_seq = priority_->seq;
  const auto age = [now](Timestamp t) { return now > t ? now - t : t - now; };
  const bool has_ego = ego_ && age(ego_->stamp) <= stale;
  const bool has_intent = intent_ && age(intent_->stamp) <= FromSeconds(config_.intent_s);
  if (!has_priority) out.degraded |= kNoPriority;
  if (has_priority && priority_->is_gnss_suspect) out.degraded |= kGnssSuspect;
  if (!has_ego) out.degraded |= kNoEgo;
  if (!has_intent) out.degraded |= kNoIntent;
  const bool is_stale = now - last_fresh_ > stale;
  if (is_stale) out.degraded |= kListsStale;
  const std::int32_t watched = Availability(newest, out.degraded);
  out.available_kinds = is_stale || !has_ego ? 0 : watched;

  for (Entry& entry : entries_) entry.is_present = entry.is_listed = false;
  if (out.available_kinds != 0) {
    Scene scene;
    scene.now = now;
    scene.ego = *ego_;
    if (has_intent) scene.intent = intent_;
    scene.ego_p_O = newest.ego_p_O;
    scene.ego_yaw_O = newest.ego_yaw_O;
    scene.targets =
        MergeLists(has_local ? &*local_ : nullptr, has_priority ? &*priority_ : nullptr, now);
    NoteSpeeds(scene.targets, now);
    for (const Target& target : scene.targets) Follow(target, scene);
    Take(Assess(scene, body_, config_), now);
  }
  EndEntries(now);
  for (const Entry& entry : entries_) {
    if (entry.is_shown) out.warnings.push_back(entry.shown);
  }
  std::ranges::stable_sort(out.warnings, IsMoreUrgent);
  return out;
}

// What is held goes with its vehicle, and one vehicle has one warning of a kind, also where it was
// in two lists unconnected until now.
void Warner::Follow(const Target& target, const Scene& scene) {
  const auto is_its = [&target](const Entry& entry) { return IsSameVehicle(entry.shown, target); };
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (!is_its(entries_[i])) continue;
    for (std::size_t j = entries_.size(); j-- > i + 1;) {
      if (entries_[j].shown.kind != entries_[i].shown.kind || !is_its(entries_[j])) continue;
      Join(entries_[j], entries_[i]);
      entries_.erase(entries_.begin() + static_cast<std::ptrdiff_t>(j));
    }
    Entry& entry = entries_[i];
    entry.is_listed = true;
    Warning& shown = entry.shown;
    if (target.track_id != 0) shown.track_id = target.track_id;
    if (target.local_id != 0) shown.local_id = target.local_id;
    shown.source = target.source;
    shown.visibility = target.visibility;
    const StateVector now = InBody(target, scene.ego_p_O, scene.ego_yaw_O).mean;
    shown.figures.position_B = now.head<2>();
    shown.figures.speed_mps = now[kSpeed];
  }
}

void Warner::Join(const Entry& other, Entry& entry) {
  const Timestamp since = std::min(entry.shown.since, other.shown.since);
  std::array<Timestamp, kLevels> last_true = entry.last_true;
  for (std::size_t i = 0; i < kLevels; ++i) {
    last_true[i] = std::max(last_true[i], other.last_true[i]);
  }
  const auto rank = [](const Entry& each) {
    return each.is_shown ? 1 + Rank(each.shown.level) : 0;
  };
  if (rank(other) > rank(entry)) entry = other;
  entry.shown.since = since;
  entry.last_true = last_true;
}

void Warner::EndEntries(Timestamp now) {
  for (Entry& entry : entries_) EndOrHold(entry, now);
  std::erase_if(entries_, [now, this](const Entry& entry) {
    return !entry.is_shown && !entry.is_present &&
           now - entry.last_true[0] > FromSeconds(config_.clear_s);
  });
}

void Warner::NoteSpeeds(std::vector<Target>& targets, Timestamp now) {
  const Duration window = FromSeconds(config_.sudden_s);
  std::vector<Past> pasts;
  pasts.reserve(targets.size());
  for (Target& target : targets) {
    const auto known = std::ranges::find_if(
        pasts_, [&target](const Past& past) { return IsSameVehicle(past, target); });
    Past past = known != pasts_.end() ? std::move(*known) : Past{.first = now};
    if (known != pasts_.end()) *known = {};
    past.track_id = target.track_id;
    past.local_id = target.local_id;
    std::erase_if(past.speeds, [&](const auto& each) { return now - each.first > window; });
    const double speed = std::abs(target.state_O.mean[kSpeed]);
    if (now - past.first >= window) {
      target.is_sudden = std::ranges::any_of(past.speeds, [&](const auto& each) {
        return speed > each.second + 1.5 + config_.sudden_accel_mps2 * ToSeconds(now - each.first);
      });
    }
    past.speeds.emplace_back(now, speed);
    pasts.push_back(std::move(past));
  }
  pasts_ = std::move(pasts);
}

Warner::Entry& Warner::EntryOf(const Warning& warning, Timestamp now) {
  for (Entry& entry : entries_) {
    if (entry.shown.kind == warning.kind && IsSameVehicle(entry.shown, warning)) return entry;
  }
  Entry& entry = entries_.emplace_back();
  entry.shown = warning;
  entry.shown.since = now;
  return entry;
}

void Warner::Take(const std::vector<Assessment>& found, Timestamp now) {
  for (const Assessment& each : found) {
    Entry& entry = EntryOf(each.warning, now);
    const bool is_urgent = entry.is_shown && entry.shown.level == Level::kUrgent;
    // A doubt about existence does not end what is already being braked for.
    const Level level = is_urgent ? each.level_if_sure : each.warning.level;
    const Level shown = entry.shown.level;
    const Timestamp since = entry.shown.since;
    entry.shown = each.warning;
    entry.shown.level = entry.is_shown ? shown : level;
    entry.shown.since = since;
    entry.is_present = entry.is_listed = true;
    Advance(entry, level, now);
  }
}

void Warner::Advance(Entry& entry, Level level, Timestamp now) {
  const double begin_s = entry.shown.kind == Kind::kEebl ? config_.braking_hold_s : config_.begin_s;
  const bool by_lists = entry.shown.kind != Kind::kEebl;
  for (const Level each : {Level::kAdvise, Level::kWarn, Level::kUrgent}) {
    const std::size_t i = Index(each);
    if (level < each) {
      entry.lists[i] = 0;
      continue;
    }
    if (entry.lists[i]++ == 0) entry.true_since[i] = now;
    entry.last_true[i] = now;
    const bool has_begun =
        (by_lists && entry.lists[i] >= 2) || now - entry.true_since[i] >= FromSeconds(begin_s);
    if (!has_begun) continue;
    const bool is_raise =
        !entry.is_shown || entry.shown.level < each || entry.shown.level == Level::kLost;
    if (!is_raise) continue;
    if (!entry.is_shown) entry.shown.since = now;
    entry.is_shown = true;
    entry.shown.level = each;
    entry.raised = now;
  }
  if (entry.is_shown && level < entry.shown.level) entry.shown.basis = Basis::kHeld;
}

void Warner::EndOrHold(Entry& entry, Timestamp now) {
  if (!entry.is_present) entry.lists.fill(0);
  if (!entry.is_shown) return;
  if (entry.shown.level == Level::kLost) {
    if (now >= entry.lost_until) entry.is_shown = false;
    return;
  }
  // Its vehicle was hidden and is in no list any more: not over, but no longer known.
  if (!entry.is_listed && entry.shown.visibility != Visibility::kVisible) {
    entry.shown.level = Level::kLost;
    entry.shown.basis = Basis::kEnded;
    entry.lost_until = now + FromSeconds(config_.lost_s);
    return;
  }
  if (!entry.is_present) entry.shown.basis = Basis::kHeld;
  const Duration clear = FromSeconds(config_.clear_s);
  if (now - entry.last_true[Index(entry.shown.level)] < clear ||
      now - entry.raised < FromSeconds(config_.shortest_s)) {
    return;
  }
  for (const Level each : {Level::kWarn, Level::kAdvise}) {
    if (each >= entry.shown.level || now - entry.last_true[Index(each)] >= clear) continue;
    entry.shown.level = each;
    return;
  }
  entry.is_shown = false;
}

WarningList Warner::Silence() {
  WarningList out;
  out.stamp = last_now_;
  out.seq = seq_++;
  out.degraded = kListsStale | kNoPriority;
  return out;
}

}  // namespace v2vouch::warnings
