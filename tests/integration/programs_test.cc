// SPDX-License-Identifier: Apache-2.0
// What all programs have in common, tried on every program that was built.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/child_process.h"

namespace v2vouch {
namespace {

using ::testing::HasSubstr;

std::vector<std::filesystem::path> Programs() {
  std::vector<std::filesystem::path> programs;
  const char* const folder = std::getenv("V2VOUCH_BIN");
  if (folder == nullptr) return programs;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.is_regular_file() && entry.path().filename().string().starts_with("v2vouch")) {
      programs.push_back(entry.path());
    }
  }
  std::sort(programs.begin(), programs.end());
  return programs;
}

TEST(EveryProgram, IsHere) { EXPECT_GE(Programs().size(), 10u); }

TEST(EveryProgram, TellsNameAndVersionInOneForm) {
  for (const auto& program : Programs()) {
    const Finished done = Called(program.string(), "--version");
    EXPECT_EQ(done.code, 0) << program;
    EXPECT_EQ(done.output, program.filename().string() + " " V2VOUCH_VERSION "\n");
  }
}

TEST(EveryProgram, HelpHasExamplesAndExitCodes) {
  for (const auto& program : Programs()) {
    const Finished done = Called(program.string(), "--help");
    EXPECT_EQ(done.code, 0) << program;
    for (const char* part : {"Examples:", "Exit codes:", "--version"}) {
      EXPECT_THAT(done.output, HasSubstr(part)) << program;
    }
  }
}

TEST(EveryProgram, NamesTheOptionThatWasMeantAndEndsWithUsage) {
  for (const auto& program : Programs()) {
    const Finished done = Called(program.string(), "--verison");
    EXPECT_EQ(done.code, 2) << program;
    EXPECT_THAT(done.output, HasSubstr("--verison")) << program;
    EXPECT_THAT(done.output, HasSubstr("did you mean --version?")) << program;
  }
}

}  // namespace
}  // namespace v2vouch
