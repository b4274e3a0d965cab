// SPDX-License-Identifier: Apache-2.0
#include "sim/spoofing/spoof_run.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "sim/metrics/scoring.h"
#include "sim/spoofing/message_checks.h"

namespace v2vouch::evaluation {
namespace {

// Relied-on senders are met by a run of positive messages: one refusal may be a rate limit's.
constexpr int kStreak = 3;
// Time in view between two messages further apart counts up to this.
constexpr double kLongestStep_s = 0.5;

std::optional<double> Ratio(std::int64_t part, std::int64_t whole) {
  if (whole <= 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(whole);
}

/// One device's story, message by message.
struct Device {
  bool is_attacker = false;
  bool was_relied_on = false;
  bool was_detected = false;
  int streak = 0;
  Timestamp streak_begin{};
  std::optional<Timestamp> last_in_view;  // Of a false message.
  std::optional<Timestamp> first_false, met, accused;
  double false_in_view_s = 0.0;
  bool has_counted = false;   // Any message counted ...
  bool has_positive = false;  // ... and positive.

  void TakeAttack(const JudgedMessage& message, Timestamp t) {
    was_relied_on |= message.is_relied_on;
    if (!message.is_false) return;
    was_detected |= message.is_positive;
    if (message.is_in_view) {
      if (!first_false) first_false = t;
      if (last_in_view) {
        false_in_view_s += std::clamp(ToSeconds(t - *last_in_view), 0.0, kLongestStep_s);
      }
      last_in_view = t;
    } else {
      last_in_view = std::nullopt;
    }
    if (!message.is_positive) {
      streak = 0;
    } else if (streak++ == 0) {
      streak_begin = t;
    }
    if (streak == 0 || !first_false || met) return;
    if (!was_relied_on || streak >= kStreak) met = std::max(streak_begin, *first_false);
  }
};

class Judge {
 public:
  Judge(const RunLog& log, const std::vector<JudgedMessage>& judged, const Senders& senders)
      : log_(log), judged_(judged), senders_(senders) {}

  void TakeMessages(SpoofRun& run) {
    for (const JudgedMessage& message : judged_) {
      const BsmTruth& m = log_.bsm_truths[message.truth];
      Device& device = devices_[m.device];
      device.is_attacker = m.is_attacker;
      run.false_messages += message.is_false ? 1 : 0;
      run.contested += message.is_contested ? 1 : 0;
      if (m.is_attacker) device.TakeAttack(message, m.stamp);
      if (!message.counts(m)) continue;
      run.by_message.Count(message.is_false, message.is_positive);
      device.has_counted = true;
      device.has_positive |= message.is_positive;
    }
  }

  void TakeReports() {
    for (const VerdictReport& report : log_.reports) {
      const auto meant = senders_.AttackerMeant(report.sender, report.received);
      if (!meant) continue;
      Device& device = devices_[*meant];
      device.was_detected = true;
      if (!device.first_false || report.received < *device.first_false) continue;
      if (!device.met || report.received < *device.met) device.met = report.received;
      if (report.is_accusation && !device.accused) device.accused = report.received;
    }
  }

  void Finish(SpoofRun& run) const {
    for (const auto& [id, device] : devices_) {
      if (!device.is_attacker) {
        if (device.has_counted) run.by_source.Count(false, device.has_positive);
        continue;
      }
      if (!device.first_false) continue;
      SourceOutcome out;
      out.device = id;
      out.first_false_s = ToSeconds(*device.first_false - log_.truth.begin());
      out.false_in_view_s = device.false_in_view_s;
      out.was_detected = device.was_detected;
      if (device.met) out.met_after_s = ToSeconds(*device.met - *device.first_false);
      if (device.accused) out.accused_after_s = ToSeconds(*device.accused - *device.first_false);
      if (out.false_in_view_s >= kSourceInView_s) run.by_source.Count(true, out.was_detected);
      run.attackers.push_back(out);
    }
  }

 private:
  const RunLog& log_;
  const std::vector<JudgedMessage>& judged_;
  const Senders& senders_;
  std::map<std::int64_t, Device> devices_;
};

void TakeMessageChecks(const RunLog& log, const std::vector<JudgedMessage>& judged,
                       const std::vector<SourceOutcome>& attackers, SpoofRun& run) {
  const std::vector<bool> is_flagged = CheckMessages(log);
  Confusion by_message;
  struct Seen {
    bool is_attacker = false, has_counted = false, is_flagged = false;
  };
  std::map<std::int64_t, Seen> devices;
  for (const JudgedMessage& message : judged) {
    const BsmTruth& m = log.bsm_truths[message.truth];
    Seen& seen = devices[m.device];
    seen.is_attacker = m.is_attacker;
    const bool is_hit = is_flagged[message.truth];
    if (m.is_attacker && message.is_false) seen.is_flagged |= is_hit;
    if (!message.counts(m)) continue;
    by_message.Count(message.is_false, is_hit);
    seen.has_counted = true;
    if (!m.is_attacker) seen.is_flagged |= is_hit;
  }
  Confusion by_source;
  for (const auto& [id, seen] : devices) {
    if (!seen.is_attacker && seen.has_counted) by_source.Count(false, seen.is_flagged);
  }
  for (const SourceOutcome& source : attackers) {
    if (source.false_in_view_s < kSourceInView_s) continue;
    by_source.Count(true, devices[source.device].is_flagged);
  }
  run.checks_by_message = by_message;
  run.checks_by_source = by_source;
}

ListGospa MeanGospa(const RunLog& log) {
  ScoringSettings settings;
  settings.period_s = 0.2;
  const auto grid = MakeGrid(log.truth, settings);
  if (grid.empty()) return {};
  const Bound bound(log, grid);
  const auto mean = [&](ListKind kind) -> std::optional<double> {
    if (log.lists[Index(kind)].empty()) return std::nullopt;
    const double gospa =
        ScoreList(log, grid, bound, kind, Against::kOwnScope, settings, false).gospa_mean;
    return std::isfinite(gospa) ? std::optional(gospa) : std::nullopt;
  };
  return {mean(ListKind::kLocal), mean(ListKind::kV2v), mean(ListKind::kPriority)};
}

}  // namespace

void Confusion::Count(bool is_false, bool is_positive) {
  if (is_false) {
    ++(is_positive ? true_positive : false_negative);
  } else {
    ++(is_positive ? false_positive : true_negative);
  }
}

void Confusion::Add(const Confusion& other) {
  true_positive += other.true_positive;
  false_positive += other.false_positive;
  false_negative += other.false_negative;
  true_negative += other.true_negative;
}

std::optional<double> Confusion::precision() const {
  return Ratio(true_positive, true_positive + false_positive);
}

std::optional<double> Confusion::recall() const {
  return Ratio(true_positive, true_positive + false_negative);
}

std::optional<double> Confusion::f1() const {
  if (true_positive + false_negative == 0) return std::nullopt;
  return Ratio(2 * true_positive, 2 * true_positive + false_positive + false_negative);
}

std::optional<double> Confusion::accuracy() const {
  return Ratio(true_positive + true_negative,
               true_positive + true_negative + false_positive + false_negative);
}

std::optional<double> Confusion::false_positive_rate() const {
  return Ratio(false_positive, false_positive + true_negative);
}

SpoofRun JudgeSpoof(const RunLog& log, bool with_message_checks) {
  SpoofRun run;
  run.scenario = log.specs.name;
  run.messages = static_cast<std::int64_t>(log.bsm_truths.size());
  if (log.truth.empty()) return run;
  run.duration_s = ToSeconds(log.truth.end() - log.truth.begin());
  const Senders senders(log);
  const std::vector<JudgedMessage> judged = JudgeMessages(log);
  run.unanswered = std::count_if(judged.begin(), judged.end(),
                                 [](const JudgedMessage& m) { return !m.has_verdict; });
  Judge judge(log, judged, senders);
  judge.TakeMessages(run);
  judge.TakeReports();
  judge.Finish(run);
  run.exposure = MeasureExposure(log, senders);
  run.honest = JudgeHonest(log, senders, judged);
  run.gospa = MeanGospa(log);
  if (with_message_checks) TakeMessageChecks(log, judged, run.attackers, run);
  return run;
}

}  // namespace v2vouch::evaluation
