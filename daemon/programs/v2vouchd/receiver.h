// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "daemon/rim/io/lcm_bus.h"

namespace v2vouch {

/// A thread that opens one LCM URL, with back-off where there is no route yet, subscribes, and then
/// only drains: every message goes to its sink at once.
class Receiver {
 public:
  struct Subscription {
    std::string channel;
    LcmBus::Handler sink;
  };

  enum class Priority { kNormal, kLow };

  Receiver(std::string url, std::vector<Subscription> subscriptions,
           Priority priority = Priority::kNormal);
  ~Receiver();

  /// False while the bus is not open yet.
  bool Publish(const std::string& channel, std::span<const std::uint8_t> bytes);
  [[nodiscard]] bool is_open() const { return is_open_; }
  /// Attempts to open that failed so far.
  [[nodiscard]] int failures() const { return failures_; }
  /// What was refused below the message so far.
  [[nodiscard]] lcm_packets::PacketCounts refused() const {
    return is_open_ ? bus_->refused() : lcm_packets::PacketCounts{};
  }
  /// Counts up while the thread lives: waiting for a message, for a route, or handling.
  [[nodiscard]] std::int64_t ticks() const { return ticks_; }
  /// How often the multicast group had to be joined again.
  [[nodiscard]] std::int64_t rejoins() const { return is_open_ ? bus_->rejoins() : 0; }

 private:
  void Run();
  bool Open();

  std::string url_;
  std::vector<Subscription> subscriptions_;
  Priority priority_;
  std::unique_ptr<LcmBus> bus_;  // Set once by the thread before is_open_.
  std::atomic<bool> is_open_ = false;
  std::atomic<bool> must_stop_ = false;
  std::atomic<int> failures_ = 0;
  std::atomic<std::int64_t> ticks_ = 0;
  std::thread thread_;
};

}  // namespace v2vouch
