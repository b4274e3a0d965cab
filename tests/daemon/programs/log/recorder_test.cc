// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/log/recorder.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

namespace v2vouch {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

class RecorderRuns : public ::testing::Test {
 protected:
  RecorderRuns() {
    std::string pattern = ::testing::TempDir() + "recorder_XXXXXX";
    folder_ = mkdtemp(pattern.data());
  }
  ~RecorderRuns() override { fs::remove_all(folder_); }
  // One event of 1000 bytes per 100 ms.
  void Feed(Recorder& recorder, int count) {
    for (int i = 0; i < count; ++i, now_ += 100ms, ++sent_) {
      recorder.Write(FromMicros(sent_), "A", std::vector<std::uint8_t>(1000), now_);
    }
  }
  std::vector<std::int64_t> Recorded() const {  // Times of all events of all files.
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      if (entry.path().extension() == ".lcm") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    std::vector<std::int64_t> times;
    for (const fs::path& path : files) {
      std::string error;
      const auto reader = LogReader::Open(path, error);
      LogEvent event;
      while (reader && reader->Next(event)) times.push_back(ToMicros(event.received));
    }
    return times;
  }
  fs::path folder_;
  Recorder::Clock::time_point now_{std::chrono::seconds(1'700'000'000)};
  std::int64_t sent_ = 0;
};

TEST_F(RecorderRuns, FilesFollowEachOtherWithoutAGap) {
  RecorderLimits limits;
  limits.file_bytes = 5000;
  limits.free_share = 0.0;
  Recorder recorder(folder_, limits);
  Feed(recorder, 100);
  recorder.Finish();
  const auto times = Recorded();
  ASSERT_EQ(times.size(), 100u);
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_EQ(times[i], static_cast<int>(i));
  EXPECT_EQ(recorder.missed(), 0);
}

// The file as another process sees it: what a kill right now would leave.
TEST_F(RecorderRuns, AKillLosesAtMostTheLast200Milliseconds) {
  RecorderLimits limits;
  limits.free_share = 0.0;
  Recorder recorder(folder_, limits);
  for (int i = 0; i < 50; ++i) {
    Feed(recorder, 1);  // At now_ - 100 ms.
    EXPECT_GE(Recorded().size(), static_cast<std::size_t>(std::max(0, i - 1))) << i;
  }
  recorder.Tick(now_ + 100ms);
  EXPECT_EQ(Recorded().size(), 50u);  // Silence holds nothing back.
}

TEST_F(RecorderRuns, WhatADiskTookAndDidNotKeepIsCountedAsMissed) {
  signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  rlimit small = before;
  small.rlim_cur = 100'000;  // Of a file: about 97 events.
  setrlimit(RLIMIT_FSIZE, &small);
  RecorderLimits limits;
  limits.free_share = 0.0;
  {
    Recorder recorder(folder_, limits);
    Feed(recorder, 1000);
    recorder.Finish();
    EXPECT_GT(recorder.missed(), 0);
    EXPECT_EQ(static_cast<std::int64_t>(Recorded().size()), recorder.written());
    EXPECT_EQ(recorder.written() + recorder.missed(), 1000);
  }
  setrlimit(RLIMIT_FSIZE, &before);
}

TEST_F(RecorderRuns, PausesForWantOfSpaceLosesNothingThatItHasAndGoesOn) {
  double free = 0.5;
  RecorderLimits limits;
  limits.free_share = 0.1;
  Recorder recorder(folder_, limits, [&](const fs::path&) { return free; });
  Feed(recorder, 20);
  free = 0.1;
  Feed(recorder, 50);
  EXPECT_TRUE(recorder.is_paused());
  EXPECT_GE(Recorded().size(), 20u);  // Closed, and readable while it pauses.
  const auto missed = recorder.missed();
  EXPECT_GE(missed, 40);
  EXPECT_NE(recorder.problem().find("stay free"), std::string::npos);
  free = 0.5;
  Feed(recorder, 30);
  recorder.Finish();
  EXPECT_EQ(static_cast<std::int64_t>(Recorded().size()) + recorder.missed(), 100);
  EXPECT_LE(recorder.missed(), missed + 10);
}

TEST_F(RecorderRuns, SizeLimitRemovesItsOwnOldestFilesOnly) {
  std::ofstream(folder_ / "holiday.lcm") << std::string(100'000, 'x');
  std::ofstream(folder_ / "v2vouch-mine.lcm") << "mine";
  RecorderLimits limits;
  limits.file_bytes = 5000;
  limits.total_bytes = 30'000;
  limits.free_share = 0.0;
  Recorder recorder(folder_, limits);
  Feed(recorder, 200);
  recorder.Finish();
  const auto times = Recorded();
  EXPECT_LT(times.size(), 60u);
  EXPECT_EQ(times.back(), 199);  // The newest are there.
  EXPECT_TRUE(fs::exists(folder_ / "holiday.lcm"));
  EXPECT_TRUE(fs::exists(folder_ / "v2vouch-mine.lcm"));
}

TEST_F(RecorderRuns, AgeLimitRemovesOldFiles) {
  const fs::path old = folder_ / "v2vouch-20200101-000000.00.lcm";
  const fs::path young = folder_ / "v2vouch-20200102-000000.00.lcm";
  std::ofstream(old) << "x";
  std::ofstream(young) << "x";
  fs::last_write_time(old, fs::file_time_type::clock::now() - 2h);
  RecorderLimits limits;
  limits.age = 3600s;
  limits.free_share = 0.0;
  Recorder recorder(folder_, limits);
  Feed(recorder, 1);
  EXPECT_FALSE(fs::exists(old));
  EXPECT_TRUE(fs::exists(young));
}

}  // namespace
}  // namespace v2vouch
