// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/timeline.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "daemon/pipeline/event_rank.h"
namespace v2vouch {
namespace {

// A message no older than this against the agreed time is not late.
constexpr double kOnTime_s = 0.1;

// Events without a checkpoint in a row, at most: where no frames come the ego's motion gets some.
constexpr std::size_t kLongestRun = 64;

// Spare events and checkpoints beyond as many as are in use.
constexpr std::size_t kFewSpares = 16;

// Late claims that may wait for the next frame, at most: frames may fail to come.
constexpr int kMostWaiting = 256;
// What one late claim may cause to be run again, in claims (some 15 us each). An older backlog
// would cost more than it brings. A frame visits every followed sender, so its cost grows with the
// number of recent claims.
constexpr std::size_t kDeepestClaim = 256;
constexpr std::size_t kDearestFrame = 16;
constexpr std::size_t kEventsPerClaim = 112;

}  // namespace

EventKey KeyOf(const TimelineInput& input) {
  return std::visit(
      Overloaded{[](const EgoMotion& m) {
                   return EventKey{m.stamp, kEgoRank, 0, m.seq};
                 },
                 [](const GnssFix& m) {
                   return EventKey{m.stamp, kGnssRank, 0, m.seq};
                 },
                 [](const RadarScan& m) {
                   return EventKey{m.stamp, kRadarRank, m.radar, m.seq};
                 },
                 [](const CameraDetections& m) {
                   return EventKey{m.stamp, kCameraRank, m.camera, m.seq};
                 },
                 [](const ObjectList& m) {
                   return EventKey{m.stamp, kObjectsRank, m.sensor, m.seq};
                 },
                 [](const TimedClaim& m) {
                   return EventKey{m.claim.received, kClaimRank, m.claim.sender, m.seq};
                 }},
      input);
}

Timeline::Timeline(const PerceptionConfig& config)
    : config_(config),
      local_(config.local()),
      priority_(config.priority, config.alignment, config.vehicle),
      before_(std::make_unique<Checkpoint>(Checkpoint{local_, priority_})) {}

std::unique_ptr<Timeline::Event> Timeline::NewEvent(TimelineInput input) {
  std::unique_ptr<Event> event;
  if (spare_events_.empty()) {
    event = std::make_unique<Event>();
  } else {
    event = std::move(spare_events_.back());
    spare_events_.pop_back();
    event->refusal.reset();
    event->has_frame = false;
    event->emitted.clear();
    event->residuals.clear();
  }
  event->key = KeyOf(input);
  event->input = std::move(input);
  if (NeedsCheckpoint(event->input)) event->after = NewCheckpoint();
  return event;
}

// A checkpoint after each frame: frames are rare and costly to re-run.
bool Timeline::NeedsCheckpoint(const TimelineInput& input) const {
  if (HasFrame(input)) return true;
  if (!std::holds_alternative<EgoMotion>(input) || events_.size() < kLongestRun) return false;
  return std::none_of(events_.end() - kLongestRun, events_.end(),
                      [](const auto& event) { return event->after != nullptr; });
}

std::unique_ptr<Timeline::Checkpoint> Timeline::NewCheckpoint() {
  ++checkpoints_;
  if (spare_checkpoints_.empty()) {
    return std::make_unique<Checkpoint>(Checkpoint{local_, priority_});
  }
  auto checkpoint = std::move(spare_checkpoints_.back());
  spare_checkpoints_.pop_back();
  checkpoint->radar.is_ready = false;
  return checkpoint;
}

void Timeline::Recycle(std::unique_ptr<Checkpoint> checkpoint) {
  --checkpoints_;
  if (spare_checkpoints_.size() < kFewSpares + checkpoints_) {
    spare_checkpoints_.push_back(std::move(checkpoint));
  }
}

// Nothing from outside moves the agreed time, so nothing from outside can push one of ours out.
std::optional<Reason> Timeline::WhyNot(const TimelineInput& input) const {
  if (!has_local_) return IsLocal(input) ? std::nullopt : std::optional(Reason::kNoEgoMotion);
  const EventKey key = KeyOf(input);
  if (key.time < *agreed_ - FromSeconds(config_.timeline.replay_buffer_s)) return Reason::kTooOld;
  // Equal time, channel and counter: counters alone may stand still or start again. Repeated BSMs
  // were caught at the intake.
  const auto place =
      std::lower_bound(events_.begin(), events_.end(), key,
                       [](const auto& event, const EventKey& k) { return event->key < k; });
  const bool is_duplicate =
      key.rank != kClaimRank && place != events_.end() && (*place)->key == key;
  return is_duplicate ? std::optional(Reason::kDuplicate) : std::nullopt;
}

// Work that was not needed is saved up for one second at most.
void Timeline::AdvanceTo(Timestamp agreed) {
  const double rate = config_.timeline.rerun_budget;
  if (!agreed_) {
    budget_ = rate;
  } else if (agreed > *agreed_) {
    budget_ = std::min(rate, budget_ + rate * std::min(1.0, ToSeconds(agreed - *agreed_)));
  }
  agreed_ = agreed_ ? std::max(*agreed_, agreed) : agreed;
}

// Whether there is work left for the frames that would have to be run again. A message that is not
// late by the agreed time is not at fault when others are ahead of it.
bool Timeline::IsAffordable(const TimelineInput& input) {
  const EventKey key = KeyOf(input);
  int frames = 0;
  for (auto event = events_.rbegin(); event != events_.rend() && (*event)->key > key; ++event) {
    frames += HasFrame((*event)->input) ? 1 : 0;
  }
  const bool is_late = key.time < *agreed_ - FromSeconds(kOnTime_s);
  if (is_late && frames > budget_) return false;
  budget_ = std::max(budget_ - frames, -config_.timeline.rerun_budget);
  return true;
}

bool Timeline::IsTooDeep(const EventKey& claim) const {
  const std::size_t per_frame = 1 + std::min(kDearestFrame, events_.size() / kEventsPerClaim);
  std::size_t cost = 0;
  for (auto event = events_.rbegin(); event != events_.rend(); ++event) {
    const bool is_before = (*event)->key <= claim;
    if (is_before && (event == events_.rbegin() || (*event)->after)) return false;
    cost += (*event)->has_frame ? per_frame : (*event)->key.rank == kEgoRank ? 0 : 1;
    if (cost > kDeepestClaim) return true;
  }
  return false;
}

std::size_t Timeline::Restart(std::size_t at) const {
  while (at > 0 && !events_[at - 1]->after) --at;
  return at;
}

const Timeline::Checkpoint& Timeline::StateAt(std::size_t at) const {
  return at > 0 ? *events_[at - 1]->after : *before_;
}

std::size_t Timeline::RestorePriority(std::size_t place, bool is_last) {
  const EventKey& key = events_[place]->key;
  std::size_t from = place;
  if (!is_last || waiting_) {
    const EventKey first = std::min(waiting_.value_or(key), key);
    from = Restart(static_cast<std::size_t>(
        std::ranges::find_if(events_, [&](const auto& event) { return event->key >= first; }) -
        events_.begin()));
    priority_ = StateAt(from).priority;
  }
  waiting_.reset();
  waiting_claims_ = 0;
  return from;
}

Timeline::Placement Timeline::Insert(TimelineInput input, Timestamp agreed, Outputs& outputs) {
  const EventKey key = KeyOf(input);
  const bool is_local = IsLocal(input);
  // What LOCAL may cost is counted by its own inputs alone.
  if (is_local) AdvanceTo(agreed);
  if (const auto reason = WhyNot(input)) {
    outputs.Refuse(*reason, key.time);
    return {.refusal = reason};
  }
  if ((is_local && !IsAffordable(input)) || (key.rank == kClaimRank && IsTooDeep(key))) {
    outputs.Refuse(Reason::kOverBudget, key.time);
    return {.refusal = Reason::kOverBudget};
  }
  has_local_ = has_local_ || is_local;

  const auto before = std::find_if(events_.rbegin(), events_.rend(),
                                   [&](const auto& event) { return event->key <= key; });
  const auto place = static_cast<std::size_t>(events_.rend() - before);
  if (place < settled_events_) ++settled_events_;
  events_.insert(events_.begin() + static_cast<std::ptrdiff_t>(place), NewEvent(std::move(input)));

  const auto later = events_.begin() + static_cast<std::ptrdiff_t>(place) + 1;
  const bool is_last = later == events_.end();
  const bool is_last_of_local =
      std::none_of(later, events_.end(), [](const auto& other) { return IsLocal(other->input); });

  // A claim or a fix cannot change LOCAL, so LOCAL is not even asked.
  Placement placement;
  if (is_local) {
    if (!is_last_of_local) local_ = StateAt(Restart(place)).local;
    placement.local_frames = RunLocal(is_last_of_local ? place : Restart(place), outputs);
  }
  if (MayWait(place, is_last)) {
    if (key.rank == kClaimRank) {
      waiting_ = std::min(waiting_.value_or(key), key);
      ++waiting_claims_;
    }
    return placement;
  }
  placement.v2v_events = RunPriority(RestorePriority(place, is_last), outputs);

  placement.has_frame = events_[place]->has_frame;
  placement.refusal = events_[place]->refusal;
  placement.is_correction =
      HasFrame(events_[place]->input) &&
      std::any_of(events_.begin() + static_cast<std::ptrdiff_t>(place) + 1, events_.end(),
                  [](const auto& other) { return other->has_frame; });
  Trim();
  return placement;
}

// The ego's motion changes nothing of the V2V side, unless it comes late or is a checkpoint. Where
// every message's verdict is asked for, it is worked out at once.
bool Timeline::MayWait(std::size_t place, bool is_last) const {
  const Event& event = *events_[place];
  if (event.key.rank == kEgoRank) return waiting_ && is_last && !event.after;
  return event.key.rank == kClaimRank && (!is_last || waiting_) && waiting_claims_ < kMostWaiting &&
         !config_.v2v.message_verdicts;
}

void Timeline::Trim() {
  const Timestamp oldest =
      agreed_.value_or(Timestamp{}) - FromSeconds(config_.timeline.replay_buffer_s);
  for (;;) {
    // Settled is all before a checkpointed event that itself lies before the buffer.
    std::size_t next = settled_events_ + 1;
    while (next < events_.size() && !events_[next]->after) ++next;
    if (next >= events_.size() || events_[next]->key.time > oldest) break;
    for (; settled_events_ < next; ++settled_events_) {
      const Event& event = *events_[settled_events_];
      settled_ = event.key.time;
      settled_residuals_.insert(settled_residuals_.end(), event.residuals.begin(),
                                event.residuals.end());
    }
  }
  std::size_t dropped = settled_events_;
  while (dropped > 0 && !events_[dropped - 1]->after) --dropped;
  for (; dropped > 0; --dropped, --settled_events_) {
    std::unique_ptr<Event> event = std::move(events_.front());
    events_.pop_front();
    if (event->after) Recycle(std::exchange(before_, std::move(event->after)));
    spare_events_.push_back(std::move(event));
  }
  if (spare_events_.size() > kFewSpares + events_.size()) {
    spare_events_.resize(kFewSpares + events_.size());
  }
}

const LocalFrame* Timeline::newest_frame() const {
  const auto found = std::find_if(events_.rbegin(), events_.rend(),
                                  [](const auto& event) { return event->has_frame; });
  return found == events_.rend() ? nullptr : &(*found)->after->frame;
}

std::vector<BiasResidual> Timeline::TakeSettled() { return std::exchange(settled_residuals_, {}); }

}  // namespace v2vouch
