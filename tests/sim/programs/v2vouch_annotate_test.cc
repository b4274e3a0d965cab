// SPDX-License-Identifier: Apache-2.0
// v2vouch-annotate as its users meet it: a child process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/sim/import/files.h"
#include "tests/support/child_process.h"

namespace v2vouch::sim {
namespace {

using ::testing::HasSubstr;

TEST(V2vouchAnnotate, TellsUsageErrorsFromFailures) {
  const ScratchFolder folder("annotate_app");
  EXPECT_THAT(Called(V2VOUCH_ANNOTATE, "--help").output, HasSubstr("Examples:"));
  EXPECT_EQ(Called(V2VOUCH_ANNOTATE, "--version").code, 0);
  EXPECT_EQ(Called(V2VOUCH_ANNOTATE, "").code, 2);
  EXPECT_EQ(Called(V2VOUCH_ANNOTATE, "a.lcm b --every 0").code, 2);
  const Finished absent = Called(V2VOUCH_ANNOTATE, "/nowhere.lcm " + folder.path() + "/out");
  EXPECT_EQ(absent.code, 1);
  EXPECT_THAT(absent.output, HasSubstr("/nowhere.lcm"));
}

// A simulated run has boxes and no pictures: tracks on an empty road.
TEST(V2vouchAnnotate, ASimulatedRunGivesPictures) {
  const ScratchFolder folder("annotate_app");
  const std::string log = folder.path() + "/smoke.lcm";
  ASSERT_EQ(Called(V2VOUCH_SIM, "run smoke --seed 1 --out " + log).code, 0);
  ASSERT_EQ(Called(V2VOUCH_REPLAY, log + " --out " + folder.path() + "/tracks.lcm").code, 0);
  const Finished done = Called(
      V2VOUCH_ANNOTATE, folder.path() + "/tracks.lcm " + folder.path() + "/out --every 20 --json");
  EXPECT_EQ(done.code, 0) << done.output;
  EXPECT_THAT(done.output, HasSubstr("\"has_images\":false"));
  EXPECT_GT(std::filesystem::file_size(folder.path() + "/out/000000.png"), 1000u);
  EXPECT_TRUE(std::filesystem::exists(folder.path() + "/out/000002.png"));
}

}  // namespace
}  // namespace v2vouch::sim
