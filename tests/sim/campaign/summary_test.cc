// SPDX-License-Identifier: Apache-2.0
#include "sim/campaign/summary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "sim/campaign/families.h"
#include "sim/campaign/report.h"
#include "sim/campaign/targets.h"

namespace v2vouch::campaign {
namespace {

using evaluation::SourceOutcome;
using evaluation::SpoofRun;
using testing::HasSubstr;

RunRecord Record(Kind kind, const std::string& id, const std::string& variant, std::uint64_t seed) {
  RunRecord record;
  record.job.overlay = {kind, id, variant, "", false};
  record.job.scenario = "urban";
  record.job.seed = seed;
  record.local_digest = "same";
  record.ours.honest.vehicle_s = 360.0;
  record.ours.honest.in_view = 100;
  record.ours.honest.validated = 98;
  record.ours.honest.bridges = 10;
  record.ours.honest.bridges_survived = 9;
  return record;
}

RunRecord Attack(const std::string& id, const std::string& variant, std::uint64_t seed,
                 std::optional<double> met_after_s, double exposure_m = 0.0) {
  RunRecord record = Record(Kind::kAttack, id, variant, seed);
  SourceOutcome source;
  source.false_in_view_s = 4.0;
  source.met_after_s = met_after_s;
  source.was_detected = met_after_s.has_value();
  record.ours.attackers = {source};
  record.ours.by_message = {met_after_s ? 99 : 0, 0, met_after_s ? 1 : 100, 100};
  record.ours.exposure.max_m = exposure_m;
  return record;
}

const Target* Find(const std::vector<Target>& targets, const std::string& what) {
  for (const Target& target : targets) {
    if (target.what.find(what) != std::string::npos) return &target;
  }
  return nullptr;
}

TEST(Summary, PoolsByIdAndVariantInTheCataloguesOrder) {
  const Summary s = Summarise({Attack("A11", "grid_5", 1, 1.0), Attack("A5", "lateral_8m", 1, 2.0),
                               Attack("A5", "offset_20_70m", 1, 0.5), Attack("mine", "", 1, 3.0),
                               Attack("A5", "lateral_8m", 2, std::nullopt)});
  ASSERT_EQ(s.attacks.size(), 3u);
  EXPECT_EQ(s.attacks[0].id, "A5");
  EXPECT_EQ(s.attacks[1].id, "A11");
  EXPECT_EQ(s.attacks[2].id, "mine");
  EXPECT_TRUE(s.attacks[2].variants.empty());
  EXPECT_EQ(s.attacks[0].attack.runs, 3);
  EXPECT_NEAR(*s.attacks[0].attack.withdraw_rate(), 2.0 / 3.0, 1e-12);
  ASSERT_EQ(s.attacks[0].variants.size(), 2u);
  EXPECT_EQ(s.attacks[0].variants[0].name(), "A5/lateral_8m");
  EXPECT_EQ(s.attacks[0].variants[0].attack.runs, 2);
  EXPECT_EQ(s.runs, 5);
}

TEST(Summary, ComparesWithTheSameRunWithoutAttack) {
  RunRecord plain = Record(Kind::kPlain, "", "", 1);
  RunRecord changed = Attack("A22", "x40", 1, 0.1);
  changed.local_digest = "other";
  changed.ours.honest.validated = 49;
  const RunRecord alone = Attack("A22", "x40", 2, 0.1);  // Nothing to compare with.
  const Summary s = Summarise({plain, changed, alone});
  EXPECT_EQ(s.attacks[0].digests_compared, 1);
  EXPECT_EQ(s.attacks[0].digests_changed, 1);
  EXPECT_NEAR(*s.attacks[0].validated_ratio, 0.5, 1e-12);
  const auto targets = JudgeTargets(s);
  EXPECT_FALSE(Find(targets, "LOCAL digest")->is_met());
  EXPECT_FALSE(Find(targets, "A22")->is_met());
}

TEST(Summary, TheScoreIsTheWeakestAttacksAndA28IsNone) {
  const Summary s =
      Summarise({Attack("A5", "offset_20_70m", 1, 0.0), Attack("A8", "jump_10m", 1, 5.0),
                 Attack("A28", "2m", 1, std::nullopt), Record(Kind::kHonest, "H1", "", 1)});
  EXPECT_EQ(s.weakest, "A8");
  EXPECT_NEAR(*s.score, 100.0 * (0.4 + 0.3 * std::exp(-1.0) + 0.3) * 0.98, 1e-9);
}

TEST(Targets, AreTheWorstVariantsAndNeverMeansMissed) {
  const Summary s = Summarise(
      {Attack("A5", "offset_20_70m", 1, 1.0), Attack("A5", "veremi_250_150", 1, std::nullopt),
       Attack("A5", "lateral_3m", 1, std::nullopt), Attack("A6", "random_300m", 1, 1.2)});
  const auto targets = JudgeTargets(s);
  const Target* offset = Find(targets, "met p95 [s], A5");
  ASSERT_NE(offset, nullptr);
  EXPECT_TRUE(offset->is_censored);
  EXPECT_FALSE(offset->is_met());
  EXPECT_EQ(offset->worst, "A5/veremi_250_150");
  const Target* random = Find(targets, "met p95 [s], A6");
  EXPECT_EQ(random->value, 1.2);
  EXPECT_TRUE(random->is_met());
  EXPECT_TRUE(Find(targets, "F1, A6")->is_met());  // 0.995.
  EXPECT_EQ(Find(targets, "A9"), nullptr);         // Not tried.
  EXPECT_FALSE(Find(targets, "LOCAL")->value);     // Nothing to compare with.
}

TEST(Targets, HonestConditionsHaveTheirs) {
  RunRecord h1 = Record(Kind::kHonest, "H1", "", 1);
  RunRecord h4 = Record(Kind::kHonest, "H4", "", 1);
  h4.ours.honest.validated = 85;
  RunRecord h3 = Record(Kind::kHonest, "H3", "", 1);
  h3.ours.honest.accusations = 1;
  const auto targets = JudgeTargets(Summarise({h1, h3, h4}));
  EXPECT_NEAR(*Find(targets, "accusations per honest")->value, 1.0 / 0.3, 1e-9);
  EXPECT_FALSE(Find(targets, "accusations per honest")->is_met());
  EXPECT_NEAR(*Find(targets, "per vehicle-hour, H3")->value, 10.0, 1e-9);
  EXPECT_TRUE(Find(targets, "each condition but")->is_met());
  EXPECT_EQ(Find(targets, "validated share, H4")->value, 0.85);
  EXPECT_TRUE(Find(targets, "validated share, H4")->is_met());
  EXPECT_TRUE(Find(targets, "survived")->is_met());
}

TEST(SummaryJson, HasTheFieldsThatWereAgreed) {
  const auto json = nlohmann::json::parse(SummaryJson(
      Summarise({Attack("A5", "lateral_3m", 1, std::nullopt), Attack("A5", "lateral_8m", 1, 1.0),
                 Record(Kind::kHonest, "H1", "", 1)})));
  const auto& attack = json.at("attacks").at(0);
  for (const char* key :
       {"id", "runs", "withdraw_rate", "withdraw_p50_s", "withdraw_p95_s", "accuse_rate",
        "precision", "recall", "f1", "f1_low", "f1_high", "exposure_max_m", "ghost_publications"}) {
    EXPECT_TRUE(attack.contains(key)) << key;
    EXPECT_TRUE(attack.at("variants").at(0).contains(key) || std::string(key) == "id") << key;
  }
  EXPECT_EQ(attack.at("withdraw_p50_s"), 1.0);
  EXPECT_TRUE(attack.at("withdraw_p95_s").is_null());
  EXPECT_TRUE(attack.at("withdraw_p95_censored"));
  const auto& honest = json.at("honest").at(0);
  for (const char* key : {"id", "vehicle_hours", "accusations_per_vehicle_hour", "withdrawn_share",
                          "validated_share", "bridging_survival"}) {
    EXPECT_TRUE(honest.contains(key)) << key;
  }
  EXPECT_TRUE(json.contains("score"));
}

evaluation::WarnTally Warned(int lies_v2v, int lies_ours) {
  evaluation::WarnTally tally;
  tally.runs = 1;
  tally.v2v.urgent_by_lie = tally.v2v.urgent_false = lies_v2v;
  tally.ours.urgent_by_lie = tally.ours.urgent_false = lies_ours;
  return tally;
}

TEST(Summary, HasTheWarningsOfThreeConsumersForEveryAttack) {
  RunRecord a = Attack("A1", "ahead_15m", 1, 1.0), b = Attack("A1", "ahead_30m", 1, 1.0);
  a.warnings = Warned(3, 0);
  b.warnings = Warned(1, 0);
  const Summary s = Summarise({a, b});
  ASSERT_TRUE(s.attacks[0].warnings);
  EXPECT_EQ(s.attacks[0].warnings->runs, 2);
  EXPECT_EQ(s.attacks[0].warnings->v2v.urgent_by_lie, 4);
  EXPECT_EQ(s.attacked_warnings->v2v.urgent_by_lie, 4);
  const auto json = nlohmann::json::parse(SummaryJson(s));
  const auto& warnings = json.at("attacks").at(0).at("variants").at(0).at("warnings");
  for (const char* consumer : {"v2v", "local", "ours"}) {
    for (const char* key : {"true", "late", "false", "missed", "urgent_by_lie", "planner_contacts",
                            "driver_contacts", "planner_needless", "driver_needless"}) {
      EXPECT_TRUE(warnings.at(consumer).contains(key)) << consumer << " " << key;
    }
  }
  EXPECT_EQ(warnings.at("v2v").at("urgent_by_lie"), 3);
  EXPECT_THAT(SummaryTable(s, false), HasSubstr("V2V alone"));
  EXPECT_THAT(ReportHtml(s), HasSubstr("<h2>Warnings</h2>"));
  EXPECT_TRUE(Find(JudgeTargets(s), "URGENT caused by a lie")->is_met());
  a.warnings = Warned(3, 1);
  EXPECT_FALSE(Find(JudgeTargets(Summarise({a, b})), "URGENT caused by a lie")->is_met());
  EXPECT_FALSE(
      Find(JudgeTargets(Summarise({Attack("A1", "ahead_15m", 1, 1.0)})), "URGENT caused by a lie")
          ->value);
}

TEST(Summary, ComparesGospaWithTheSameRunWithoutAttack) {
  RunRecord plain = Record(Kind::kPlain, "", "", 1);
  RunRecord attacked = Attack("A1", "ahead_15m", 1, 1.0);
  plain.ours.gospa = {10.0, 2.0, 3.0};
  attacked.ours.gospa = {10.0, 6.0, 3.2};
  const Summary s = Summarise({plain, attacked, Attack("A1", "ahead_15m", 2, 1.0)});
  const auto& gospa = s.attacks[0].gospa;
  ASSERT_TRUE(gospa);
  EXPECT_EQ(gospa->runs, 1);
  EXPECT_NEAR(*gospa->averted(), 0.95, 1e-9);
  const auto json = nlohmann::json::parse(SummaryJson(s)).at("attacks").at(0).at("gospa");
  EXPECT_NEAR(json.at("v2v").at("ratio").get<double>(), 3.0, 1e-9);
  EXPECT_NEAR(json.at("local").at("ratio").get<double>(), 1.0, 1e-9);
}

TEST(Summary, SaysHowWellAttackersAndPhantomsAreNamed) {
  RunRecord ghost = Attack("A1", "ahead_15m", 1, 1.0);
  ghost.ours.attackers[0].accused_after_s = 2.0;
  ghost.ours.honest.senders = 9;
  ghost.ours.honest.accused = 1;
  ghost.ours.by_source = {1, 1, 0, 8};
  const Summary s = Summarise({ghost, Attack("A5", "lateral_8m", 1, std::nullopt)});
  EXPECT_NEAR(*s.attacks[0].named_accuracy(), 0.9, 1e-9);
  EXPECT_NEAR(*s.phantom_messages.recall(), 0.99, 1e-9);
  EXPECT_EQ(s.phantom_messages.true_positive, 99);  // A5 is no phantom.
  const auto json = nlohmann::json::parse(SummaryJson(s));
  EXPECT_NEAR(json.at("attacks").at(0).at("agent_accuracy").get<double>(), 0.9, 1e-9);
  EXPECT_NEAR(json.at("phantoms").at("by_source").at("false_positive_rate").get<double>(), 1.0 / 9,
              1e-9);
}

TEST(Report, ShowsEveryAttackOnceInItsFamilyAndIsSelfContained) {
  RunRecord drift = Attack("A7", "lateral_0.5mps", 1, 3.0, 2.0);
  drift.ours.exposure.curve_m = {0.0, 2.0};
  drift.ours.checks_by_message = evaluation::Confusion{10, 5, 90, 95};
  const std::string html = ReportHtml(Summarise(
      {drift, Attack("my<own>", "", 1, std::nullopt), Record(Kind::kHonest, "H1", "", 1)}));
  EXPECT_THAT(html, HasSubstr("<h2>Slow drift</h2>"));
  EXPECT_THAT(html, HasSubstr("<h2>Others</h2>"));
  EXPECT_THAT(html, HasSubstr("my&lt;own&gt;"));
  EXPECT_THAT(html, HasSubstr("Against the field"));
  EXPECT_THAT(html, HasSubstr("clip-drift-time-A7"));
  EXPECT_THAT(html, testing::Not(HasSubstr("<h2>Ghosts</h2>")));
  for (const char* outside : {"src=", "href=", "<script", "url(http", "<link", "@import"}) {
    EXPECT_THAT(html, testing::Not(HasSubstr(outside)));
  }
}

TEST(Families, HoldEveryAttackOnce) {
  std::vector<std::string> ids, all;
  for (const Family& family : Families())
    ids.insert(ids.end(), family.ids.begin(), family.ids.end());
  for (int i = 1; i <= 28; ++i) all.push_back("A" + std::to_string(i));
  EXPECT_THAT(ids, testing::UnorderedElementsAreArray(all));
  EXPECT_EQ(PublishedF1("A6/random_20_70m"), 0.962);
  EXPECT_FALSE(PublishedF1("A1/ahead_15m"));
}

TEST(SummaryTable, NamesWhatIsMissed) {
  const std::string table = SummaryTable(Summarise({Attack("A6", "random_35m", 1, 4.0)}), true);
  EXPECT_THAT(table, HasSubstr("MISSED"));
  EXPECT_THAT(table, HasSubstr("4.00 (A6/random_35m)"));
  EXPECT_THAT(table, HasSubstr("against the field"));
}

}  // namespace
}  // namespace v2vouch::campaign
