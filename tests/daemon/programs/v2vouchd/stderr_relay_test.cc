// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/v2vouchd/stderr_relay.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <memory>

namespace v2vouch {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

// Puts something else where stderr was, for a test's time.
class Stderr {
 public:
  explicit Stderr(int file) : saved_(dup(STDERR_FILENO)) { dup2(file, STDERR_FILENO); }
  ~Stderr() {
    dup2(saved_, STDERR_FILENO);
    close(saved_);
  }

 private:
  int saved_;
};

std::string ReadAll(int file) {
  std::string all;
  std::array<char, 65536> buffer;
  for (ssize_t got = 0; (got = read(file, buffer.data(), buffer.size())) > 0;) {
    all.append(buffer.data(), static_cast<std::size_t>(got));
  }
  return all;
}

constexpr int kLines = 20'000;  // 2 MB: more than all buffers.

void WriteLines() {
  for (int i = 0; i < kLines; ++i) std::fprintf(stderr, "line %06d %090d\n", i, 0);
}

TEST(StderrRelay, PassesOnWhatIsWrittenAndGivesStderrBack) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  {
    const Stderr other(ends[1]);
    {
      const StderrRelay relay;
      std::fprintf(stderr, "one\ntwo\n");
    }
    std::fprintf(stderr, "three\n");
  }
  close(ends[1]);
  EXPECT_EQ(ReadAll(ends[0]), "one\ntwo\nthree\n");
  close(ends[0]);
}

TEST(StderrRelay, NoWriterWaitsForAPipeThatNobodyEmpties) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  const auto before = Clock::now();
  {
    const Stderr other(ends[1]);
    auto relay = std::make_unique<StderrRelay>();
    WriteLines();
    EXPECT_LT(Clock::now() - before, 5s);
    // Somebody reads at last: what was kept comes whole, and what was lost is told.
    fcntl(ends[0], F_SETFL, O_NONBLOCK);
    std::string text = ReadAll(ends[0]);
    for (int i = 0; i < 100; ++i) {
      std::fprintf(stderr, "tail\n");
      usleep(10'000);
      text += ReadAll(ends[0]);
    }
    relay.reset();
    text += ReadAll(ends[0]);
    EXPECT_THAT(text, ::testing::StartsWith("line 000000 "));
    EXPECT_THAT(text, ::testing::HasSubstr("event=log_lines_lost lines="));
    EXPECT_THAT(text, ::testing::EndsWith("\ntail\n"));
    EXPECT_LT(text.size(), 600'000u);
  }
  close(ends[0]);
  close(ends[1]);
}

TEST(StderrRelay, EndsSoonThoughNobodyReads) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  const Stderr other(ends[1]);
  auto relay = std::make_unique<StderrRelay>();
  WriteLines();
  const auto before = Clock::now();
  relay.reset();
  EXPECT_LT(Clock::now() - before, 1s);
  close(ends[0]);
  close(ends[1]);
}

TEST(StderrRelay, AFullDeviceOrAReaderThatIsGoneCostsOnlyTheLines) {
  signal(SIGPIPE, SIG_IGN);
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  close(ends[0]);
  const int full = open("/dev/full", O_WRONLY);
  for (const int file : {ends[1], full}) {
    const Stderr other(file);
    const StderrRelay relay;
    WriteLines();
  }
  close(ends[1]);
  close(full);
}

}  // namespace
}  // namespace v2vouch
