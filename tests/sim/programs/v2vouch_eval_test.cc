// SPDX-License-Identifier: Apache-2.0
// v2vouch-eval as its users meet it, with logs that cannot be judged.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <v2vouch/track_list_t.hpp>
#include <v2vouch/truth_list_t.hpp>

#include "daemon/rim/io/event_log.h"
#include "daemon/rim/wire/codec.h"
#include "tests/sim/import/files.h"
#include "tests/support/child_process.h"

namespace v2vouch {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::int64_t kStart_us = 1'700'000'000'000'000;
constexpr std::int64_t kYear_us = 365LL * 86'400 * 1'000'000;

struct Content {
  int truths = 60;  ///< At 20 Hz.
  int lists = 60;
  std::int64_t truth_step_us = 0;   ///< From the middle of the truth on.
  std::int64_t lists_ahead_us = 0;  ///< Of the truth.
  bool has_car = true;
};

class Eval : public ::testing::Test {
 protected:
  template <class Message>
  void Write(std::int64_t at_us, const char* channel, const Message& message) {
    std::vector<std::uint8_t> bytes;
    wire::Encode(message, bytes);
    writer_->Write(FromMicros(at_us), channel, bytes);
  }

  std::string Log(const Content& content) {
    const std::string path = folder_.path() + "/run.lcm";
    std::string error;
    writer_ = LogWriter::Create(path, error);
    for (int k = 0; k < std::max(content.truths, content.lists); ++k) {
      const std::int64_t at_us = kStart_us + 50'000LL * k;
      if (k < content.truths) {
        truth_list_t truth{};
        truth.utime = at_us + (k >= content.truths / 2 ? content.truth_step_us : 0);
        truth.num_objects = content.has_car ? 1 : 0;
        truth.objects.resize(static_cast<std::size_t>(truth.num_objects));
        if (content.has_car) {
          truth.objects[0].id = 7;
          truth.objects[0].object_class = 1;
          truth.objects[0].x_m = 20.0;
          truth.objects[0].length_m = 4.5;
          truth.objects[0].width_m = 1.8;
        }
        Write(at_us, "TRUTH", truth);
      }
      if (k >= content.lists) continue;
      track_list_t list{};
      list.utime = at_us + content.lists_ahead_us;
      for (const char* channel : {"TRACKS_LOCAL", "TRACKS_PRIORITY"}) {
        Write(list.utime, channel, list);
      }
    }
    EXPECT_TRUE(writer_->Close(error)) << error;
    return path;
  }

  // With a bound on memory: a grid over a year would need far more.
  static Finished Judge(const std::string& log, const std::string& options = "") {
    return Execute("ulimit -v 4000000; '" V2VOUCH_EVAL "' '" + log + "' " + options + " 2>&1");
  }

  sim::ScratchFolder folder_{"eval_app"};
  std::unique_ptr<LogWriter> writer_;
};

TEST_F(Eval, WhatIsMissingIsNamedWithWhatToDo) {
  const Finished lists = Judge(Log({.lists = 0}));
  EXPECT_EQ(lists.code, 1);
  EXPECT_THAT(lists.output, AllOf(HasSubstr("no TRACKS_LOCAL"), HasSubstr("v2vouch-replay")));
  const Finished truth = Judge(Log({.truths = 0}));
  EXPECT_EQ(truth.code, 1);
  EXPECT_THAT(truth.output, AllOf(HasSubstr("no TRUTH"), HasSubstr("--summary")));
  EXPECT_EQ(Judge(Log({.truths = 0}), "--summary").code, 0);
  const Finished report = Judge(Log({.truths = 0}), "--report " + folder_.path() + "/no_truth");
  EXPECT_EQ(report.code, 0) << report.output;
  EXPECT_THAT(report.output, HasSubstr("There is no truth to judge by"));
  const Finished nothing = Judge(Log({.lists = 0}), "--summary");
  EXPECT_EQ(nothing.code, 1);
  EXPECT_THAT(nothing.output, HasSubstr("no track lists"));
  EXPECT_THAT(Judge(Log({.lists = 0}), "--spoof").output, HasSubstr("holds no"));
}

TEST_F(Eval, ALogThatIsCutOffIsJudgedAndTold) {
  const std::string log = Log({});
  EXPECT_THAT(Judge(log).output, Not(HasSubstr("damaged")));
  std::filesystem::resize_file(log, std::filesystem::file_size(log) - 10);  // Within an event.
  const Finished cut = Judge(log);
  EXPECT_EQ(cut.code, 0);
  EXPECT_THAT(cut.output, HasSubstr("run.lcm: 1 damaged stretches"));
}

TEST_F(Eval, StepsOfTheTruthsTimeAreNamedAndTakeNoMemory) {
  for (const char* options : {"", "--json", "--spoof"}) {
    const Finished year = Judge(Log({.truth_step_us = kYear_us}), options);
    EXPECT_EQ(year.code, 1);
    EXPECT_THAT(year.output,
                AllOf(HasSubstr("steps on by 365.0 days"), HasSubstr("2023-11-14 22:13"),
                      HasSubstr("2024-11-13"), HasSubstr("cut the log there")));
  }
  EXPECT_THAT(Judge(Log({.truth_step_us = -kYear_us})).output,
              HasSubstr("steps back by 365.0 days"));
  EXPECT_EQ(Judge(Log({.truth_step_us = 1LL << 62})).code, 1);
  EXPECT_EQ(Judge(Log({.truth_step_us = -kStart_us})).code, 1);
}

TEST_F(Eval, ListsOfAnotherTimeAreNotJudged) {
  const Finished done = Judge(Log({.lists_ahead_us = 3600LL * 1'000'000}));
  EXPECT_EQ(done.code, 1);
  EXPECT_THAT(done.output, HasSubstr("do not overlap in time"));
}

TEST_F(Eval, StatisticsOfNothingAreNone) {
  const std::string log = Log({.has_car = false});
  const Finished table = Judge(log, "--report " + folder_.path() + "/report");
  EXPECT_EQ(table.code, 0) << table.output;
  EXPECT_THAT(table.output, AllOf(HasSubstr("while hidden: none"), HasSubstr("out of view: none"),
                                  Not(HasSubstr("nan")), Not(HasSubstr("inf"))));
  const Finished json = Judge(log, "--json");
  EXPECT_THAT(json.output, AllOf(HasSubstr("\"localisation_rms_m\": null"),
                                 HasSubstr("\"rms_m\": null"), Not(HasSubstr("nan"))));
  const Finished page = Execute("cat " + folder_.path() + "/report/index.html");
  EXPECT_THAT(page.output, AllOf(HasSubstr("while hidden: none"), Not(HasSubstr(">nan")),
                                 Not(HasSubstr("-nan")), Not(HasSubstr(">inf"))));
}

}  // namespace
}  // namespace v2vouch
