// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "daemon/common/base/notice.h"
#include "daemon/common/base/time.h"
#include "daemon/rim/wire/input_decoder.h"
#include "daemon/rim/wire/status.h"

namespace v2vouch {

/// The conditions in force, under the names of their channels, and since when; what began and ended
/// is kept for the log. A function of what it is shown.
class NoticeBoard {
 public:
  explicit NoticeBoard(std::span<const wire::InputChannel> channels);

  /// `notices`: everything that holds at `now`, in any order.
  void Update(std::span<const Notice> notices, Timestamp now);

  /// Ordered by kind and subject; 256 at most.
  [[nodiscard]] const std::vector<wire::NoticeStatus>& in_force() const { return in_force_; }

  struct Change {
    bool has_begun = false;  ///< false: it has ended.
    wire::NoticeStatus notice;
  };
  /// Since the last call; the oldest are dropped beyond 256.
  std::vector<Change> TakeChanges() { return std::exchange(changes_, {}); }

 private:
  [[nodiscard]] std::string ChannelOf(const NoticeSubject& subject) const;
  void Record(bool has_begun, const wire::NoticeStatus& notice);

  std::vector<wire::InputChannel> channels_;
  std::vector<Notice> shown_;  // Beside in_force_.
  std::vector<wire::NoticeStatus> in_force_;
  std::vector<Change> changes_;
};

}  // namespace v2vouch
