// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/io/std_streams.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <new>
#include <string>
#include <thread>

#include "daemon/rim/io/stop_signal.h"

namespace v2vouch {
namespace {

// Exit code of a child that runs `body` and ends by exit(); -1 where a signal ended it.
int ExitCodeOf(const std::function<int()>& body) {
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) std::exit(body());
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void PointAt(int stream, const char* path) {
  const int opened = open(path, O_WRONLY);
  dup2(opened, stream);
  close(opened);
}

TEST(StandardStreams, ResultsThatStandardOutputDoesNotTakeAreAFailure) {
  const auto print_into = [](const std::function<void()>& arrange, int code) {
    return ExitCodeOf([&] {
      arrange();
      GuardStandardStreams("test");
      PointAt(STDERR_FILENO, "/dev/null");
      std::printf("figures\n");
      std::cout << "more of them\n";
      return code;
    });
  };
  EXPECT_EQ(print_into([] { PointAt(STDOUT_FILENO, "/dev/null"); }, 0), 0);
  EXPECT_EQ(print_into([] { PointAt(STDOUT_FILENO, "/dev/full"); }, 0), 1);
  EXPECT_EQ(print_into([] { close(STDOUT_FILENO); }, 0), 1);
  EXPECT_EQ(print_into([] { PointAt(STDOUT_FILENO, "/dev/full"); }, 2), 2);
}

// `| head`, a pager that was closed: whoever read has what it wanted.
TEST(StandardStreams, AReaderThatGoesAwayIsNoFailureAndNoWord) {
  for (const int code : {0, 1, 2}) {
    EXPECT_EQ(ExitCodeOf([code] {
                int ends[2];
                int words[2];
                if (pipe(ends) != 0 || pipe(words) != 0) std::abort();
                dup2(ends[1], STDOUT_FILENO);
                close(ends[1]);
                if (IsReaderGone()) return 7;
                close(ends[0]);
                if (!IsReaderGone()) return 8;
                const pid_t printing = fork();
                if (printing == 0) {
                  GuardStandardStreams("test");
                  dup2(words[1], STDERR_FILENO);
                  for (int i = 0; i < 10000; ++i) std::cout << "figures\n";
                  std::exit(code);
                }
                close(words[1]);
                int status = 0;
                waitpid(printing, &status, 0);
                char said = 0;
                if (read(words[0], &said, 1) != 0) return 9;
                return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
              }),
              code);
  }
}

TEST(StandardStreams, AProgramThatPrintsNothingDoesNotMindAClosedOutput) {
  EXPECT_EQ(ExitCodeOf([] {
              close(STDOUT_FILENO);
              GuardStandardStreams("test");
              return 0;
            }),
            0);
}

// Else what is meant for people would be written into the first file opened.
TEST(StandardStreams, NoFileGetsTheNumberOfAClosedStream) {
  EXPECT_EQ(ExitCodeOf([] {
              close(STDIN_FILENO);
              close(STDOUT_FILENO);
              close(STDERR_FILENO);
              GuardStandardStreams("test");
              return open("/dev/null", O_WRONLY) > STDERR_FILENO ? 0 : 3;
            }),
            0);
}

// A host without memory or threads: said, and an ordinary exit code, whichever thread it is.
TEST(StandardStreams, AnExceptionThatNobodyCaughtIsToldAndExitCode1) {
  int words[2];
  ASSERT_EQ(pipe(words), 0);
  EXPECT_EQ(ExitCodeOf([&] {
              GuardStandardStreams("test");
              dup2(words[1], STDERR_FILENO);
              std::thread([] { throw std::bad_alloc(); }).join();
              return 0;
            }),
            1);
  close(words[1]);
  char said[200] = {};
  EXPECT_GT(read(words[0], said, sizeof(said) - 1), 0);
  EXPECT_EQ(std::string(said).rfind("test: cannot go on: ", 0), 0u) << said;
  close(words[0]);
}

TEST(StopSignal, EndsAProgramThatDoesNotLookForIt) {
  const auto before = std::chrono::steady_clock::now();
  EXPECT_EQ(ExitCodeOf([] {
              PointAt(STDERR_FILENO, "/dev/null");
              HandleStopSignals();
              raise(SIGTERM);
              if (!IsStopAsked()) return 3;
              for (;;) std::this_thread::sleep_for(std::chrono::milliseconds(10));
              return 0;
            }),
            1);
  const auto took = std::chrono::steady_clock::now() - before;
  EXPECT_GT(took, std::chrono::milliseconds(500));
  EXPECT_LT(took, std::chrono::milliseconds(2000));
}

TEST(StopSignal, ASecondRequestEndsAtOnce) {
  EXPECT_EQ(ExitCodeOf([] {
              PointAt(STDERR_FILENO, "/dev/null");
              HandleStopSignals();
              raise(SIGINT);
              raise(SIGINT);
              return 0;
            }),
            1);
}

}  // namespace
}  // namespace v2vouch
