// SPDX-License-Identifier: Apache-2.0
// The timeline's events run through LOCAL and the V2V side, and what leaves on the way.
#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "daemon/common/base/fnv1a.h"
#include "daemon/pipeline/event_rank.h"
#include "daemon/pipeline/timeline.h"

namespace v2vouch {
namespace {

std::uint64_t Hash(std::string_view text, std::uint64_t seed) {
  Fnv1a hash(seed);
  hash.Add(text);
  return hash.value();
}

void NameSource(const EventKey& key, Diagnostic& diagnostic) {
  constexpr InputSource kSources[] = {InputSource::kEgoMotion, InputSource::kGnss,
                                      InputSource::kRadar,     InputSource::kCamera,
                                      InputSource::kObjects,   InputSource::kBsm};
  diagnostic.source = kSources[key.rank];
  const bool is_sensor =
      key.rank == kRadarRank || key.rank == kCameraRank || key.rank == kObjectsRank;
  diagnostic.sensor = is_sensor ? static_cast<int>(key.channel) : 0;
}

bool InsertOnce(std::vector<std::uint64_t>& set, std::uint64_t value) {
  if (std::find(set.begin(), set.end(), value) != set.end()) return false;
  set.push_back(value);
  return true;
}

}  // namespace

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
                            keep(local_.OnRadarScan(scan, event.after->radar, event.after->frame));
                          },
                          [&](const CameraDetections& boxes) {
                            keep(local_.OnCameraDetections(boxes, event.after->frame));
                          },
                          [&](const ObjectList& list) {
                            keep(local_.OnObjectList(list, event.after->frame));
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
                            priority_.OnFrame(event.after->frame, event.after->local.visibility(),
                                              step_);
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

}  // namespace v2vouch
