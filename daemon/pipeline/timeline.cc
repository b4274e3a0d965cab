// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/timeline.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

namespace v2vouch {
namespace {

template <class... Fs>
struct Overloaded : Fs... {
  using Fs::operator()...;
};

// Rank of the kinds of source at equal times: the ego's motion first, so that a frame of the same
// instant finds it; claims last, so that they meet the newest tracks.
enum Rank { kEgoRank, kGnssRank, kRadarRank, kCameraRank, kClaimRank };

bool HasFrame(const TimelineInput& input) {
  return std::holds_alternative<RadarScan>(input) ||
         std::holds_alternative<CameraDetections>(input);
}

bool IsLocal(const TimelineInput& input) {
  return HasFrame(input) || std::holds_alternative<EgoMotion>(input);
}

std::uint64_t Hash(std::string_view text, std::uint64_t seed) {  // FNV-1a.
  std::uint64_t hash = 0xCBF29CE484222325ull ^ seed;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3ull;
  return hash;
}

// A message no older than this against the agreed time is not late.
constexpr double kOnTime_s = 0.1;

// Events without a checkpoint in a row, at most: where no frames come the ego's motion gets some.
constexpr std::size_t kLongestRun = 64;

// Late claims that may wait for the next frame, at most: frames may fail to come.
constexpr int kMostWaiting = 256;
// What one late claim may cause to be run again, in claims (some 15 us each). An older backlog
// would cost more than it brings. A frame visits every followed sender, so its cost grows with the
// number of recent claims.
constexpr std::size_t kDeepestClaim = 256;
constexpr std::size_t kDearestFrame = 16;
constexpr std::size_t kEventsPerClaim = 112;

void NameSource(const EventKey& key, Diagnostic& diagnostic) {
  constexpr InputSource kSources[] = {InputSource::kEgoMotion, InputSource::kGnss,
                                      InputSource::kRadar, InputSource::kCamera, InputSource::kBsm};
  diagnostic.source = kSources[key.rank];
  const bool is_sensor = key.rank == kRadarRank || key.rank == kCameraRank;
  diagnostic.sensor = is_sensor ? static_cast<int>(key.channel) : 0;
}

bool InsertOnce(std::vector<std::uint64_t>& set, std::uint64_t value) {
  if (std::find(set.begin(), set.end(), value) != set.end()) return false;
  set.push_back(value);
  return true;
}

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
    event->radar.is_ready = false;
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
  if (spare_checkpoints_.empty()) {
    return std::make_unique<Checkpoint>(Checkpoint{local_, priority_});
  }
  auto checkpoint = std::move(spare_checkpoints_.back());
  spare_checkpoints_.pop_back();
  return checkpoint;
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
  const auto restart = [this](std::size_t at) {  // Behind the last checkpoint before it.
    while (at > 0 && !events_[at - 1]->after) --at;
    return at;
  };
  const auto state_at = [this](std::size_t at) -> const Checkpoint& {
    return at > 0 ? *events_[at - 1]->after : *before_;
  };

  // A claim or a fix cannot change LOCAL, so LOCAL is not even asked.
  Placement placement;
  if (is_local) {
    if (!is_last_of_local) local_ = state_at(restart(place)).local;
    placement.local_frames = RunLocal(is_last_of_local ? place : restart(place), outputs);
  }
  if (MayWait(place, is_last)) {
    if (key.rank == kClaimRank) {
      waiting_ = std::min(waiting_.value_or(key), key);
      ++waiting_claims_;
    }
    return placement;
  }
  std::size_t from = place;
  if (!is_last || waiting_) {
    const EventKey first = std::min(waiting_.value_or(key), key);
    from = restart(static_cast<std::size_t>(
        std::ranges::find_if(events_, [&](const auto& event) { return event->key >= first; }) -
        events_.begin()));
    priority_ = state_at(from).priority;
  }
  waiting_.reset();
  waiting_claims_ = 0;
  placement.v2v_events = RunPriority(from, outputs);

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

int Timeline::RunLocal(std::size_t from, Outputs& outputs) {
  int frames = 0;
  for (std::size_t i = from; i < events_.size(); ++i) {
    Event& event = *events_[i];
    step_.Clear();
    const auto keep = [&](std::optional<Reason> refusal) {
      event.refusal = refusal;
      event.has_frame = !refusal;
      if (refusal) return step_.Refuse(*refusal, event.key.time);
      for (const Reason failure : local_.failures()) step_.Refuse(failure, event.key.time);
    };
    std::visit(Overloaded{[&](const EgoMotion& sample) { local_.OnEgoMotion(sample); },
                          [&](const RadarScan& scan) {
                            keep(local_.OnRadarScan(scan, event.radar, event.frame));
                          },
                          [&](const CameraDetections& boxes) {
                            keep(local_.OnCameraDetections(boxes, event.frame));
                          },
                          [](const GnssFix&) {}, [](const TimedClaim&) {}},
               event.input);
    frames += HasFrame(event.input) ? 1 : 0;
    if (event.after) event.after->local = local_;
    EmitOnce(event, step_, outputs);
  }
  return frames;
}

int Timeline::RunPriority(std::size_t from, Outputs& outputs) {
  int steps = 0;
  for (std::size_t i = from; i < events_.size(); ++i) {
    Event& event = *events_[i];
    step_.Clear();
    // The pose at an instant uses samples up to that instant only, so asking the newest odometry
    // gives what a run in order would have given.
    const auto ego = local_.odometry().StateAt(event.key.time);
    const auto refused = [&] {  // By a fix or a claim, which refuse for one reason at most.
      event.refusal.reset();
      if (!step_.diagnostics.empty()) event.refusal = step_.diagnostics.front().reason;
    };
    std::visit(Overloaded{[](const EgoMotion&) {},
                          [&](const GnssFix& fix) {
                            const auto at_fix =
                                local_.odometry().StateAt(priority_.alignment().FixTime(fix));
                            if (at_fix) {
                              priority_.OnFix(fix, *at_fix, step_);
                            } else {
                              step_.Refuse(Reason::kNoEgoMotion, event.key.time);
                            }
                            refused();
                          },
                          [&](const TimedClaim& timed) {
                            if (ego) {
                              if (timed.bias) {
                                priority_.SetBiasPrior(timed.claim.sender, *timed.bias);
                              }
                              priority_.OnClaim(timed.claim, *ego, step_);
                              newest_ = std::max(newest_, event.key.time);
                            } else {
                              step_.Refuse(Reason::kNoEgoMotion, event.key.time);
                            }
                            refused();
                          },
                          [&](const auto&) {
                            if (!event.has_frame) return;
                            priority_.OnFrame(event.frame, event.after->local.visibility(), step_);
                            newest_ = std::max(newest_, event.key.time);
                          }},
               event.input);
    event.residuals = priority_.TakeResiduals();
    steps += std::holds_alternative<EgoMotion>(event.input) ? 0 : 1;
    if (event.after) event.after->priority = priority_;
    EmitOnce(event, step_, outputs);
  }
  return steps;
}

void Timeline::EmitOnce(Event& event, const Outputs& step, Outputs& outputs) {
  for (const Diagnostic& diagnostic : step.diagnostics) {
    const auto hash = Hash(ReasonName(diagnostic.reason), 0);
    if (!InsertOnce(event.emitted, hash)) continue;
    outputs.diagnostics.push_back(diagnostic);
    NameSource(event.key, outputs.diagnostics.back());
  }
  // A late frame may move the same verdict to another moment, or let another check come first.
  const double buffer_s = config_.timeline.replay_buffer_s;
  std::erase_if(reported_, [&](const Reported& old) {
    return ToSeconds(newest_ - old.stamp) > 2.0 * buffer_s;
  });
  for (const MisbehaviorReport& report : step.reports) {
    const bool is_known = std::ranges::any_of(reported_, [&](const Reported& old) {
      return old.sender == report.sender && old.verdict == report.verdict &&
             std::abs(ToSeconds(report.stamp - old.stamp)) <= buffer_s;
    });
    if (is_known) continue;
    reported_.push_back({report.stamp, report.sender, report.verdict});
    outputs.reports.push_back(report);
  }
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
    if (event->after) spare_checkpoints_.push_back(std::exchange(before_, std::move(event->after)));
    spare_events_.push_back(std::move(event));
  }
}

const LocalFrame* Timeline::newest_frame() const {
  const auto found = std::find_if(events_.rbegin(), events_.rend(),
                                  [](const auto& event) { return event->has_frame; });
  return found == events_.rend() ? nullptr : &(*found)->frame;
}

std::vector<BiasResidual> Timeline::TakeSettled() { return std::exchange(settled_residuals_, {}); }

}  // namespace v2vouch
