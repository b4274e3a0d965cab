// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/rim/io/event_log.h"

namespace v2vouch {

/// What a recorder may use.
struct RecorderLimits {
  std::int64_t file_bytes = 1LL << 30;  ///< Of one file; then the next begins.
  std::int64_t total_bytes = 0;         ///< Of this recorder's files; 0: no limit.
  std::chrono::seconds age{0};          ///< Older files of this recorder are removed; 0: none.
  double free_share = 0.10;             ///< Of the file system that is left to others.
};

/// Writes events into files FOLDER/v2vouch-YYYYMMDD-HHMMSS.NN.lcm. Size and age limits remove this
/// recorder's oldest files first, and only those that bear such a name. Where the disk has no more
/// than its free share, or does not take a write, recording pauses and counts what it misses;
/// nothing recorded is removed for want of space, and the file that is open stays readable up to
/// its last whole event. It goes on, in a new file, when there is space again.
///
/// A kill of the process loses what came in the last 0.2 s at most, as long as Write or Tick is
/// called that often. A power cut loses what the system has not yet brought to the disk.
class Recorder {
 public:
  using Clock = std::chrono::system_clock;
  /// Free share of the file system, 0..1; a test hands in its own.
  using FreeShare = std::function<double(const std::filesystem::path&)>;

  Recorder(std::filesystem::path folder, RecorderLimits limits, FreeShare free_share = {});
  ~Recorder();

  void Write(Timestamp received, std::string_view channel, std::span<const std::uint8_t> bytes,
             Clock::time_point now);
  /// Hands on what has waited for 0.2 s; to be called while no message comes.
  void Tick(Clock::time_point now);
  /// Closes what is open, so that all of it is in the file.
  void Finish();

  [[nodiscard]] std::int64_t written() const { return written_; }
  /// Also those that were taken and then did not fit on the disk.
  [[nodiscard]] std::int64_t missed() const { return missed_; }
  [[nodiscard]] bool is_paused() const { return is_paused_; }
  [[nodiscard]] const std::string& problem() const { return problem_; }  ///< Of the last pause.

 private:
  bool OpenNext(Clock::time_point now);
  void MakeRoom(Clock::time_point now);
  void Look(Clock::time_point now);
  void CountLost();
  [[nodiscard]] std::vector<std::filesystem::path> OwnFiles() const;

  std::filesystem::path folder_;
  RecorderLimits limits_;
  FreeShare free_share_;
  std::unique_ptr<LogWriter> writer_;
  std::filesystem::path open_;
  std::int64_t open_bytes_ = 0;
  std::int64_t written_ = 0;
  std::int64_t missed_ = 0;
  bool is_paused_ = false;
  std::string problem_;
  Clock::time_point looked_{};
  Clock::time_point flushed_{};
  std::vector<std::int64_t> waiting_;  // Where in the open file each event not yet flushed ends.
};

}  // namespace v2vouch
