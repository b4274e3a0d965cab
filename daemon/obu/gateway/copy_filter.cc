// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/gateway/copy_filter.h"

#include <cmath>

namespace v2vouch::obu {

void CopyFilter::Forget(std::int64_t utime) {
  // A clock set back must not keep anything for ever: the bound on the number sees to that.
  while (!by_age_.empty() &&
         (utime - by_age_.front().first > window_us_ || by_age_.size() > kMost)) {
    const auto& [heard, key] = by_age_.front();
    const auto found = heard_.find(key);
    if (found != heard_.end() && found->second == heard) heard_.erase(found);
    by_age_.pop_front();
  }
}

bool CopyFilter::IsCopy(std::uint64_t key, std::int64_t utime) {
  Forget(utime);
  const auto found = heard_.find(key);
  return found != heard_.end() && std::abs(utime - found->second) <= window_us_;
}

void CopyFilter::Strengthen(std::uint64_t key, std::optional<int> rssi_dbm) {
  if (!rssi_dbm) return;
  const auto rssi = static_cast<float>(*rssi_dbm);
  for (Waiting& waiting : waiting_) {
    if (waiting.key == key && rssi > waiting.message.rssi_dbm) waiting.message.rssi_dbm = rssi;
  }
}

void CopyFilter::Add(std::uint64_t key, const bsm_t& message, std::vector<bsm_t>& out) {
  heard_[key] = message.rx_utime;
  by_age_.emplace_back(message.rx_utime, key);
  if (merge_us_ > 0 && std::isfinite(message.rssi_dbm)) {
    waiting_.push_back({key, message});
  } else {
    out.push_back(message);
  }
}

void CopyFilter::Flush(std::int64_t utime, std::vector<bsm_t>& out) {
  while (!waiting_.empty()) {
    const std::int64_t waited = utime - waiting_.front().message.rx_utime;
    if (waited >= 0 && waited < merge_us_ && waiting_.size() < kMost) break;
    out.push_back(waiting_.front().message);
    waiting_.pop_front();
  }
}

std::optional<std::int64_t> CopyFilter::due() const {
  if (waiting_.empty()) return std::nullopt;
  return waiting_.front().message.rx_utime + merge_us_;
}

}  // namespace v2vouch::obu
