// SPDX-License-Identifier: Apache-2.0
// v2vouch-campaign as its users meet it, with the real simulator, core and evaluator.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace v2vouch::campaign {
namespace {

class V2vouchCampaign : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("v2vouch_campaign_test_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string Path(const std::string& name) const {
    return (folder_ / name).string();
  }
  [[nodiscard]] std::string Content(const std::string& name) const {
    std::ifstream file(folder_ / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  // Standard output goes to `out`, standard error to err.
  [[nodiscard]] int ExitCode(const std::string& arguments, const std::string& out = "out") const {
    const std::string command = std::string("'") + V2VOUCH_CAMPAIGN + "' " + arguments + " >" +
                                Path(out) + " 2>" + Path("err");
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  const std::string tiny_ = "--attacks none --scenarios smoke ";
  std::filesystem::path folder_;
};

TEST_F(V2vouchCampaign, TellsUsageErrorsFromFailures) {
  EXPECT_EQ(ExitCode("--help"), 0);
  EXPECT_EQ(ExitCode("--version"), 0);
  EXPECT_EQ(ExitCode("--attacks none"), 2);
  EXPECT_EQ(ExitCode("--attacks A999 --out " + Path("x")), 2);
  EXPECT_NE(Content("err").find("A999"), std::string::npos);
  EXPECT_EQ(ExitCode(tiny_ + "--shard 3/2 --out " + Path("x")), 2);
  EXPECT_EQ(ExitCode("--attacks none --scenarios nosuch --out " + Path("x")), 2);
  EXPECT_EQ(ExitCode("--merge " + Path("nosuch")), 1);
}

TEST_F(V2vouchCampaign, MistypedNamesAreToldWithTheNearest) {
  const auto told = [&](const std::string& arguments, const char* hint) {
    EXPECT_EQ(ExitCode(arguments + " --out " + Path("x")), 2) << arguments;
    EXPECT_NE(Content("err").find(hint), std::string::npos) << Content("err");
  };
  told("--attacks A5/latral_8m", "did you mean A5/lateral_8m?");
  told("--attacks none --honest H11/dens", "did you mean H11/dense?");
  told("--attacks H1", "is an honest condition: --honest H1");
  told("--attacks none --scenarios campain_urban", "did you mean campaign_urban?");
  told("--atacks none", "did you mean --attacks?");
}

TEST_F(V2vouchCampaign, NothingToRunIsToldAsSuch) {
  EXPECT_EQ(ExitCode("--attacks none --no-plain --out " + Path("x")), 2);
  EXPECT_NE(Content("err").find("nothing to run"), std::string::npos) << Content("err");
  EXPECT_EQ(ExitCode(tiny_ + "--shard 2/2 --out " + Path("x")), 0);
  EXPECT_NE(Content("err").find("holds none of the runs"), std::string::npos) << Content("err");
  EXPECT_EQ(ExitCode("--merge " + Path("x")), 1);
  EXPECT_NE(Content("err").find("no runs to report"), std::string::npos) << Content("err");
}

TEST_F(V2vouchCampaign, ShardsMergedGiveTheFiguresOfTheWhole) {
  ASSERT_EQ(ExitCode(tiny_ + "--seeds 2 --jobs 2 --json --out " + Path("whole"), "whole.json"), 0);
  ASSERT_EQ(ExitCode(tiny_ + "--seeds 2 --shard 1/2 --json --out " + Path("a")), 0);
  ASSERT_EQ(ExitCode(tiny_ + "--seeds 2 --shard 2/2 --json --out " + Path("b")), 0);
  ASSERT_EQ(ExitCode("--merge " + Path("a") + " " + Path("b") + " --json", "merged.json"), 0);
  const std::string whole = Content("whole.json");
  EXPECT_NE(whole.find("\"vehicle_hours\""), std::string::npos);
  // Step times are the machine's; the figures that a report of plain runs holds are not.
  EXPECT_EQ(Content("merged.json"), whole);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "whole/tmp"));
}

// The short form of the ghost study: what no sensor ever confirmed is not published.
TEST_F(V2vouchCampaign, NoGhostIsPublishedInTheShortStudy) {
  ASSERT_EQ(ExitCode("--ghosts-only --scenarios campaign_urban --seeds 1 --first-seed 11 --jobs 2 "
                     "--json --out " +
                         Path("g"),
                     "g.json"),
            0)
      << Content("err");
  const std::string figures = Content("g.json");
  std::size_t attacks = 0;
  for (const char* id : {"A1", "A2", "A3", "A4"}) {
    attacks += figures.find("{\"id\":\"" + std::string(id) + "\",\"runs\":") != std::string::npos;
  }
  EXPECT_EQ(attacks, 4u) << figures;
}

TEST_F(V2vouchCampaign, AnotherConfigurationWantsAnotherFolder) {
  ASSERT_EQ(ExitCode(tiny_ + "--out " + Path("x")), 0);
  std::ofstream(folder_ / "own.yaml") << "v2v: {max_age_s: 1.0}\n";
  EXPECT_EQ(ExitCode(tiny_ + "--config " + Path("own.yaml") + " --out " + Path("x")), 2);
  EXPECT_NE(Content("err").find("another configuration"), std::string::npos);
  std::ofstream(folder_ / "wrong.yaml") << "v2v: {no_such_key: 1.0}\n";
  EXPECT_EQ(ExitCode(tiny_ + "--config " + Path("wrong.yaml") + " --out " + Path("y")), 2);
  EXPECT_NE(Content("err").find("no_such_key"), std::string::npos);
}

}  // namespace
}  // namespace v2vouch::campaign
