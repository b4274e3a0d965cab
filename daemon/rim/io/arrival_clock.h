// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>

#include "daemon/common/base/time.h"

namespace v2vouch {

/// Arrival times of a log that never go back. Where the recorder's clock was set back (by more than
/// a second; less is disorder), time goes on from there; where it was set on, there is a gap.
class ArrivalClock {
 public:
  /// Of the next event in the file.
  Timestamp Of(Timestamp received) {
    Timestamp at = received + shift_;
    if (newest_ && at < *newest_ - std::chrono::seconds(1)) {
      shift_ += *newest_ - at;
      at = *newest_;
    }
    newest_ = newest_ ? std::max(*newest_, at) : at;
    return *newest_;
  }

 private:
  MessageClock::duration shift_{0};
  std::optional<Timestamp> newest_;
};

}  // namespace v2vouch
