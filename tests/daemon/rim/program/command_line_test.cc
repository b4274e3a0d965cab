// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/program/command_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace v2vouch {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::internal::CaptureStderr;
using ::testing::internal::CaptureStdout;
using ::testing::internal::GetCapturedStderr;
using ::testing::internal::GetCapturedStdout;

struct Read {
  explicit Read(std::vector<std::string> words) {
    CLI::App app("Does something.");
    int seed = 0;
    std::string mode;
    app.add_option("--seed", seed);
    app.add_option("--mode", mode)->check(OneOf({"realistic", "ideal_points"}));
    auto* const run = app.add_subcommand("run", "runs");
    run->add_flag("--live");
    app.require_subcommand(0, 1);
    words.insert(words.begin(), "path/to/v2vouch-thing");
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    CaptureStdout();
    CaptureStderr();
    code = ReadCommandLine(app, "v2vouch-thing", static_cast<int>(argv.size()), argv.data());
    out = GetCapturedStdout();
    err = GetCapturedStderr();
  }
  std::optional<int> code;
  std::string out, err;
};

TEST(ReadCommandLine, VersionAndHelpEndWell) {
  const Read version({"--version"});
  EXPECT_EQ(version.code, 0);
  EXPECT_EQ(version.out, "v2vouch-thing " V2VOUCH_VERSION "\n");
  EXPECT_EQ(Read({"--help"}).code, 0);
  EXPECT_EQ(Read({"run", "--live"}).code, std::nullopt);
}

TEST(ReadCommandLine, MistypedWordsAreNamedWithTheNearest) {
  const Read option({"--sede", "3"});
  EXPECT_EQ(option.code, 2);
  EXPECT_THAT(option.err, AllOf(HasSubstr("--sede"), HasSubstr("did you mean --seed?")));
  EXPECT_THAT(Read({"--sed=3"}).err, HasSubstr("--sed (did you mean --seed?)"));
  EXPECT_THAT(Read({"rnu"}).err, HasSubstr("rnu (did you mean run?)"));
  EXPECT_THAT(Read({"run", "--lvie"}).err, HasSubstr("did you mean --live?"));
  const Read choice({"--mode", "realsitic"});
  EXPECT_EQ(choice.code, 2);
  EXPECT_THAT(choice.err,
              HasSubstr("must be one of realistic, ideal_points (did you mean realistic?)"));
}

}  // namespace
}  // namespace v2vouch
