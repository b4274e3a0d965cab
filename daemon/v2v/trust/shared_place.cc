// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/trust/shared_place.h"

#include <algorithm>

namespace v2vouch {
namespace {

constexpr double kLongestStep_s = 0.2;  // A pause between observations counts for no more.
constexpr double kMost_s = 10.0;        // So that it is forgotten in finite time.

}  // namespace

void SharedPlace::OnLook(Timestamp stamp, bool is_shared) {
  const double dt_s =
      last_look_ ? std::clamp(ToSeconds(stamp - *last_look_), 0.0, kLongestStep_s) : 0.0;
  last_look_ = stamp;
  shared_s_ = std::clamp(shared_s_ + (is_shared ? dt_s : -dt_s), 0.0, kMost_s);
}

std::optional<Finding> SharedPlace::Judge(const SharedPlaceConfig& config) const {
  if (shared_s_ < config.withdraw_s) return std::nullopt;
  return Finding{Check::kSharedPlace, Verdict::kWithdraw, "shared_s", shared_s_, config.withdraw_s};
}

}  // namespace v2vouch
