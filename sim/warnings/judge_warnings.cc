// SPDX-License-Identifier: Apache-2.0
#include "sim/warnings/judge_warnings.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace v2vouch::evaluation {
namespace {

using warnings::Kind;
using warnings::Level;

constexpr double kGate_m = 2.5;  // From a true body to the place that is warned of.
constexpr double kSameTime_s = 0.5;
constexpr double kLate_s = 0.3;
const Duration kMerge{500'000};  // Shorter pauses do not end an episode.

// The three kinds of one engine are one group: which of them a turn is called may differ.
int GroupOf(Kind kind) {
  return kind == Kind::kFcw || kind == Kind::kIma || kind == Kind::kLta ? 0
                                                                        : static_cast<int>(kind);
}

struct Episode {
  Kind kind = Kind::kFcw;
  std::int64_t object = 0;  // TruthObject::id; 0 = there is no such vehicle.
  Timestamp from{};
  Timestamp to{};
  bool is_urgent = false;
  bool is_unseen = false;  // Of PRIORITY alone when it became urgent.
  bool is_by_lie = false;  // A liar feeds its track, and LOCAL alone did not say it.
  bool is_urgent_by_lie = false;
};

// What LOCAL alone says of its tracks: (id, time) of WARN and above, and of URGENT.
class LocalSays {
 public:
  explicit LocalSays(const std::vector<SaidWarnings>& said) {
    for (const SaidWarnings& each : said) {
      for (const warnings::Warning& warning : each.list.warnings) {
        if (warning.level == Level::kLost || warning.level < Level::kWarn) continue;
        times_[{warning.local_id, Level::kWarn}].push_back(each.at);
        if (warning.level < Level::kUrgent) continue;
        times_[{warning.local_id, Level::kUrgent}].push_back(each.at);
      }
    }
  }
  // Within the time in which two warnings count as the same.
  [[nodiscard]] bool Of(const warnings::Warning& warning, Timestamp at) const {
    const auto found = times_.find({warning.local_id, warning.level});
    if (warning.local_id == 0 || found == times_.end()) return false;
    const Duration slack = FromSeconds(kSameTime_s);
    const auto next = std::ranges::lower_bound(found->second, at - slack);
    return next != found->second.end() && *next <= at + slack;
  }

 private:
  std::map<std::pair<std::int64_t, Level>, std::vector<Timestamp>> times_;
};

// The true vehicle next to a place of the ego's body frame at `t`.
std::int64_t ObjectAt(const Truth& truth, Timestamp t, const Eigen::Vector2d& p_B) {
  const auto ego = truth.ego.At(std::min(t, truth.end()));
  if (!ego) return 0;
  const Eigen::Vector2d along = ego->direction();
  const Eigen::Vector2d left(-along.y(), along.x());
  const Eigen::Vector2d p = ego->position() + p_B.x() * along + p_B.y() * left;
  double best_m = kGate_m;
  std::int64_t best = 0;
  for (const TruthObject& object : truth.objects) {
    const auto motion = object.motion.At(std::min(t, truth.end()));
    if (!motion) continue;
    const Eigen::Vector2d off = p - motion->position();
    const Eigen::Vector2d d = motion->direction();
    const double dx = std::max(0.0, std::abs(off.dot(d)) - 0.5 * object.length_m);
    const double dy =
        std::max(0.0, std::abs(off.x() * d.y() - off.y() * d.x()) - 0.5 * object.width_m);
    if (std::hypot(dx, dy) >= best_m) continue;
    best_m = std::hypot(dx, dy);
    best = object.id;
  }
  return best;
}

bool IsActive(Level level, Level least) { return level != Level::kLost && level >= least; }

std::vector<Episode> Episodes(const std::vector<SaidWarnings>& said, Timestamp end,
                              const Truth& truth, bool is_truth, Level least,
                              const LocalSays* local = nullptr) {
  std::vector<Episode> episodes;
  for (const SaidWarnings& each : said) {
    if (each.at > end) break;
    for (std::size_t i = 0; i < each.list.warnings.size(); ++i) {
      const warnings::Warning& warning = each.list.warnings[i];
      if (!IsActive(warning.level, least)) continue;
      const std::int64_t object =
          is_truth ? warning.local_id + (warning.local_id == 0 ? warning.track_id : 0)
                   : ObjectAt(truth, each.list.stamp, warning.figures.position_B);
      const bool is_urgent = warning.level == Level::kUrgent;
      const bool is_unseen = warning.source == warnings::Source::kPriority;
      const bool is_by_lie = i < each.is_of_liar.size() && each.is_of_liar[i] &&
                             !(local != nullptr && local->Of(warning, each.at));
      const auto known = std::find_if(episodes.rbegin(), episodes.rend(), [&](const Episode& e) {
        return GroupOf(e.kind) == GroupOf(warning.kind) && e.object == object &&
               each.at - e.to <= kMerge;
      });
      if (known == episodes.rend()) {
        episodes.push_back({warning.kind, object, each.at, each.at, is_urgent,
                            is_urgent && is_unseen, is_by_lie, is_urgent && is_by_lie});
        continue;
      }
      known->to = each.at;
      if (is_urgent && !known->is_urgent) known->is_unseen = is_unseen;
      known->is_urgent = known->is_urgent || is_urgent;
      known->is_by_lie = known->is_by_lie || is_by_lie;
      known->is_urgent_by_lie = known->is_urgent_by_lie || (is_urgent && is_by_lie);
    }
  }
  return episodes;
}

bool AreTogether(const Episode& a, const Episode& b) {
  const Duration slack = FromSeconds(kSameTime_s);
  return a.object == b.object && a.object != 0 && GroupOf(a.kind) == GroupOf(b.kind) &&
         a.from <= b.to + slack && b.from <= a.to + slack;
}

// When a vehicle had been in sight for 0.3 s for the first time.
Timestamp InSight(const Truth& truth, std::int64_t id) {
  for (const TruthObject& object : truth.objects) {
    if (object.id != id) continue;
    std::optional<Timestamp> since;
    for (const TruthSample& sample : object.motion.samples()) {
      if (sample.is_hidden) {
        since.reset();
        continue;
      }
      if (!since) since = sample.stamp;
      if (sample.stamp - *since >= FromSeconds(0.3)) return sample.stamp;
    }
  }
  return Timestamp::max();
}

// Whether a list could hold the vehicle at `t`: in sight for 0.3 s on end until then, or for so
// long altogether that it could have been vouched for. A glimpse long before is neither.
bool CouldBeListed(const Truth& truth, std::int64_t id, Timestamp t) {
  constexpr double kVouched_s = 2.0;
  for (const TruthObject& object : truth.objects) {
    if (object.id != id) continue;
    Duration seen{}, on_end{};
    const auto& samples = object.motion.samples();
    for (std::size_t i = 1; i < samples.size() && samples[i].stamp <= t; ++i) {
      const Duration step = samples[i].stamp - samples[i - 1].stamp;
      const bool is_seen = !samples[i - 1].is_hidden && !samples[i].is_hidden;
      on_end = is_seen ? on_end + step : Duration{};
      if (!samples[i].is_hidden) seen += step;
    }
    return seen >= FromSeconds(kVouched_s) || on_end >= FromSeconds(0.3);
  }
  return false;
}

std::optional<Timestamp> First(const std::vector<SaidWarnings>& said, Level least) {
  for (const SaidWarnings& each : said) {
    for (const warnings::Warning& warning : each.list.warnings) {
      if (GroupOf(warning.kind) == 0 && IsActive(warning.level, least)) return each.at;
    }
  }
  return std::nullopt;
}

void CountHeld(const WarnRun& run, const std::vector<SaidWarnings>& said, ConsumerScore& score) {
  std::size_t at = 0;
  for (const SaidWarnings& truth_said : run.truth_said) {
    while (at + 1 < said.size() && said[at + 1].at <= truth_said.at) ++at;
    for (const warnings::Warning& warning : truth_said.list.warnings) {
      if (warning.kind != Kind::kLta) continue;
      const auto object = std::ranges::find(
          run.truth.objects, warning.local_id != 0 ? warning.local_id : warning.track_id,
          &TruthObject::id);
      if (object == run.truth.objects.end()) continue;
      const TruthSample* sample = object->motion.InForce(truth_said.at);
      if (sample == nullptr || !sample->is_hidden) continue;
      if (InSight(run.truth, object->id) > truth_said.at) continue;  // Never seen.
      score.lta_hidden_s += 0.05;
      if (said.empty()) continue;
      const auto& list = said[at].list;
      const bool is_held = std::ranges::any_of(list.warnings, [&](const warnings::Warning& w) {
        return GroupOf(w.kind) == 0 && IsActive(w.level, Level::kAdvise) &&
               ObjectAt(run.truth, list.stamp, w.figures.position_B) == object->id;
      });
      if (is_held) score.lta_hidden_held_s += 0.05;
    }
  }
}

void Compare(const WarnRun& run, const std::vector<Episode>& truth_warn,
             const std::vector<Episode>& truth_advise, const std::vector<Episode>& ours,
             ConsumerScore& score) {
  for (const Episode& theirs : truth_warn) {
    WarnCounts& counts = score.kinds[theirs.kind];
    const Episode* found = nullptr;
    for (const Episode& each : ours) {
      if (AreTogether(each, theirs) && (found == nullptr || each.from < found->from)) found = &each;
    }
    const double delay_s = found != nullptr ? ToSeconds(found->from - theirs.from)
                                            : std::numeric_limits<double>::infinity();
    const bool is_in_time = delay_s <= kLate_s;
    if (!is_in_time &&
        !CouldBeListed(run.truth, theirs.object, theirs.from - FromSeconds(kLate_s))) {
      ++counts.unavoidable;
      continue;
    }
    if (found == nullptr) {
      ++counts.missed;
      continue;
    }
    ++(is_in_time ? counts.true_count : counts.late);
    counts.delays_s.push_back(delay_s);
  }
  for (const Episode& each : ours) {
    const auto is_with = [&each](const Episode& theirs) { return AreTogether(each, theirs); };
    const bool is_known = std::ranges::any_of(truth_warn, is_with);
    WarnCounts& counts = score.kinds[each.kind];
    if (!is_known) {
      const bool is_early = std::ranges::any_of(truth_advise, is_with);
      ++(is_early ? counts.early : counts.false_count);
      counts.false_by_lie += each.is_by_lie && !is_early;
    }
    if (!each.is_urgent) continue;
    ++counts.urgent;
    if (is_known) continue;
    ++counts.urgent_false;
    counts.urgent_false_unseen += each.is_unseen;
    counts.urgent_by_lie += each.is_urgent_by_lie;
  }
}

double SecondsOf(std::optional<Timestamp> t, const Truth& truth) {
  return t ? ToSeconds(*t - truth.begin()) : kNaN;
}

}  // namespace

WarnScore JudgeWarnings(const WarnRun& run) {
  WarnScore score;
  score.scenario = run.scenario;
  score.seconds = run.seconds;
  score.unwarned = Simulate(run.truth, run.body, std::nullopt, kPlanner);
  // Once the bodies touch, the drive that goes on through the other vehicle means nothing.
  const Timestamp end = score.unwarned.has_contact ? score.unwarned.contact : Timestamp::max();
  score.truth_first_urgent_s = SecondsOf(First(run.truth_said, Level::kUrgent), run.truth);
  score.truth_first_warn_s = SecondsOf(First(run.truth_said, Level::kWarn), run.truth);
  const auto truth_warn = Episodes(run.truth_said, end, run.truth, true, Level::kWarn);
  const auto truth_advise = Episodes(run.truth_said, end, run.truth, true, Level::kAdvise);
  const LocalSays local(run.said[static_cast<std::size_t>(Consumer::kLocal)]);
  for (const Consumer consumer : kConsumers) {
    const auto& said = run.said[static_cast<std::size_t>(consumer)];
    ConsumerScore& each = score.consumers[static_cast<std::size_t>(consumer)];
    Compare(run, truth_warn, truth_advise,
            Episodes(said, end, run.truth, false, Level::kWarn, &local), each);
    const auto urgent = First(said, Level::kUrgent);
    const auto warn = First(said, Level::kWarn);
    each.planner_brakes = urgent.has_value();
    each.driver_brakes = warn.has_value();
    each.first_urgent_s = SecondsOf(urgent, run.truth);
    each.first_warn_s = SecondsOf(warn, run.truth);
    each.planner = Simulate(run.truth, run.body, urgent, kPlanner);
    each.driver = Simulate(run.truth, run.body, warn, kDriver);
    CountHeld(run, said, each);
  }
  return score;
}

}  // namespace v2vouch::evaluation
