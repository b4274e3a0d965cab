// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace v2vouch::testing {

/// A child process, its output in a file. Ended by its id when this goes away.
class Program {
 public:
  Program(const std::vector<std::string>& arguments, const std::string& output_path);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void Signal(int signal) const;
  [[nodiscard]] pid_t pid() const { return pid_; }
  [[nodiscard]] bool IsRunning();
  /// Exit code, 128 + signal where a signal ended it; nullopt when it runs on.
  std::optional<int> Wait(std::chrono::milliseconds timeout);
  /// Everything written to stdout and stderr so far.
  [[nodiscard]] std::string Output() const;

 private:
  pid_t pid_ = -1;
  std::string output_path_;
  std::optional<int> exit_code_;
};

/// Checks every 20 ms. @return false when it did not become true in time.
bool Eventually(const std::function<bool()>& condition, std::chrono::milliseconds timeout);

}  // namespace v2vouch::testing
