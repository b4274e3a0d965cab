// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace v2vouch {

/// Decides when the service manager's watchdog is fed: only where since the last time every
/// receive thread went on and the fusion thread came by (it is the caller), and a message has been
/// published recently. A daemon of which one part hangs is thus restarted as a whole, instead of
/// sending predicted lists forever.
class Watchdog {
 public:
  using Clock = std::chrono::steady_clock;

  /// A status goes out every 1.1 s at the latest, whatever comes in.
  static constexpr std::chrono::milliseconds kLongestSilence{1500};

  /// @param period within which the manager expects to be told; nullopt: never due.
  Watchdog(std::optional<std::chrono::microseconds> period, Clock::time_point now)
      : period_(period), last_fed_(now) {}

  /// @param receive_ticks of each receive thread, counting up while it lives.
  /// @param last_published when a message last went out.
  /// @return whether to feed now; at most four times per period.
  bool IsToBeFed(Clock::time_point now, std::span<const std::int64_t> receive_ticks,
                 Clock::time_point last_published) {
    if (!period_ || now - last_fed_ < *period_ / 4) return false;
    if (now - last_published > kLongestSilence) return false;
    seen_.resize(receive_ticks.size(), -1);
    for (std::size_t i = 0; i < receive_ticks.size(); ++i) {
      if (receive_ticks[i] == seen_[i]) return false;
    }
    seen_.assign(receive_ticks.begin(), receive_ticks.end());
    last_fed_ = now;
    return true;
  }

 private:
  std::optional<std::chrono::microseconds> period_;
  Clock::time_point last_fed_;
  std::vector<std::int64_t> seen_;  // At the last feeding.
};

}  // namespace v2vouch
