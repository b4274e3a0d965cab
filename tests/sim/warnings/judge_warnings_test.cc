// SPDX-License-Identifier: Apache-2.0
#include "sim/warnings/judge_warnings.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/warnings/warn_tally.h"

namespace v2vouch::evaluation {
namespace {

using warnings::Kind;
using warnings::Level;

const Timestamp kStart = FromMicros(1'781'510'400'000'000);

Timestamp At(double s) { return kStart + FromSeconds(s); }

// The ego drives east at 15 m/s for 6 s towards a car that stands at 80 m: contact after 4.9 s.
Truth Drive(double car_x = 80.0, double hidden_until_s = 0.0) {
  Truth truth;
  TruthObject car;
  car.id = 7;
  car.object_class = 1;
  car.length_m = 4.0;
  car.width_m = 1.7;
  for (int i = 0; i <= 120; ++i) {
    TruthSample ego;
    ego.stamp = At(0.05 * i);
    ego.motion = {0.75 * i, 0.0, 0.0, 15.0, 0.0, 0.0};
    truth.ego.Add(ego);
    TruthSample sample;
    sample.stamp = ego.stamp;
    sample.motion = {car_x, 0.0, 0.0, 0.0, 0.0, 0.0};
    sample.is_hidden = 0.05 * i < hidden_until_s;
    car.motion.Add(sample);
  }
  truth.objects.push_back(car);
  return truth;
}

// A warning at `level` from `from_s` to `to_s` of something at x metres of the world.
void Say(std::vector<SaidWarnings>& said, double from_s, double to_s, Level level, double x_m) {
  for (double t = from_s; t < to_s; t += 0.05) {
    SaidWarnings each;
    each.at = each.list.stamp = At(t);
    warnings::Warning warning;
    warning.kind = Kind::kFcw;
    warning.level = level;
    warning.local_id = 7;
    warning.figures.position_B = {x_m - 15.0 * t, 0.0};
    each.list.warnings.push_back(warning);
    said.push_back(each);
  }
}

WarnRun RunOf(Truth truth) {
  WarnRun run;
  run.truth = std::move(truth);
  Say(run.truth_said, 2.0, 5.0, Level::kWarn, 80.0);
  return run;
}

const WarnCounts& Of(const WarnScore& score, Consumer consumer) {
  static const WarnCounts kNothing;
  const auto& kinds = score.consumers[static_cast<std::size_t>(consumer)].kinds;
  const auto found = kinds.find(Kind::kFcw);
  return found == kinds.end() ? kNothing : found->second;
}

TEST(JudgeWarnings, TellsTrueLateMissedAndFalseApart) {
  WarnRun run = RunOf(Drive());
  Say(run.said[0], 2.2, 5.0, Level::kWarn, 80.0);    // V2V: 0.2 s behind truth.
  Say(run.said[1], 2.6, 5.0, Level::kWarn, 80.0);    // LOCAL: late.
  Say(run.said[2], 2.0, 5.0, Level::kUrgent, 60.0);  // Ours: of a car that is not there.
  const WarnScore score = JudgeWarnings(run);
  EXPECT_EQ(Of(score, Consumer::kV2v).true_count, 1);
  EXPECT_NEAR(Of(score, Consumer::kV2v).delays_s.at(0), 0.2, 0.01);
  EXPECT_EQ(Of(score, Consumer::kLocal).late, 1);
  EXPECT_EQ(Of(score, Consumer::kOurs).missed, 1);
  EXPECT_EQ(Of(score, Consumer::kOurs).false_count, 1);
  EXPECT_EQ(Of(score, Consumer::kOurs).urgent_false, 1);
  EXPECT_EQ(Of(score, Consumer::kV2v).urgent_false, 0);
}

TEST(JudgeWarnings, NeverSeenUntilThenIsUnavoidable) {
  const WarnScore score = JudgeWarnings(RunOf(Drive(80.0, 3.0)));
  EXPECT_EQ(Of(score, Consumer::kOurs).unavoidable, 1);
  EXPECT_EQ(Of(score, Consumer::kOurs).missed, 0);
}

TEST(JudgeWarnings, AGlimpseLongBeforeIsNoSight) {
  Truth truth = Drive(80.0, 3.0);
  MotionSamples with_glimpse;
  for (TruthSample sample : truth.objects[0].motion.samples()) {
    const double t = ToSeconds(sample.stamp - kStart);
    if (t > 0.5 && t < 1.0) sample.is_hidden = false;
    with_glimpse.Add(sample);
  }
  truth.objects[0].motion = with_glimpse;
  EXPECT_EQ(Of(JudgeWarnings(RunOf(truth)), Consumer::kOurs).unavoidable, 1);
}

TEST(JudgeWarnings, WhatIsSaidAfterTheContactDoesNotCount) {
  WarnRun run = RunOf(Drive());  // Contact at 4.9 s.
  Say(run.said[2], 2.0, 4.5, Level::kWarn, 80.0);
  Say(run.said[2], 5.2, 5.9, Level::kUrgent, 140.0);
  const WarnScore score = JudgeWarnings(run);
  EXPECT_EQ(Of(score, Consumer::kOurs).true_count, 1);
  EXPECT_EQ(Of(score, Consumer::kOurs).urgent_false, 0);
}

TEST(JudgeWarnings, ShortPausesAreOneEpisode) {
  WarnRun run = RunOf(Drive());
  Say(run.said[2], 2.0, 3.0, Level::kWarn, 80.0);
  Say(run.said[2], 3.3, 5.0, Level::kWarn, 80.0);
  EXPECT_EQ(Of(JudgeWarnings(run), Consumer::kOurs).true_count, 1);
}

TEST(Simulate, PlannerStopsInTimeAndDriverDoesNot) {
  const Truth truth = Drive();
  const warnings::EgoBody body;
  // Bumper at 3.75 m, rear at 78 m: 4.95 s at 15 m/s.
  const Outcome nobody = Simulate(truth, body, std::nullopt, kPlanner);
  EXPECT_TRUE(nobody.has_contact);
  EXPECT_NEAR(nobody.contact_speed_mps, 15.0, 0.1);
  EXPECT_EQ(nobody.speed_lost_mps, 0.0);
  // Stopping from 15 m/s takes 14.1 m at 8 m/s2, 28.1 m at 4 m/s2.
  const Timestamp warned = At(3.5);
  EXPECT_FALSE(Simulate(truth, body, warned, kPlanner).has_contact);
  const Outcome driver = Simulate(truth, body, warned, kDriver);
  EXPECT_TRUE(driver.has_contact);
  EXPECT_LT(driver.contact_speed_mps, 14.5);
  EXPECT_FALSE(Simulate(truth, body, At(1.8), kDriver).has_contact);
}

TEST(Simulate, TheWorldGoesOnBeyondTheLog) {
  // Contact would be at 6.9 s, 0.9 s after the log's end.
  EXPECT_TRUE(Simulate(Drive(110.0), {}, std::nullopt, kPlanner).has_contact);
  EXPECT_FALSE(Simulate(Drive(200.0), {}, std::nullopt, kPlanner).has_contact);
}

TEST(JudgeWarnings, BrakingWithoutNeedIsNamed) {
  WarnRun run = RunOf(Drive(500.0));
  run.truth_said.clear();
  Say(run.said[0], 2.0, 3.0, Level::kUrgent, 60.0);
  const std::string json = WarnScoreJson(JudgeWarnings(run));
  EXPECT_NE(json.find("\"needless\":true"), std::string::npos);
  EXPECT_NE(json.find("\"contact_unwarned\":false"), std::string::npos);
}

// Marks all that was said as of a track that a liar's messages feed.
void MarkAsOfLiar(std::vector<SaidWarnings>& said) {
  for (SaidWarnings& each : said) each.is_of_liar.assign(each.list.warnings.size(), true);
}

TEST(JudgeWarnings, OfALiarsTrackIsALieUnlessLocalAloneSaysTheSame) {
  WarnRun run = RunOf(Drive());
  run.truth_said.clear();
  for (auto& said : run.said) Say(said, 2.0, 3.0, Level::kUrgent, 60.0);  // Nothing is there.
  MarkAsOfLiar(run.said[0]);
  MarkAsOfLiar(run.said[2]);
  for (SaidWarnings& each : run.said[0]) each.list.warnings.front().local_id = 0;
  WarnScore score = JudgeWarnings(run);
  EXPECT_EQ(Of(score, Consumer::kV2v).urgent_by_lie, 1);
  EXPECT_EQ(Of(score, Consumer::kV2v).false_by_lie, 1);
  EXPECT_EQ(Of(score, Consumer::kLocal).urgent_by_lie, 0);
  EXPECT_EQ(Of(score, Consumer::kOurs).urgent_false, 1);
  EXPECT_EQ(Of(score, Consumer::kOurs).urgent_by_lie, 0);
  run.said[1].clear();
  score = JudgeWarnings(run);
  EXPECT_EQ(Of(score, Consumer::kOurs).urgent_by_lie, 1);
}

TEST(JudgeWarnings, AWarningThatTruthGivesTooIsNoLie) {
  WarnRun run = RunOf(Drive());
  Say(run.said[0], 2.1, 5.0, Level::kUrgent, 80.0);
  MarkAsOfLiar(run.said[0]);
  const WarnScore score = JudgeWarnings(run);
  EXPECT_EQ(Of(score, Consumer::kV2v).true_count, 1);
  EXPECT_EQ(Of(score, Consumer::kV2v).urgent_by_lie, 0);
}

TEST(WarnTally, AddsUpWhatTheRunsSay) {
  WarnRun run = RunOf(Drive(500.0));
  run.truth_said.clear();
  Say(run.said[0], 2.0, 3.0, Level::kUrgent, 60.0);
  for (SaidWarnings& each : run.said[0]) each.list.warnings.front().local_id = 0;
  MarkAsOfLiar(run.said[0]);
  WarnTally one, sum;
  ASSERT_TRUE(ReadWarnTally(WarnScoreJson(JudgeWarnings(run)), one));
  sum.Add(one);
  sum.Add(one);
  EXPECT_EQ(sum.runs, 2);
  EXPECT_EQ(sum.contacts_unwarned, 0);
  EXPECT_EQ(sum.v2v.urgent_by_lie, 2);
  EXPECT_EQ(sum.v2v.runs_by_lie, 2);
  EXPECT_EQ(sum.v2v.planner_needless, 2);
  EXPECT_GT(sum.v2v.speed_lost_mps, 2.0);
  EXPECT_EQ(sum.ours.urgent_by_lie, 0);
  EXPECT_FALSE(sum.ours.delay_p95_s());
  EXPECT_FALSE(ReadWarnTally("{}", one));
  EXPECT_FALSE(ReadWarnTally("no figures", one));
}

TEST(IntentFromTruth, SignalsBeforeTheTurnAndNotOnAStraightRoad) {
  Truth truth;
  // East at 4 m/s for 10 s, then a left turn of 10 m radius, then north.
  double x = 0.0, y = 0.0, yaw = 0.0;
  for (int i = 0; i <= 400; ++i) {
    const double t = 0.05 * i;
    const bool turns = t > 10.0 && yaw < 1.5707;
    TruthSample sample;
    sample.stamp = At(t);
    sample.motion = {x, y, yaw, 4.0, turns ? 0.4 : 0.0, 0.0};
    truth.ego.Add(sample);
    x += 0.2 * std::cos(yaw);
    y += 0.2 * std::sin(yaw);
    if (turns) yaw += 0.02;
  }
  const auto signal = [&](double s) { return IntentFromTruth(truth, At(s)).turn_signal; };
  EXPECT_EQ(signal(2.0), warnings::TurnSignal::kNone);
  EXPECT_EQ(signal(9.0), warnings::TurnSignal::kLeft);
  EXPECT_EQ(signal(12.0), warnings::TurnSignal::kLeft);
  EXPECT_EQ(signal(18.0), warnings::TurnSignal::kNone);
}

}  // namespace
}  // namespace v2vouch::evaluation
