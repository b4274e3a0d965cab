// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "daemon/programs/v2vouchd/receiver.h"
#include "daemon/rim/engine/engine.h"

namespace v2vouch {

/// The daemon's log lines, as key=value: what has changed since the last call, never the same
/// twice.
class DaemonLog {
 public:
  /// @param ports that messages are received on; BSMs' own is the second.
  static void Start(const DaemonConfig& config, std::size_t inputs, const std::vector<int>& ports);
  /// One line per channel, reason and field and second at most, and not too many in one second; the
  /// others have their turn in the next.
  void Refusals(const std::vector<RefusalTable::Row>& rows);
  void QueueDrops(std::int64_t own, std::int64_t bsm);
  /// One line when a radar is found turned, one when it sits right again.
  void Mounts(const std::vector<RadarConfig>& radars, std::span<const MountVerdict> mounts);
  static void Notices(const std::vector<NoticeBoard::Change>& changes);
  /// A bus that cannot be opened: the first (0) or BSMs' own (1).
  void Waiting(std::size_t index, const Receiver& bus, const std::string& url);

 private:
  std::vector<std::uint64_t> logged_;  // Of each row of refusals, what the log has.
  std::size_t next_refusal_ = 0;
  std::int64_t logged_drops_ = 0;
  std::vector<bool> moved_;
  std::array<int, 2> reported_failures_{};
};

}  // namespace v2vouch
