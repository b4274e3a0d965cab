// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/v2vouchd/stderr_relay.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <new>
#include <string_view>
#include <system_error>

namespace v2vouch {
namespace {

constexpr std::size_t kMostWaiting = 256 * 1024;
constexpr int kPipeBytes = 1 << 20;
constexpr int kLook_ms = 50;
constexpr std::chrono::milliseconds kLastWords{200};
// A pipe that is ready for writing takes this much (PIPE_BUF) without waiting.
constexpr std::size_t kPortion = 4096;

// Last words before abort() (a failed check) are still in our pipe: gives the thread a moment.
void LetRelayFinish(int) { poll(nullptr, 0, 2 * kLook_ms); }

}  // namespace

StderrRelay::StderrRelay() {
  real_ = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  if (real_ < 0 || pipe2(pipe_.data(), O_NONBLOCK | O_CLOEXEC) != 0) return;
  static_cast<void>(fcntl(pipe_[1], F_SETPIPE_SZ, kPipeBytes));
  try {
    thread_ = std::thread([this] { Run(); });
  } catch (const std::system_error&) {  // No thread is to be had: stderr stays as it is.
    close(pipe_[0]);
    close(pipe_[1]);
    return;
  }
  dup2(pipe_[1], STDERR_FILENO);
  close(pipe_[1]);
  signal(SIGABRT, LetRelayFinish);
}

StderrRelay::~StderrRelay() {
  if (thread_.joinable()) {
    signal(SIGABRT, SIG_DFL);
    dup2(real_, STDERR_FILENO);  // The pipe's only writing end goes: the thread reads to its end.
    must_stop_ = true;
    thread_.join();
    close(pipe_[0]);
  }
  if (real_ >= 0) close(real_);
}

void StderrRelay::Run() {
  std::array<char, 16 * 1024> buffer;
  bool is_open = true;
  std::chrono::steady_clock::time_point end{};
  while (is_open || !waiting_.empty()) {
    if (must_stop_) {
      const auto now = std::chrono::steady_clock::now();
      if (end == std::chrono::steady_clock::time_point{}) end = now + kLastWords;
      if (now >= end) return;
    }
    std::array<pollfd, 2> files{pollfd{is_open ? pipe_[0] : -1, POLLIN, 0},
                                pollfd{waiting_.empty() ? -1 : real_, POLLOUT, 0}};
    if (poll(files.data(), files.size(), kLook_ms) <= 0) continue;
    if (files[0].revents != 0) {
      const ssize_t got = read(pipe_[0], buffer.data(), buffer.size());
      try {
        if (got > 0) Keep(buffer.data(), static_cast<std::size_t>(got));
      } catch (const std::bad_alloc&) {
        ++lost_;
      }
      if (got == 0) is_open = false;
    }
    if (files[1].revents != 0) PassOn();
  }
}

void StderrRelay::Keep(const char* text, std::size_t size) {
  std::string_view rest(text, size);
  while (!rest.empty()) {
    const auto newline = rest.find('\n');
    const std::size_t length = newline == std::string_view::npos ? rest.size() : newline + 1;
    const bool ends = newline != std::string_view::npos;
    if (!is_dropping_ && waiting_.size() + length > kMostWaiting) is_dropping_ = true;
    if (is_dropping_) {
      if (ends) {
        ++lost_;
        is_dropping_ = false;
      }
    } else {
      if (lost_ > 0 && (waiting_.empty() || waiting_.back() == '\n')) {
        waiting_ += "event=log_lines_lost lines=" + std::to_string(lost_) + "\n";
        lost_ = 0;
      }
      waiting_.append(rest.substr(0, length));
    }
    rest.remove_prefix(length);
  }
}

void StderrRelay::PassOn() {
  const ssize_t written = write(real_, waiting_.data(), std::min(waiting_.size(), kPortion));
  if (written > 0) {
    waiting_.erase(0, static_cast<std::size_t>(written));
  } else if (errno != EINTR && errno != EAGAIN) {
    // Full or closed: what waits is lost, and the next lines are tried again.
    lost_ += std::count(waiting_.begin(), waiting_.end(), '\n');
    waiting_.clear();
  }
}

}  // namespace v2vouch
