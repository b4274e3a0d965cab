// SPDX-License-Identifier: Apache-2.0
// What all programs have in common: results that go nowhere are a failure, a wrong LCM URL is
// named, outputs harm nothing that stands where they go.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/support/child_process.h"

namespace v2vouch {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const char* const kPrograms[] = {
    "v2vouchd",         "v2vouch-replay",        "v2vouch-sim",    "v2vouch-eval",
    "v2vouch-campaign", "v2vouch-calibrate",     "v2vouch-import", "v2vouch-detect",
    "v2vouch-annotate", "v2vouch-bench-tracker", "v2vouch-obu",    "v2vouch-baseline",
    "v2vouch-view",     "v2vouch-sift",          "v2vouch-radio",  "v2vouch-doctor",
    "v2vouch-log",      "v2vouch-mcap",          "v2vouch-spy",    "v2vouch-warn"};

class Programs : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("V2VOUCH_BIN") == nullptr) GTEST_SKIP() << "SKIPPED: V2VOUCH_BIN is not set";
    bin_ = std::string(std::getenv("V2VOUCH_BIN")) + "/";
    std::string pattern = (fs::temp_directory_path() / "programs_XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  void TearDown() override {
    if (!folder_.empty()) fs::remove_all(folder_);
  }
  [[nodiscard]] std::string Path(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] Finished Run(const std::string& line) const {
    return Execute("cd " + folder_.string() + " && " + bin_ + line);
  }
  // Both streams of a program whose standard output goes elsewhere.
  [[nodiscard]] Finished Into(const std::string& output, const std::string& line) const {
    return Run(line + " 2>&1 >" + output);
  }
  static std::string TextOf(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  std::string bin_;
  fs::path folder_;
};

TEST_F(Programs, ResultsThatStandardOutputDoesNotTakeAreExitCode1AndSaid) {
  for (const std::string program : kPrograms) {
    for (const char* line : {" --help", " --version"}) {
      const Finished full = Into("/dev/full", program + line);
      EXPECT_EQ(full.code, 1) << program << line;
      EXPECT_THAT(full.output, HasSubstr(program + ": standard output: No space left"));
      const Finished closed = Into("&-", program + line);
      EXPECT_EQ(closed.code, 1) << program << line;
      EXPECT_THAT(closed.output, HasSubstr(program + ": standard output: "));
      EXPECT_EQ(Into("/dev/null", program + line).code, 0) << program << line;
    }
  }
  EXPECT_EQ(Into("/dev/full", "v2vouch-sim list").code, 1);
  EXPECT_EQ(Into("/dev/full", "v2vouchd --print-config").code, 1);
  EXPECT_EQ(Into("/dev/full", "v2vouch-bench-tracker --generate 5 --frames 30 --json").code, 1);
}

// `| head`, a pager that was closed. Whoever writes into a pipe without a reader says nothing, and
// its exit code is that of its work.
TEST_F(Programs, AReaderThatGoesAwayIsNoFailure) {
  ASSERT_EQ(Run("v2vouch-sim run left_turn --duration 6 --out a.lcm").code, 0);
  ASSERT_EQ(Run("v2vouch-replay a.lcm --out b.lcm").code, 0);
  const auto quiet = [&](const std::string& line) {
    const std::string shell = "bash -c '(sleep 0.05; exec " + bin_ + line +
                              ") 2>said.txt | true; echo ${PIPESTATUS[0]}; cat said.txt'";
    return Execute("cd " + folder_.string() + " && " + shell).output;
  };
  for (const std::string program : kPrograms) {
    EXPECT_EQ(quiet(program + " --help"), "0\n") << program;
  }
  for (const char* line :
       {"v2vouch-log to-csv b.lcm TRACKS_LOCAL --field tracks.x_body_m", "v2vouch-log info b.lcm",
        "v2vouch-log info b.lcm --json", "v2vouch-spy b.lcm --once", "v2vouch-spy b.lcm --json",
        "v2vouch-spy b.lcm --channel TRACKS_LOCAL", "v2vouch-sim list", "v2vouch-sim list --json",
        "v2vouchd --print-config", "v2vouchd --print-config-keys", "v2vouch-warn b.lcm --json",
        "v2vouch-bench-tracker --generate 3 --frames 30 --json"}) {
    EXPECT_EQ(quiet(line), "0\n") << line;
  }
  // What fails, fails and says so as ever.
  EXPECT_EQ(quiet("v2vouch-log to-csv b.lcm TRACKS_LOCAL --field nothing").substr(0, 2), "1\n");
}

// What prints much stops when nobody reads it: here its input never ends.
TEST_F(Programs, ACaptureWithoutEndEndsWithItsReader) {
  const Finished head = Execute("yes '(1) 001425' | timeout 10 " + bin_ +
                                "v2vouch-obu --decode /dev/stdin 2>&1 | head -3");
  EXPECT_EQ(head.code, 0);
  const Finished code = Execute("bash -c 'yes 001425 | timeout 10 " + bin_ +
                                "v2vouch-obu --decode /dev/stdin | head -3 >/dev/null; "
                                "echo ${PIPESTATUS[1]}'");
  EXPECT_EQ(code.output, "0\n");
}

TEST_F(Programs, WithStderrFullOrClosedTheyWorkAsEver) {
  for (const char* redirection : {" 2>/dev/full", " 2>&-", " <&- 2>&-"}) {
    const Finished sim =
        Run(std::string("v2vouch-sim run smoke --duration 1 --out a.lcm --json") + redirection);
    EXPECT_EQ(sim.code, 0) << redirection;
    const Finished replay =
        Run(std::string("v2vouch-replay a.lcm --out b.lcm --json") + redirection);
    EXPECT_EQ(replay.code, 0) << redirection;
    EXPECT_THAT(replay.output, HasSubstr("\"digest_local\""));
    // Nothing meant for stderr has got into a file.
    EXPECT_EQ(TextOf(Path("a.lcm")).substr(0, 4), "\xED\xA1\xDA\x01");
  }
}

TEST_F(Programs, AWrongLcmUrlIsNamedByEach) {
  for (const std::string program : kPrograms) {
    const std::string command = program == "v2vouch-sim"   ? " run smoke --live"
                                : program == "v2vouch-log" ? " record folder"
                                                           : "";
    // These have no such option.
    if (program == "v2vouch-import" || program == "v2vouch-baseline" || program == "v2vouch-sift") {
      continue;
    }
    const Finished wrong = Run(program + command + " -l tcpq:// 2>&1");
    EXPECT_EQ(wrong.code, 2) << program;
    EXPECT_THAT(wrong.output, HasSubstr("has no port")) << program;
  }
  const Finished environment =
      Execute("LCM_DEFAULT_URL=udpm://1.2.3.4:1 " + bin_ + "v2vouch-sim run smoke --live 2>&1");
  EXPECT_EQ(environment.code, 2);
  EXPECT_THAT(environment.output, HasSubstr("must be a multicast address"));
}

// What was asked for and is not there: said with what is, and never with exit code 0.
TEST_F(Programs, AskedForWhatIsNotThereTheySayWhatIs) {
  ASSERT_EQ(Run("v2vouch-sim run smoke --duration 1 --out a.lcm").code, 0);
  const auto says = [&](const std::string& line, int code, const std::string& text) {
    const Finished done = Run(line + " 2>&1");
    EXPECT_EQ(done.code, code) << line << "\n" << done.output;
    EXPECT_THAT(done.output, HasSubstr(text)) << line;
  };
  says("v2vouch-spy a.lcm --channel RADAR_FORNT", 1, "did you mean RADAR_FRONT?");
  says("v2vouch-log filter a.lcm --only BSN --out b.lcm", 1, "BSN (did you mean BSM?)");
  says("v2vouch-log cut a.lcm --from 50 --to 60 --out b.lcm", 1, "it lasts");
  says("v2vouch-log cut a.lcm --from 5 --to 3 --out b.lcm", 2, "--to must be above --from");
  says("v2vouch-replay a.lcm --out ''", 2, "--out: is empty");
  says("v2vouch-eval a.lcm --report ''", 2, "--report: is empty");
  says("v2vouch-sim run smoke --seed -1 --out b.lcm", 2, "must not be negative");
  says("v2vouch-sim run smoke --duration 0 --out b.lcm", 2, "must be a number above 0");
  says("v2vouch-radio --config missing.yaml", 2, "missing.yaml: No such file");
  EXPECT_EQ(Run("v2vouch-radio --config missing.yaml 2>&1").output.find("at least two"),
            std::string::npos);
  if (!fs::exists(bin_ + "v2vouch-view")) return;  // Built where Boost is.
  says("v2vouch-view missing.lcm", 1, "missing.lcm: No such file");
  says("v2vouch-view --bind nonsense", 2, "nonsense: must be an IPv4 or IPv6 address");
  says("v2vouch-view --port 99999", 2, "--port: Value 99999 not in range 0 to 65535");
}

// Nobody listens at that address. liblcm 1.3.1 gives select() a descriptor of -1 there.
TEST_F(Programs, ATcpqServerThatIsNotThereAbortsNobody) {
  for (const std::string line :
       {"v2vouchd --no-state", "v2vouch-sim run smoke --duration 1 --live", "v2vouch-view --port 0",
        "v2vouch-warn", "v2vouch-doctor --seconds 0.5", "v2vouch-log record logs",
        "v2vouch-radio --car 0:0:127.0.0.1:5398 --car 1:0"}) {
    const std::string program = line.substr(0, line.find(' '));
    if (!fs::exists(bin_ + program)) continue;
    const Finished done = Execute("cd " + folder_.string() + " && timeout -s INT 2 " + bin_ + line +
                                  " -l tcpq://127.0.0.1:1 > out.txt 2>&1; echo code $?");
    EXPECT_THAT(TextOf(Path("out.txt")), ::testing::Not(HasSubstr("terminated"))) << line;
    EXPECT_THAT(done.output, ::testing::Not(HasSubstr("code 134"))) << line;
  }
}

TEST_F(Programs, OutputsHarmNothing) {
  ASSERT_EQ(Run("v2vouch-sim run smoke --duration 1 --out a.lcm").code, 0);
  const std::string log = TextOf(Path("a.lcm"));
  // The input, under its name, another one or through a link.
  fs::create_hard_link(Path("a.lcm"), Path("hard.lcm"));
  fs::create_symlink("a.lcm", Path("soft.lcm"));
  for (const char* out : {"a.lcm", "./a.lcm", "hard.lcm", "soft.lcm"}) {
    const Finished replay = Run("v2vouch-replay a.lcm --out " + std::string(out) + " 2>&1");
    EXPECT_EQ(replay.code, 1) << out;
    EXPECT_THAT(replay.output, ::testing::AnyOf(HasSubstr("is the file that is being read"),
                                                HasSubstr("is a symbolic link to a.lcm")));
    EXPECT_EQ(TextOf(Path("a.lcm")), log) << out;
  }
  const Finished calibrate = Run("v2vouch-calibrate a.lcm --out a.lcm 2>&1");
  EXPECT_EQ(calibrate.code, 1);
  EXPECT_THAT(calibrate.output, HasSubstr("is the file that is being read"));
  std::ofstream(Path("scenario.yaml")) << "traffic: {}\n";
  ASSERT_EQ(Run("v2vouch-bench-tracker --generate 3 --frames 30 --out t.csv").code, 0);
  const std::string table = TextOf(Path("t.csv"));
  EXPECT_EQ(Run("v2vouch-bench-tracker t.csv --rotate 1 --out t.csv 2>&1").code, 1);
  EXPECT_EQ(TextOf(Path("t.csv")), table);

  // Devices stay devices; a full one is a failure.
  for (const char* line :
       {"v2vouch-sim run smoke --duration 1 --out ", "v2vouch-replay a.lcm --out ",
        "v2vouch-bench-tracker --generate 3 --frames 30 --out "}) {
    EXPECT_EQ(Run(std::string(line) + "/dev/null").code, 0) << line;
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
    const Finished full = Run(std::string(line) + "/dev/full 2>&1");
    EXPECT_EQ(full.code, 1) << line;
    EXPECT_THAT(full.output, HasSubstr("No space left")) << line;
    EXPECT_TRUE(fs::is_character_file("/dev/full"));
    const Finished nowhere = Run(std::string(line) + "none/x 2>&1");
    EXPECT_EQ(nowhere.code, 1) << line;
    EXPECT_THAT(nowhere.output, HasSubstr("none")) << line;
  }
  // Into a pipe, as one would.
  EXPECT_EQ(Run("v2vouch-sim run smoke --duration 1 --out /dev/stdout --json | head -c 4").output,
            "\xED\xA1\xDA\x01");
}

// A program that was taken out of build/release/bin alone.
TEST_F(Programs, WithoutTheirShippedFilesTheySayWhereTheyLooked) {
  for (const char* name : {"v2vouch-sim", "v2vouch-campaign"}) {
    fs::create_directories(folder_ / "bin");
    fs::copy_file(bin_ + name, folder_ / "bin" / name);
  }
  const std::string place = "no folder " + fs::canonical(folder_).string() + "/share/v2vouch/";
  for (const char* line : {"v2vouch-sim run left_turn --out a.lcm", "v2vouch-sim list",
                           "v2vouch-campaign --attacks A5 --out study --scenarios smoke"}) {
    const Finished alone =
        Execute("cd " + folder_.string() + " && unset V2VOUCH_SHARE; bin/" + line + " 2>&1");
    EXPECT_NE(alone.code, 0) << line;
    EXPECT_THAT(alone.output, HasSubstr(place)) << line;
    EXPECT_THAT(alone.output, HasSubstr("V2VOUCH_SHARE")) << line;
  }
}

TEST_F(Programs, AStopIsHeardWithinASecond) {
  ASSERT_EQ(Run("v2vouch-sim run left_turn --duration 30 --out a.lcm").code, 0);
  for (const char* line : {"v2vouch-replay a.lcm --out b.lcm",
                           "v2vouch-sim run left_turn --out c.lcm", "v2vouch-eval a.lcm"}) {
    const Finished stopped = Execute("cd " + folder_.string() + " && timeout -k 1.2 0.2 " + bin_ +
                                     line + " >/dev/null 2>&1");
    EXPECT_NE(stopped.code, 137) << line;  // Had to be killed.
  }
}

}  // namespace
}  // namespace v2vouch
