// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "daemon/rim/engine/daemon_config.h"
#include "daemon/rim/engine/trust_file.h"

namespace v2vouch {

/// Keeps the trust in senders over restarts: reads the state file at start, writes it while the
/// daemon runs, on a thread of its own (a disk may take its time), and at the end. Inactive where
/// the configuration names no file or says `enabled: false`.
class TrustKeeper {
 public:
  TrustKeeper(const StateConfig& config, const std::string& vehicle);
  ~TrustKeeper();

  /// What the file holds, with one line of log about it.
  std::vector<TrustMemory> Load();
  /// Whether it is time for Keep(); cheap.
  [[nodiscard]] bool IsDue(std::chrono::steady_clock::time_point now) const;
  /// Has it written where something has changed. Does not wait.
  void Keep(const std::vector<TrustMemory>& senders, std::chrono::steady_clock::time_point now);
  /// The last time, at once.
  void Finish(const std::vector<TrustMemory>& senders);

 private:
  void Run();
  void StopThread();
  void Write(const std::string& content);
  [[nodiscard]] std::string Print(const std::vector<TrustMemory>& senders) const;

  StateConfig config_;
  std::string vehicle_;
  bool is_active_ = false;
  std::vector<TrustMemory> kept_;
  std::chrono::steady_clock::time_point looked_{};
  std::chrono::steady_clock::time_point written_{};

  std::mutex mutex_;
  std::condition_variable has_some_;
  std::optional<std::string> waiting_;
  bool must_stop_ = false;
  bool has_failed_ = false;  // The thread's, then Finish()'s.
  std::thread thread_;
};

}  // namespace v2vouch
