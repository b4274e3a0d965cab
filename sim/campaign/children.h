// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <mutex>
#include <set>
#include <string>
#include <vector>

namespace v2vouch::campaign {

struct ChildResult {
  bool has_started = false;
  int exit_code = -1;  ///< 128 + signal where a signal ended it.
  std::string out;     ///< Standard output.
  std::string err;     ///< Standard error, its last 4 kB.
};

/// Child processes that can be stopped together. Run() may be called from several threads.
class Children {
 public:
  /// Runs a program to its end. Output goes through files `scratch`.out and .err, removed after.
  ChildResult Run(const std::vector<std::string>& command, const std::filesystem::path& scratch);

  /// Ends all children now running (SIGTERM) and lets no other start.
  void Stop();
  [[nodiscard]] bool is_stopped() const;

 private:
  mutable std::mutex mutex_;
  std::set<pid_t> running_;
  bool is_stopped_ = false;
};

/// A command as one would type it into a shell.
std::string ShellText(const std::vector<std::string>& command);

}  // namespace v2vouch::campaign
