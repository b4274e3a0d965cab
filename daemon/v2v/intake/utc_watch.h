// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "daemon/common/data/input.h"

namespace v2vouch {

/// Whether this car's clock and the senders' agree. What senders say carries UTC by their GNSS; a
/// computer that is not synchronised takes all of it for older or newer than it is, and moves every
/// claimed position along by speed times that. From 0.2 s on vehicles are not matched, and nothing
/// else shows why.
///
/// Over `kWindow_s` of reception the least age of each sender's messages is kept (delays of a radio
/// add to it); their median over the senders is the difference. It is told where it is out of
/// [kLeast_s, kMost_s] in two windows in a row: a radio's delay explains up to 0.3 s, nothing
/// explains content of the future. One sender that lies or lags is outvoted by two others.
///
/// Told and not corrected: no stranger may set this car's clock. Bounded; no allocation after
/// construction.
class UtcWatch {
 public:
  UtcWatch();

  /// @param age_s reception minus the claimed time. Messages come in order of reception.
  void OnMessage(SenderId sender, Timestamp received, double age_s);

  /// Seconds by which the senders' time is behind this car's (negative: ahead), while that holds.
  [[nodiscard]] std::optional<double> difference_s() const;

  static constexpr double kWindow_s = 5.0;
  static constexpr double kLeast_s = -0.1;
  static constexpr double kMost_s = 0.3;
  static constexpr int kFewestMessages = 4;
  static constexpr std::size_t kMostSenders = 32;  ///< The first of each window.

 private:
  struct Heard {
    SenderId sender = 0;
    double least_age_s = 0.0;
    int messages = 0;
  };
  void EndWindow();

  std::vector<Heard> heard_;
  std::optional<Timestamp> since_;
  int windows_ = 0;  // In a row that were out of the limits.
  double difference_s_ = 0.0;
};

}  // namespace v2vouch
