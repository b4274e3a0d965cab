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

// A log that a full disk or a kill cut off is read as far as it goes, and every program says so.
TEST(EveryProgram, ThatReadsALogTellsThatItIsCutOff) {
  const char* const bin = std::getenv("V2VOUCH_BIN");
  if (bin == nullptr) GTEST_SKIP() << "SKIPPED: V2VOUCH_BIN is not set";
  std::string folder = (std::filesystem::temp_directory_path() / "cut_off_XXXXXX").string();
  ASSERT_NE(mkdtemp(folder.data()), nullptr);
  const auto path = [&](const char* name) { return folder + "/" + name; };
  const auto call = [&](const std::string& line) {
    const std::string program = line.substr(0, line.find(' '));
    return Called(std::string(bin) + "/" + program, line.substr(program.size()));
  };
  const auto cut = [](const std::string& log) {
    std::filesystem::resize_file(log, std::filesystem::file_size(log) - 10);
  };
  const std::string drive = path("drive.lcm");
  const std::string tracks = path("tracks.lcm");
  ASSERT_EQ(call("v2vouch-sim run smoke --seed 1 --duration 4 --out " + drive).code, 0);
  ASSERT_EQ(call("v2vouch-replay " + drive + " --out " + tracks).code, 0);
  cut(drive);
  cut(tracks);
  for (const std::string& line : {
           "v2vouch-log info " + drive,
           "v2vouch-log cut " + drive + " --from 1 --to 2 --out " + path("part.lcm"),
           "v2vouch-log merge " + drive + " " + tracks + " --out " + path("both.lcm"),
           "v2vouch-log filter " + drive + " --only EGO_MOTION --out " + path("ego.lcm"),
           "v2vouch-log to-csv " + drive + " EGO_MOTION",
           "v2vouch-replay " + drive + " --out " + path("again.lcm"),
           "v2vouch-baseline " + drive + " --out " + path("base.lcm"),
           "v2vouch-sift " + drive + " --rung existence --out " + path("sifted.lcm"),
           "v2vouch-mcap " + tracks + " --out " + path("tracks.mcap"),
           "v2vouch-spy " + tracks + " --once",
           "v2vouch-spy " + tracks + " --once --channel V2VOUCH_STATUS",
           "v2vouch-warn " + tracks,
           "v2vouch-eval " + tracks + " --summary",
           "v2vouch-eval " + tracks + " --warnings",
           "v2vouch-annotate " + tracks + " " + path("pictures"),
           "v2vouch-calibrate " + drive + " --out " + path("calibration.yaml"),
       }) {
    EXPECT_THAT(call(line).output, HasSubstr("damaged stretches")) << line;
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace v2vouch
