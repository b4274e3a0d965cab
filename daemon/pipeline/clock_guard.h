// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "daemon/base/time.h"
#include "daemon/pipeline/perception_config.h"

namespace v2vouch {

/// Judges the stamps of own sensors against each other, in order of arrival (DESIGN section 4).
/// One sensor with a broken clock must neither drag time forward nor restart the daemon; a log
/// played again from its start must.
///
/// Ahead: a stamp more than `future_s` ahead of the newest accepted one is refused until a second
/// source agrees with it within `future_s`. Back: when every source heard so far (or twenty
/// messages in a row) steps back by more than `reset_s`, time starts again.
class ClockGuard {
 public:
  explicit ClockGuard(const TimelineConfig& config) : config_(config) {}

  enum class Ruling { kAccept, kTooFarAhead, kRestart };

  /// @param source any number that is the sensor's own.
  Ruling Judge(int source, Timestamp stamp);

  /// Newest accepted own-sensor stamp; nullopt before the first.
  [[nodiscard]] std::optional<Timestamp> newest() const { return newest_; }

 private:
  struct Source {
    int id = 0;
    std::optional<Timestamp> ahead{};  // Its last refused stamp.
    bool stepped_back = false;         // Since the last message that fits `newest_`.
  };
  Source& Find(int id);
  void Accept(Source& source, Timestamp stamp);

  TimelineConfig config_;
  std::optional<Timestamp> newest_;
  std::vector<Source> sources_;
  int steps_back_ = 0;
};

}  // namespace v2vouch
