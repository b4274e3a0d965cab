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
    std::uint64_t first = 0;
    app.add_option("--first", first);
    double seconds = 0.0;
    app.add_option("--mode", mode)->check(OneOf({"realistic", "ideal_points"}));
    auto* const run = app.add_subcommand("run", "runs");
    run->add_flag("--live");
    std::string log;
    run->add_option("--out", log);
    run->add_option("--duration", seconds)->check(AboveZero());
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

TEST(ReadCommandLine, AnEmptyValueIsNoValue) {
  for (const std::vector<std::string>& words : {std::vector<std::string>{"--mode", ""},
                                                {"--mode="},
                                                {"--seed", ""},
                                                {"run", "--out", ""}}) {
    const Read empty(words);
    EXPECT_EQ(empty.code, 2) << words.front();
    EXPECT_FALSE(empty.err.empty());
  }
  EXPECT_THAT(Read({"run", "--out", ""}).err, HasSubstr("--out: is empty; is a shell variable"));
}

TEST(ReadCommandLine, ANumberOutsideItsRangeIsNamed) {
  const Read negative({"--first", "-1"});
  EXPECT_EQ(negative.code, 2);
  EXPECT_THAT(negative.err, HasSubstr("--first: -1: must not be negative"));
  EXPECT_EQ(Read({"--first", "1"}).code, std::nullopt);
  EXPECT_EQ(Read({"--seed", "-1"}).code, std::nullopt);
  for (const char* wrong : {"0", "-2", "x", "nan"}) {
    const Read duration({"run", "--duration", wrong});
    EXPECT_EQ(duration.code, 2) << wrong;
    EXPECT_THAT(duration.err, HasSubstr(std::string(wrong) + ": must be a number above 0"));
  }
  EXPECT_EQ(Read({"run", "--duration", "0.5"}).code, std::nullopt);
}

}  // namespace
}  // namespace v2vouch
