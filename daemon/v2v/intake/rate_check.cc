// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/intake/rate_check.h"

#include <algorithm>
#include <limits>

namespace v2vouch {
namespace {

constexpr std::int64_t kSlot_us = 500'000;
constexpr double kSlot_s = 0.5;
// Refusals farther apart than this are not "again and again": the budget is met on the whole.
constexpr double kPause_s = 0.5;

}  // namespace

void RateCheck::OnMessage(Timestamp stamp) {
  const std::int64_t slot = ToMicros(stamp) / kSlot_us;
  if (slot > slot_) {
    const std::int64_t passed = slot - slot_;
    heard_[2] = passed == 1 ? heard_[1] : passed == 2 ? heard_[0] : 0;
    heard_[1] = passed == 1 ? heard_[0] : 0;
    heard_[0] = 0;
    slot_ = slot;
  }
  if (heard_[0] < std::numeric_limits<int>::max()) ++heard_[0];
}

void RateCheck::OnRefused(Timestamp stamp) {
  if (refused_ == 0 || ToSeconds(stamp - last_refused_) > kPause_s) {
    over_since_ = stamp;
    refused_ = 0;
  }
  refused_ = std::min(refused_ + 1, std::numeric_limits<int>::max() - 1);
  last_refused_ = stamp;
}

std::optional<Finding> RateCheck::Judge(Timestamp now, const MessageCheckConfig& config) const {
  const std::int64_t passed = ToMicros(now) / kSlot_us - slot_;
  const double least_hz =
      passed > 1 ? 0.0
                 : (passed == 1 ? std::min(heard_[0], heard_[1]) : std::min(heard_[1], heard_[2])) /
                       kSlot_s;
  if (least_hz > config.accuse_rate_hz) {
    return Finding{Check::kMessageRate, Verdict::kAccuse, "rate_hz", least_hz,
                   config.accuse_rate_hz};
  }
  if (refused_ > 0 && ToSeconds(now - last_refused_) <= kPause_s) {
    const double over_s = ToSeconds(now - over_since_);
    if (over_s >= config.over_rate_s) {
      return Finding{Check::kMessageRate, Verdict::kWithdraw, "over_rate_s", over_s,
                     config.over_rate_s};
    }
  }
  return std::nullopt;
}

}  // namespace v2vouch
