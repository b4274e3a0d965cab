// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "sim/behaviour/evaluation.h"
#include "sim/report/log_report.h"
#include "sim/report/report.h"
#include "sim/report/scene_clip.h"
#include "tests/sim/report/synthetic_run.h"

namespace v2vouch::evaluation {
namespace {

RunLog Recorded(const SyntheticRun& run, const char* name) {
  const std::string path = testing::TempDir() + name;
  EXPECT_TRUE(run.Write(path));
  RunLog log;
  std::string error;
  EXPECT_TRUE(ReadRunLog(path, {}, log, error)) << error;
  return log;
}

class EvaluatedRun : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    evaluation_ = Evaluate(Recorded({}, "synthetic_run.lcm"), {}).release();
  }
  static void TearDownTestSuite() { delete evaluation_; }
  static inline Evaluation* evaluation_ = nullptr;
};

TEST_F(EvaluatedRun, WholeLogIsUnderstood) {
  EXPECT_EQ(evaluation_->log.refused, 0);
  EXPECT_EQ(evaluation_->log.damaged, 0);
  EXPECT_EQ(evaluation_->log.truth.objects.size(), 6u);
  EXPECT_NEAR(evaluation_->duration_s, SyntheticRun::kLength_s, 1e-6);
  EXPECT_EQ(evaluation_->log.specs.name, "synthetic_left_turn");
  EXPECT_EQ(evaluation_->log.specs.buildings.size(), 4u);
  EXPECT_EQ(evaluation_->log.specs.sensors.size(), 4u);
}

TEST_F(EvaluatedRun, PositionErrorIsTheNoiseThatWasPutIn) {
  // Two axes of 0.15 m; lists are one 50 ms step old and predicted exactly (constant motions).
  const double expected = 0.15 * std::sqrt(2.0);
  EXPECT_NEAR(evaluation_->headline(ListKind::kLocal).localisation_rms_m, expected, 0.02);
  EXPECT_NEAR(evaluation_->headline(ListKind::kPriority).localisation_rms_m, expected, 0.02);
  EXPECT_NEAR(evaluation_->headline(ListKind::kV2v).localisation_rms_m, std::hypot(1.2, 0.1, 0.1),
              0.05);
  EXPECT_NEAR(evaluation_->headline(ListKind::kLocal).visible.mean(), 2.0, 0.2);
}

TEST_F(EvaluatedRun, FalseTracksAndSwitchesAreThoseThatWerePutIn) {
  const ListScore& local = evaluation_->headline(ListKind::kLocal);
  EXPECT_EQ(local.false_instants, 10);  // Half a second at 20 Hz.
  EXPECT_EQ(local.false_track_ids, 1);
  EXPECT_EQ(local.switches, 1);                          // Vehicle 1 under a new id.
  EXPECT_DOUBLE_EQ(local.switch_halves, 2 * 0.5 + 0.5);  // Lost, found; 3 lost.
  const ListScore& priority = evaluation_->headline(ListKind::kPriority);
  EXPECT_EQ(priority.false_instants, 0);
  EXPECT_EQ(priority.switches, 0);
}

TEST_F(EvaluatedRun, ThePedestrianIsNeitherMissedNorFalse) {
  // Five vehicles at most within the disc; the pedestrian's track is in LOCAL all the time.
  for (const InstantScore& now : evaluation_->headline(ListKind::kLocal).series) {
    ASSERT_LE(now.truths, 5);
  }
}

TEST_F(EvaluatedRun, HiddenVehicleIsFollowedInPriority) {
  // Vehicles 1 (4 s) and 3 (from 9 s on) are hidden within the sensors' fields of view, and kept;
  // nobody is kept outside of them.
  EXPECT_NEAR(evaluation_->hidden.seconds, 9.0, 0.3);
  EXPECT_EQ(evaluation_->out_of_view.seconds, 0.0);
  EXPECT_TRUE(std::isnan(evaluation_->out_of_view.rms_m));
  EXPECT_GT(evaluation_->hidden.rms_m, 0.15);
  EXPECT_LT(evaluation_->hidden.max_m, 1.5);
  EXPECT_NEAR(evaluation_->hold_s.at(1), 12.3, 0.2);
  EXPECT_EQ(evaluation_->hold_s.at(5), 0.0);
  EXPECT_GT(evaluation_->validated_share, 0.97);
}

TEST_F(EvaluatedRun, BoundForgivesWhatCannotBeSeenAndNothingElse) {
  const ListScore& local = evaluation_->headline(ListKind::kLocal);
  // Vehicle 5 is never seen; 1 and 3 coast for some seconds and are dropped then.
  EXPECT_GT(local.bound_missed_seconds, 13.0);
  EXPECT_LT(local.bound_missed_seconds, 13.0 + 4.0 + 5.0);
  // LOCAL gives vehicles 1 and 3 up at once: the bound would coast.
  EXPECT_GT(local.excess_missed_share, 0.03);
  for (const InstantScore& now : local.series) ASSERT_GT(now.bound_gospa, 0.0);
  EXPECT_LT(local.bound_mean, local.gospa_mean);
}

TEST_F(EvaluatedRun, GospaPartsAddUpAtEveryInstant) {
  for (const CutoffScores& scores : evaluation_->cutoffs) {
    for (const ListScore& score : scores.all) {
      for (const InstantScore& now : score.series) {
        ASSERT_NEAR(now.gospa * now.gospa, now.localisation_pow + now.missed_pow + now.false_pow,
                    1e-6);
      }
    }
  }
}

TEST_F(EvaluatedRun, JsonHasTheAgreedShape) {
  const auto json = nlohmann::json::parse(ToJson(*evaluation_, nullptr));
  EXPECT_EQ(json.at("cutoff_m"), 10.0);
  EXPECT_EQ(json.at("order"), 2.0);
  for (const char* list : {"local", "v2v", "priority"}) {
    for (const char* key :
         {"gospa_mean", "gospa_rms", "localisation_mean", "missed_mean", "false_mean",
          "switching_mean", "switches", "false_tracks_total", "bound_mean", "ratio",
          "localisation_rms_m", "localisation_ratio", "excess_missed_share"}) {
      EXPECT_TRUE(json.at("lists").at(list).at(key).is_number()) << list << "." << key;
    }
  }
  for (const char* key : {"rms_m", "max_m", "seconds"}) {
    EXPECT_TRUE(json.at("hidden").at(key).is_number()) << key;
  }
  EXPECT_TRUE(json.at("out_of_view").at("rms_m").is_null());
  EXPECT_EQ(json.at("lists").at("local").at("out_of_view").at("samples"), 0);
  EXPECT_TRUE(json.at("lists").at("local").at("out_of_view").at("anees").is_null());
  EXPECT_TRUE(json.at("validated_share").is_number());
  EXPECT_TRUE(json.at("lists").at("local").at("visible").at("is_in_band"));
  EXPECT_EQ(json.at("behaviour").at("local").at("heading").at("flips"), 0);
  EXPECT_TRUE(json.at("behaviour").at("confirmation").at("all").at("looks_mean").is_number());
  EXPECT_TRUE(json.at("hold_s").at("1").is_number());
}

TEST_F(EvaluatedRun, ReportIsSelfContainedAndTheSameEveryTime) {
  const std::string html = ReportHtml(*evaluation_, nullptr);
  EXPECT_EQ(html, ReportHtml(*evaluation_, nullptr));
  EXPECT_EQ(html.find("Through the camera"), std::string::npos);
  // RFC 4648: "foobar" is Zm9vYmFy, "fooba" is Zm9vYmE=, "foob" is Zm9vYg==.
  const auto shown = ReportHtml(*evaluation_, nullptr,
                                {{"a", {'f', 'o', 'o', 'b', 'a', 'r'}},
                                 {"b", {'f', 'o', 'o', 'b', 'a'}},
                                 {"<c>", {'f', 'o', 'o', 'b'}}});
  for (const char* text : {"Through the camera", "base64,Zm9vYmFy\"", "base64,Zm9vYmE=\"",
                           "base64,Zm9vYg==\"", "&lt;c&gt;"}) {
    EXPECT_NE(shown.find(text), std::string::npos) << text;
  }
  EXPECT_THAT(html, testing::HasSubstr("vehicle 1 hidden"));
  EXPECT_THAT(html, testing::Not(testing::HasSubstr("<script")));
  EXPECT_THAT(html, testing::Not(testing::HasSubstr("href=\"http")));
  EXPECT_THAT(html, testing::Not(testing::HasSubstr(">nan<")));
}

TEST_F(EvaluatedRun, StoryTellsWhatBecameOfTheHiddenVehicle) {
  // Put in: hidden from 4 to 8 s, LOCAL loses it and PRIORITY does not; one false track of LOCAL.
  const std::string story = Story(*evaluation_, nullptr);
  EXPECT_THAT(story,
              testing::StartsWith("Vehicle 1 was hidden for 4 s, from 4 s on; LOCAL lost it "));
  EXPECT_THAT(story, testing::HasSubstr("; PRIORITY kept it, at most "));
  EXPECT_THAT(story, testing::HasSubstr("1 of its tracks were false"));
  EXPECT_THAT(story, testing::HasSubstr("PRIORITY listed nothing that was not there."));
  const std::string html = ReportHtml(*evaluation_, nullptr);
  EXPECT_LT(html.find("What happened"), html.find("The scene"));
  EXPECT_LT(html.find("Beside the paper"), html.find("<h2>Gates"));
}

TEST_F(EvaluatedRun, LiarHasASectionAndAPlaceInTheStory) {
  LiarFacts liars;
  liars.log.truth = evaluation_->log.truth;
  liars.log.specs = evaluation_->log.specs;
  BsmTruth lie;
  lie.stamp = evaluation_->log.truth.begin() + FromSeconds(5.0);
  lie.sender = 0xBADCAFE;
  lie.device = 77;
  lie.is_attacker = lie.is_attack = true;
  lie.claimed = {
      .p_W = evaluation_->log.truth.ego.At(lie.stamp)->position() + Eigen::Vector2d(10.0, 0.0),
      .length_m = 4.5,
      .width_m = 1.8};
  liars.log.bsm_truths = {lie};
  liars.judged.emplace();
  liars.judged->false_messages = 1;
  SourceOutcome outcome;
  outcome.device = 77;
  outcome.met_after_s = 0.7;
  outcome.accused_after_s = 6.4;
  liars.judged->attackers = {outcome};
  EXPECT_THAT(Story(*evaluation_, &liars),
              testing::EndsWith("The phantom never appeared in PRIORITY; doubted after 0.7 s, "
                                "accused after 6.4 s."));
  const std::string html = ReportHtml(*evaluation_, nullptr, {}, &liars);
  EXPECT_THAT(html,
              testing::AllOf(testing::HasSubstr("<h2>The liar"), testing::HasSubstr("0badcafe"),
                             testing::HasSubstr(">false claim</text>"),
                             testing::HasSubstr("Never in PRIORITY")));
  liars.judged->false_messages = 0;
  EXPECT_THAT(ReportHtml(*evaluation_, nullptr, {}, &liars),
              testing::Not(testing::HasSubstr("<h2>The liar")));
}

TEST(RunWithoutLists, IsAllMissedAndHasNoFigures) {
  const auto evaluation = Evaluate(Recorded({.has_lists = false}, "synthetic_empty.lcm"), {});
  const ListScore& local = evaluation->headline(ListKind::kLocal);
  EXPECT_EQ(local.missed_seconds, local.vehicle_seconds);
  EXPECT_FALSE(local.has_lists);
  EXPECT_TRUE(std::isnan(local.localisation_rms_m));
  EXPECT_TRUE(std::isnan(local.gospa_mean));
  for (const Gate& gate : evaluation->gates) EXPECT_FALSE(gate.passes()) << gate.name;
  const std::string table = ToTable(*evaluation, nullptr);
  EXPECT_THAT(table, testing::HasSubstr("none"));
  EXPECT_THAT(table, testing::Not(testing::HasSubstr("nan")));
  const auto json = nlohmann::json::parse(ToJson(*evaluation, nullptr));
  EXPECT_TRUE(json.at("lists").at("local").at("gospa_mean").is_null());
  EXPECT_TRUE(json.at("hidden").at("rms_m").is_null());
}

// The file's own path is in the log that was read.
TEST_F(EvaluatedRun, ClipHoldsTheDriveAndTheSameEveryTime) {
  const std::string clip = SceneClip(evaluation_->log.path, MomentWorthSeeing(*evaluation_));
  EXPECT_EQ(clip, SceneClip(evaluation_->log.path, MomentWorthSeeing(*evaluation_)));
  EXPECT_THAT(clip, testing::HasSubstr("id=\"clip-data\">H4sI"));  // Gzip's magic in base64.
  EXPECT_THAT(clip, testing::HasSubstr("class SceneView"));
  const std::string html = ReportHtml(*evaluation_, nullptr, {}, nullptr, nullptr, clip);
  EXPECT_THAT(html, testing::HasSubstr("<h2>Play it"));
  EXPECT_THAT(html, testing::Not(testing::HasSubstr("src=\"http")));
}

TEST(RunWithoutLists, HasNoClip) {
  const RunLog log = Recorded({.has_lists = false}, "synthetic_empty.lcm");
  EXPECT_EQ(SceneClip(log.path, {}), "");
  EXPECT_EQ(SceneClip("/dev/null", {}), "");
}

TEST(RunWithoutTruth, IsCountedButNotJudged) {
  const RunLog log = Recorded({.has_truth = false}, "synthetic_drive.lcm");
  EXPECT_TRUE(log.truth.empty());
  const auto json = nlohmann::json::parse(ListSummaryJson(log));
  EXPECT_FALSE(json.at("has_truth"));
  EXPECT_EQ(json.at("lists").at("local").at("lists"), 281);
  EXPECT_NEAR(json.at("lists").at("priority").at("longest_track_s").get<double>(), 12.4, 0.1);
}

TEST(RunWithoutTruth, HasAReportOfWhatWasHeld) {
  const RunLog log = Recorded({.has_truth = false}, "synthetic_drive.lcm");
  LogFacts facts;
  std::string error;
  ASSERT_TRUE(ReadLogFacts(log.path, facts, error)) << error;
  const std::string html = LogReportHtml(log, facts);
  EXPECT_EQ(html, LogReportHtml(log, facts));
  for (const char* text : {"There is no truth to judge by", "PRIORITY: held when",
                           "LOCAL: held when", "Trust over time", "Inputs over time",
                           "none was withdrawn or accused", "holds no V2VOUCH_STATUS"}) {
    EXPECT_THAT(html, testing::HasSubstr(text));
  }
  EXPECT_THAT(html, testing::Not(testing::HasSubstr("nan")));
}

// A live recording of a scenario: events carry the wall clock, messages the scenario's time.
TEST(RunLogReader, ARecordersOwnClockChangesNoScore) {
  SyntheticRun run;
  const auto same = Evaluate(Recorded(run, "same_clock.lcm"), {});
  run.recorder_ahead_s = 100.0 * 86400.0;
  const auto ahead = Evaluate(Recorded(run, "clock_ahead.lcm"), {});
  run.recorder_ahead_s = -run.recorder_ahead_s;
  const auto behind = Evaluate(Recorded(run, "clock_behind.lcm"), {});
  EXPECT_GT(same->headline(ListKind::kLocal).localisation_rms_m, 0.0);
  EXPECT_EQ(ToJson(*ahead, nullptr), ToJson(*same, nullptr));
  EXPECT_EQ(ToJson(*behind, nullptr), ToJson(*same, nullptr));
}

TEST(RunLogReader, SaysWhyAFileCannotBeRead) {
  RunLog log;
  std::string error;
  EXPECT_FALSE(ReadRunLog("/nonexistent/run.lcm", {}, log, error));
  EXPECT_FALSE(error.empty());
}

}  // namespace
}  // namespace v2vouch::evaluation
