// SPDX-License-Identifier: Apache-2.0
#include "sim/campaign/job.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <set>

namespace v2vouch::campaign {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> Names(const std::vector<Overlay>& overlays) {
  std::vector<std::string> names;
  for (const Overlay& overlay : overlays) names.push_back(overlay.name());
  return names;
}

class Catalogue : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("job_test_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
    for (const char* name : {"A11_grid_5", "A05_lateral_8m", "A05_lateral_12m", "A02_sudden_stop",
                             "H01_bias", "readme", "Axe"}) {
      Write(std::string(name) + ".yaml", "description: x\n");
    }
    Write("H11_dense.yaml", "traffic: {vehicles: 60}\n");
    std::vector<std::filesystem::path> files;
    for (const auto& file : std::filesystem::directory_iterator(folder_)) files.push_back(file);
    catalogue_ = ReadCatalogue(files);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  void Write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
  }
  std::vector<std::string> Chosen(const std::string& list, Kind kind = Kind::kAttack) {
    problems_.clear();
    return Names(Select(list, kind, catalogue_, problems_));
  }

  std::filesystem::path folder_;
  std::vector<Overlay> catalogue_;
  std::vector<std::string> problems_;
};

TEST_F(Catalogue, FileNamesSayWhatTheyAre) {
  EXPECT_THAT(Names(catalogue_), ElementsAre("A2/sudden_stop", "A5/lateral_12m", "A5/lateral_8m",
                                             "A11/grid_5", "H1/bias", "H11/dense"));
  EXPECT_EQ(catalogue_[0].kind, Kind::kAttack);
  EXPECT_EQ(catalogue_[4].kind, Kind::kHonest);
  EXPECT_FALSE(catalogue_[4].sets_density);
  EXPECT_TRUE(catalogue_[5].sets_density);
}

TEST_F(Catalogue, IdsVariantsFileNamesAllAndPathsAreUnderstood) {
  EXPECT_THAT(Chosen("A5"), ElementsAre("A5/lateral_12m", "A5/lateral_8m"));
  EXPECT_THAT(Chosen("A05,A2"), ElementsAre("A5/lateral_12m", "A5/lateral_8m", "A2/sudden_stop"));
  EXPECT_THAT(Chosen("A5/lateral_8m,A5"), ElementsAre("A5/lateral_8m", "A5/lateral_12m"));
  EXPECT_THAT(Chosen("A05_lateral_8m"), ElementsAre("A5/lateral_8m"));
  EXPECT_EQ(Chosen("all").size(), 4u);
  EXPECT_THAT(Chosen("all", Kind::kHonest), ElementsAre("H1/bias", "H11/dense"));
  EXPECT_THAT(Chosen("none"), IsEmpty());
  EXPECT_THAT(problems_, IsEmpty());
  Write("my_lie.yaml", "{}\n");
  EXPECT_THAT(Chosen((folder_ / "my_lie.yaml").string()), ElementsAre("my_lie"));
  EXPECT_THAT(problems_, IsEmpty());
}

TEST_F(Catalogue, WhatMeansNothingIsNamed) {
  for (const char* wrong : {"A6", "A5/lateral_9m", "H1", "hello", "A", "nosuch.yaml"}) {
    EXPECT_THAT(Chosen(wrong), IsEmpty()) << wrong;
    EXPECT_THAT(problems_, ElementsAre(HasSubstr(wrong))) << wrong;
  }
}

TEST_F(Catalogue, APlanRunsEverythingAndItsPlainCounterpart) {
  Plan plan;
  plan.overlays = Select("A5", Kind::kAttack, catalogue_, problems_);
  const auto honest = Select("all", Kind::kHonest, catalogue_, problems_);
  plan.overlays.insert(plan.overlays.end(), honest.begin(), honest.end());
  plan.scenarios = {"urban", "my/highway.yaml"};
  plan.densities = {5, 20};
  plan.first_seed = 401;
  plan.seeds = 3;
  const auto jobs = Jobs(plan);
  // Plain, two of A5 and H1 at two densities, H11 at its own: 9 per scenario and seed.
  EXPECT_EQ(jobs.size(), 3u * 2u * 9u);
  std::set<std::string> keys;
  for (const Job& job : jobs) keys.insert(job.key());
  EXPECT_EQ(keys.size(), jobs.size());
  EXPECT_EQ(jobs[0].key(), "plain.urban.d5.s401");
  EXPECT_EQ(jobs[1].key(), "A5-lateral_12m.urban.d5.s401");
  EXPECT_TRUE(keys.contains("H11-dense.highway.d0.s403"));
  plan.with_plain = false;
  EXPECT_EQ(Jobs(plan).size(), 3u * 2u * 7u);
}

TEST_F(Catalogue, AnOverlayRunsOnlyWhereItSuits) {
  Write("H09_turns.yaml", "suits: [urban]\n");
  Plan plan;
  plan.overlays = Select((folder_ / "H09_turns.yaml").string(), Kind::kHonest, {}, problems_);
  plan.scenarios = {"highway", "my/urban.yaml"};
  plan.densities = {5};
  plan.seeds = 2;
  const auto jobs = Jobs(plan);
  ASSERT_EQ(jobs.size(), 2u);
  EXPECT_EQ(jobs[0].scenario_name(), "urban");
}

TEST_F(Catalogue, ShardsShareOutAllJobs) {
  Plan plan;
  plan.overlays = Select("all", Kind::kAttack, catalogue_, problems_);
  plan.scenarios = {"urban"};
  plan.densities = {0};
  plan.seeds = 3;
  const auto jobs = Jobs(plan);
  std::multiset<std::string> shared, all;
  for (const Job& job : jobs) all.insert(job.key());
  for (std::size_t i = 1; i <= 4; ++i) {
    for (const Job& job : Shard(jobs, i, 4)) shared.insert(job.key());
  }
  EXPECT_EQ(shared, all);
}

TEST(Jobs, WithoutOverlaysThePlainRunsAreThePlan) {
  Plan plan;
  plan.scenarios = {"urban"};
  plan.densities = {0};
  ASSERT_EQ(Jobs(plan).size(), 1u);
  EXPECT_EQ(Jobs(plan)[0].overlay.kind, Kind::kPlain);
  plan.with_plain = false;  // Then nothing was asked for.
  EXPECT_TRUE(Jobs(plan).empty());
}

}  // namespace
}  // namespace v2vouch::campaign
