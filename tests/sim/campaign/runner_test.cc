// SPDX-License-Identifier: Apache-2.0
// The runner with stand-ins for the three programs: shell scripts.
#include "sim/campaign/runner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <thread>

#include "sim/spoofing/spoof_json.h"

namespace v2vouch::campaign {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class Runner : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("runner_test_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_ / "bin");
    std::filesystem::create_directories(folder_ / "tmp");
    settings_.programs = folder_ / "bin";
    settings_.folder = folder_ / "out";
    settings_.scratch = folder_ / "tmp";
    settings_.config = folder_ / "vehicle.yaml";
    settings_.at_a_time = 2;
    // The simulator writes its log and keeps a list of its calls; seed 3 may be made to fail.
    Script("v2vouch-sim", "echo \"$@\" >> " + Path("calls") + "\nfor a; do last=$a; done\n" +
                              "touch \"$last\"\n" + "case \"$*\" in *'--seed 3 '*) [ -e " +
                              Path("broken") +
                              " ] && { echo 'scenario: no road' >&2; exit 1; };; esac\nexit 0\n");
    Script("v2vouch-replay",
           "touch \"$5\"\necho '{\"digest_local\":\"abc\",\"step_us\":{\"p99\":7,\"max\":9}}'\n");
    evaluation::SpoofRun run;
    run.by_message.true_positive = 5;
    Script("v2vouch-eval", "cat <<'X'\n" + evaluation::SpoofJson(run) + "X\n");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string Path(const std::string& name) const {
    return (folder_ / name).string();
  }
  void Script(const std::string& name, const std::string& text) {
    const auto path = folder_ / "bin" / name;
    std::ofstream(path) << "#!/bin/sh\n" << text;
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  }
  std::vector<Job> SomeJobs(int seeds) {
    Plan plan;
    plan.overlays = {{Kind::kAttack, "A5", "lateral_8m", "/x/A05.yaml", false}};
    plan.scenarios = {"urban"};
    plan.densities = {20};
    plan.seeds = seeds;
    plan.with_plain = false;
    return Jobs(plan);
  }
  Tally Go(const std::vector<Job>& jobs) {
    Children children;
    told_.clear();
    return RunAll(
        jobs, settings_, children, [](const Tally&) {},
        [&](const std::string& what) { told_.push_back(what); });
  }
  [[nodiscard]] std::size_t Calls() const {
    std::ifstream file(folder_ / "calls");
    return static_cast<std::size_t>(std::count(std::istreambuf_iterator<char>(file), {}, '\n'));
  }

  std::filesystem::path folder_;
  RunnerSettings settings_;
  std::vector<std::string> told_;
};

TEST_F(Runner, SaysWhichProgramsAreMissingBeforeTheFirstRun) {
  EXPECT_THAT(MissingPrograms(settings_), IsEmpty());
  std::filesystem::remove(folder_ / "bin" / "v2vouch-sim");
  std::filesystem::permissions(folder_ / "bin" / "v2vouch-eval", std::filesystem::perms::none);
  const auto missing = MissingPrograms(settings_);
  ASSERT_FALSE(missing.empty());
  EXPECT_EQ(missing[0], "v2vouch-sim");
}

TEST_F(Runner, EachRunLeavesOneRecordAndNoLog) {
  const auto jobs = SomeJobs(5);
  const Tally tally = Go(jobs);
  EXPECT_EQ(tally.done, 5u);
  EXPECT_EQ(tally.failed + tally.there_before + tally.left(), 0u);
  EXPECT_TRUE(std::filesystem::is_empty(settings_.scratch));
  std::vector<std::string> problems;
  const auto records = ReadRecords({settings_.folder}, problems);
  ASSERT_EQ(records.size(), 5u);
  EXPECT_EQ(records[0].job.overlay.name(), "A5/lateral_8m");
  EXPECT_EQ(records[0].job.density, 20);
  EXPECT_EQ(records[0].local_digest, "abc");
  EXPECT_EQ(records[0].step_max_us, 9.0);
  EXPECT_EQ(records[0].ours.by_message.true_positive, 5);
  EXPECT_THAT(problems, IsEmpty());
  std::ifstream calls(folder_ / "calls");
  std::string first;
  std::getline(calls, first);
  EXPECT_THAT(first, AllOf(HasSubstr("run urban --with /x/A05.yaml"),
                           HasSubstr("--set traffic.vehicles=20 --seed")));
}

TEST_F(Runner, TakesUpWhereItWasStopped) {
  Go(SomeJobs(3));
  EXPECT_EQ(Calls(), 3u);
  const Tally tally = Go(SomeJobs(5));
  EXPECT_EQ(tally.there_before, 3u);
  EXPECT_EQ(tally.done, 2u);
  EXPECT_EQ(Calls(), 5u);
}

TEST_F(Runner, AHalfWrittenRecordIsRunAgain) {
  const auto jobs = SomeJobs(1);
  Go(jobs);
  std::ofstream(RecordPath(settings_.folder, jobs[0])) << "{\"kind\": \"att";
  std::vector<std::string> problems;
  EXPECT_THAT(ReadRecords({settings_.folder}, problems), IsEmpty());
  EXPECT_THAT(problems, ElementsAre(HasSubstr("no record of a run")));
  EXPECT_EQ(Go(jobs).done, 1u);
}

TEST_F(Runner, ABrokenChildIsNamedStopsNoOtherAndIsTriedAgain) {
  std::ofstream(folder_ / "broken") << "x";
  const Tally tally = Go(SomeJobs(5));
  EXPECT_EQ(tally.done, 4u);
  EXPECT_EQ(tally.failed, 1u);
  EXPECT_THAT(told_, ElementsAre(AllOf(HasSubstr("v2vouch-sim run urban"), HasSubstr("--seed 3"),
                                       HasSubstr("exit code 1"), HasSubstr("no road"))));
  EXPECT_TRUE(std::filesystem::is_empty(settings_.scratch));
  std::filesystem::remove(folder_ / "broken");
  EXPECT_EQ(Go(SomeJobs(5)).done, 1u);
}

TEST_F(Runner, FiguresThatAreNoneAreAFailure) {
  Script("v2vouch-eval", "echo hello\n");
  EXPECT_EQ(Go(SomeJobs(1)).failed, 1u);
  EXPECT_THAT(told_, ElementsAre(HasSubstr("hello")));
}

TEST_F(Runner, AMissingProgramIsAFailure) {
  std::filesystem::remove(folder_ / "bin/v2vouch-sim");
  EXPECT_EQ(Go(SomeJobs(1)).failed, 1u);
  EXPECT_THAT(told_, ElementsAre(HasSubstr("cannot start")));
}

TEST_F(Runner, StoppingEndsWhatRunsAndBeginsNothingElse) {
  Script("v2vouch-sim", "echo x >> " + Path("calls") + "\nexec sleep 30\n");
  Children children;
  const auto begin = std::chrono::steady_clock::now();
  const Tally tally = RunAll(
      SomeJobs(8), settings_, children,
      [&](const Tally&) {
        if (Calls() >= 2) children.Stop();
      },
      [&](const std::string& what) { told_.push_back(what); });
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
  EXPECT_EQ(Calls(), 2u);
  EXPECT_EQ(tally.done + tally.failed, 0u);
  EXPECT_EQ(tally.left(), 8u);
  EXPECT_THAT(told_, IsEmpty());
}

TEST_F(Runner, AskingForTheFieldRunsAgainWhatHasNone) {
  Go(SomeJobs(2));
  settings_.paper_config = folder_ / "paper.yaml";
  EXPECT_EQ(Go(SomeJobs(2)).done, 2u);
  std::vector<std::string> problems;
  EXPECT_TRUE(ReadRecords({settings_.folder}, problems)[0].paper.has_value());
  EXPECT_EQ(Go(SomeJobs(2)).there_before, 2u);
}

TEST_F(Runner, ConfigurationsGainTheVerdictsAndKeepTheRest) {
  std::string problem;
  const auto from = folder_ / "own.yaml", to = folder_ / "to.yaml";
  std::ofstream(from) << "vehicle: {length_m: 5}\nv2v: {max_age_s: 1.0}\n";
  ASSERT_TRUE(WriteConfig(from, to, problem)) << problem;
  std::ifstream file(to);
  const std::string text(std::istreambuf_iterator<char>(file), {});
  EXPECT_THAT(text, AllOf(HasSubstr("length_m: 5"), HasSubstr("max_age_s: 1.0"),
                          HasSubstr("message_verdicts: true")));
  // What stands beside the file does not stand beside its copy.
  std::ofstream(from)
      << "calibration: cal/mine.yaml\ndetector: {model: net.onnx, network: /a.cfg}\n";
  ASSERT_TRUE(WriteConfig(from, to, problem)) << problem;
  std::ifstream copy(to);
  const std::string copied(std::istreambuf_iterator<char>(copy), {});
  EXPECT_THAT(copied, testing::HasSubstr("calibration: " + (folder_ / "cal/mine.yaml").string()));
  EXPECT_THAT(copied, testing::HasSubstr("model: " + (folder_ / "net.onnx").string()));
  EXPECT_THAT(copied, testing::HasSubstr("network: /a.cfg"));
  EXPECT_TRUE(WriteConfig("", to, problem));
  EXPECT_FALSE(WriteConfig(folder_ / "nosuch.yaml", to, problem));
  EXPECT_THAT(problem, HasSubstr("nosuch.yaml"));
}

TEST(ShellText, QuotesWhatAShellWouldChange) {
  EXPECT_EQ(ShellText({"a/b", "--x=1", "two words", "it's", ""}),
            "a/b --x=1 'two words' 'it'\\''s' ''");
}

}  // namespace
}  // namespace v2vouch::campaign
