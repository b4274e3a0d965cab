// SPDX-License-Identifier: Apache-2.0
// v2vouch-sim as its users meet it: a child process.
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "daemon/rim/io/event_log.h"
#include "tests/support/child_process.h"

namespace v2vouch::sim {
namespace {

int ExitCode(const std::string& arguments) { return Called(V2VOUCH_SIM, arguments).code; }

class V2vouchSim : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::temp_directory_path() / ("v2vouch_sim_test_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string Path(const std::string& name) const {
    return (folder_ / name).string();
  }

  static std::vector<std::pair<std::string, std::vector<std::uint8_t>>> Messages(
      const std::string& path) {
    std::vector<std::pair<std::string, std::vector<std::uint8_t>>> messages;
    std::string error;
    const auto reader = LogReader::Open(path, error);
    EXPECT_NE(reader, nullptr) << error;
    LogEvent event;
    while (reader && reader->Next(event)) messages.emplace_back(event.channel, event.bytes);
    return messages;
  }

  std::filesystem::path folder_;
};

TEST_F(V2vouchSim, TellsUsageErrorsFromFailures) {
  EXPECT_EQ(ExitCode("--help"), 0);
  EXPECT_EQ(ExitCode("--version"), 0);
  EXPECT_EQ(ExitCode("list"), 0);
  EXPECT_EQ(ExitCode("list --json"), 0);
  EXPECT_EQ(ExitCode("run"), 2);
  EXPECT_EQ(ExitCode("run smoke"), 2);  // Neither --out nor --live.
  EXPECT_EQ(ExitCode("run nosuch --out " + Path("a.lcm")), 2);
  EXPECT_EQ(ExitCode("run smoke --set sensors.mood=odd --out " + Path("a.lcm")), 2);
  EXPECT_EQ(ExitCode("run smoke --set radio.base_loss=7 --out " + Path("a.lcm")), 2);
  EXPECT_EQ(ExitCode("run smoke --with nosuch --out " + Path("a.lcm")), 2);
  EXPECT_EQ(ExitCode("run smoke --with H11/dense --out " + Path("a.lcm")), 2);  // Has no lanes.
  EXPECT_EQ(ExitCode("run smoke --out /nonexistent/a.lcm"), 1);
}

TEST_F(V2vouchSim, MistypedNamesAreToldWithTheNearest) {
  const auto told = [&](const std::string& arguments, const char* hint) {
    const Finished done = Called(V2VOUCH_SIM, arguments + " --out " + Path("a.lcm"));
    EXPECT_EQ(done.code, 2) << arguments;
    EXPECT_NE(done.output.find(hint), std::string::npos) << done.output;
  };
  told("run left_trun", "did you mean left_turn?");
  told("run smoke --with A5/latral_8m", "did you mean A5/lateral_8m?");
  told("run smoke --with H11_dnse", "did you mean H11_dense?");
  told("run smoke --sensors realsitic", "did you mean realistic?");
  told("run smoke --set radio.base_los=0", "did you mean base_loss?");
  told("run smoke --sede 3", "did you mean --seed?");
  EXPECT_NE(Called(V2VOUCH_SIM, "rnu smoke").output.find("did you mean run?"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(Path("a.lcm")));
}

TEST_F(V2vouchSim, SettingsReachTheSimulation) {
  ASSERT_EQ(ExitCode("run smoke --duration 2 --set radio.base_loss=1 --out " + Path("a.lcm")), 0);
  for (const auto& [channel, bytes] : Messages(Path("a.lcm"))) EXPECT_NE(channel, "BSM");
}

TEST_F(V2vouchSim, OverlaysAreFoundByEitherNameAndSettingsComeAfterThem) {
  const std::string run = "run campaign_highway --duration 1 --seed 11 --set traffic.vehicles=4 ";
  ASSERT_EQ(ExitCode(run + "--with H11/dense --out " + Path("a.lcm")), 0);
  ASSERT_EQ(ExitCode(run + "--with H11_dense --out " + Path("b.lcm")), 0);
  ASSERT_EQ(ExitCode(run + "--out " + Path("c.lcm")), 0);
  const auto by_id = Messages(Path("a.lcm"));
  EXPECT_EQ(by_id, Messages(Path("b.lcm")));
  EXPECT_NE(by_id, Messages(Path("c.lcm")));  // 40 % talk, not half.
}

// LCM's own file bus stands in for a network; the wall clock paces both the same.
TEST_F(V2vouchSim, LiveSendsTheSameMessagesInRealTime) {
  ASSERT_EQ(ExitCode("run smoke --seed 3 --duration 1 --out " + Path("a.lcm")), 0);
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_EQ(
      ExitCode("run smoke --seed 3 --duration 1 --live -l 'file://" + Path("b.lcm") + "?mode=w'"),
      0);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  EXPECT_GT(wall.count(), 0.9);
  const auto offline = Messages(Path("a.lcm"));
  EXPECT_GT(offline.size(), 100u);
  EXPECT_EQ(offline, Messages(Path("b.lcm")));
}

}  // namespace
}  // namespace v2vouch::sim
