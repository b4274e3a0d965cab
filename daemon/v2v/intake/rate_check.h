// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "daemon/common/base/time.h"
#include "daemon/common/data/finding.h"
#include "daemon/v2v/intake/message_check_config.h"

namespace v2vouch {

/// message_rate: a sender that speaks too often. Told of every message that is no repeat of
/// another.
///
///     message_rate, WITHDRAW: refused for its budget again and again for over_rate_s
///     message_rate, ACCUSE:   more than accuse_rate_hz in each half of the last whole second
///
/// Never from one interval: honest senders' messages come in pairs 50 ms apart, and a receiver
/// that hangs hands over a second's messages at once.
class RateCheck {
 public:
  void OnMessage(Timestamp stamp);
  void OnRefused(Timestamp stamp);  ///< For its own budget.

  [[nodiscard]] std::optional<Finding> Judge(Timestamp now, const MessageCheckConfig& config) const;

 private:
  std::int64_t slot_ = 0;       // Of half a second.
  std::array<int, 3> heard_{};  // In this slot and in the two before.
  int refused_ = 0;             // Since over_since_.
  Timestamp over_since_{};
  Timestamp last_refused_{};
};

}  // namespace v2vouch
