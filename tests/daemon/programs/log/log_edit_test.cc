// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/log/log_edit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "daemon/rim/io/event_log.h"

namespace v2vouch {
namespace {

using ::testing::ElementsAre;

class LogEdit : public ::testing::Test {
 protected:
  ~LogEdit() override {
    for (const std::string& path : made_) std::filesystem::remove(path);
  }
  std::string Path(const std::string& name) {
    made_.push_back(::testing::TempDir() + "log_edit_" + name);
    return made_.back();
  }
  // Events "CHANNEL" at these milliseconds.
  std::string Log(const std::string& name, const std::vector<std::pair<std::string, int>>& events) {
    const std::string path = Path(name);
    std::string error;
    const auto writer = LogWriter::Create(path, error);
    for (const auto& [channel, at_ms] : events) {
      writer->Write(FromMicros(1000 * at_ms), channel, std::vector<std::uint8_t>(3, 1));
    }
    EXPECT_TRUE(writer->Close(error));
    return path;
  }
  static std::vector<std::string> Events(const std::string& path) {
    std::string error;
    const auto reader = LogReader::Open(path, error);
    std::vector<std::string> events;
    LogEvent event;
    while (reader && reader->Next(event)) {
      events.push_back(event.channel + std::to_string(ToMicros(event.received) / 1000));
    }
    return events;
  }
  static std::int64_t Copied(const std::optional<CopiedLog>& copied) {
    return copied ? copied->events : -1;
  }
  std::string error_;
  std::vector<std::string> made_;
};

TEST_F(LogEdit, MergeIsInTheOrderOfRecordingEvenWhereALogStepsBack) {
  const auto a = Log("a", {{"A", 1}, {"A", 3}, {"A", 5}});
  const auto b = Log("b", {{"B", 4}, {"B", 2}, {"B", 3}});
  const auto out = Path("merged");
  EXPECT_EQ(Copied(MergeLogs({a, b}, out, error_)), 6);
  EXPECT_THAT(Events(out), ElementsAre("A1", "B2", "A3", "B3", "B4", "A5"));
  EXPECT_FALSE(MergeLogs({a, b}, a, error_)) << "an input must not be overwritten";
  EXPECT_THAT(Events(a), ElementsAre("A1", "A3", "A5"));
}

TEST_F(LogEdit, CutAndFilter) {
  const auto in = Log("in", {{"RADAR_F", 100}, {"BSM", 200}, {"RADAR_R", 300}, {"TRUTH", 400}});
  const auto out = Path("out");
  LogFilter stretch;
  stretch.from_s = 0.1;
  stretch.to_s = 0.3;
  EXPECT_EQ(Copied(CopyLog(in, out, stretch, error_)), 2);
  EXPECT_THAT(Events(out), ElementsAre("BSM200", "RADAR_R300"));
  LogFilter names;
  names.channels = {"RADAR_?", "BSM"};
  names.without = {"*_R"};
  EXPECT_EQ(Copied(CopyLog(in, out, names, error_)), 2);
  EXPECT_THAT(Events(out), ElementsAre("RADAR_F100", "BSM200"));
}

TEST_F(LogEdit, ALogThatIsCutOffIsCopiedAsFarAsItGoesAndTold) {
  const auto whole = Log("whole", {{"A", 1}, {"A", 3}});
  const auto cut = Log("cut", {{"B", 4}, {"B", 2}, {"B", 3}});
  std::filesystem::resize_file(cut, std::filesystem::file_size(cut) - 1);
  const auto out = Path("copied");
  const auto merged = MergeLogs({whole, cut}, out, error_);
  ASSERT_TRUE(merged) << error_;
  EXPECT_THAT(Events(out), ElementsAre("A1", "B2", "A3", "B4"));
  EXPECT_THAT(merged->damaged, ElementsAre(0, 1));
  const auto copied = CopyLog(cut, out, {}, error_);
  ASSERT_TRUE(copied) << error_;
  EXPECT_THAT(Events(out), ElementsAre("B4", "B2"));
  EXPECT_THAT(copied->damaged, ElementsAre(1));
}

TEST_F(LogEdit, PatternsFitWholeNames) {
  EXPECT_TRUE(FitsPattern("RADAR_FRONT", "*"));
  EXPECT_TRUE(FitsPattern("RADAR_FRONT", "R*_F*T"));
  EXPECT_FALSE(FitsPattern("RADAR_FRONT", "RADAR"));
  EXPECT_FALSE(FitsPattern("RADAR_FRONT", "R*_F?"));
  EXPECT_TRUE(FitsPattern("aab", "*ab"));
}

TEST_F(LogEdit, InfoTellsGapsAndStepsBack) {
  const auto in = Log("info", {{"A", 100}, {"A", 300}, {"B", 200}});
  const auto info = ReadLogInfo(in, error_);
  ASSERT_TRUE(info);
  EXPECT_EQ(info->events, 3);
  EXPECT_EQ(info->steps_back, 1);
  EXPECT_EQ(info->channels.at("A").messages, 2);
  EXPECT_NEAR(info->channels.at("A").longest_gap_s, 0.2, 1e-9);
  EXPECT_FALSE(ReadLogInfo(in + ".none", error_));
}

}  // namespace
}  // namespace v2vouch
