// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "daemon/common/base/reason.h"
#include "daemon/common/data/input.h"

namespace v2vouch {

/// What the fusion thread works on, in order of arrival.
struct Arrival {
  using Bytes = std::vector<std::uint8_t>;
  /// Bytes as received; what the detector saw; or why a message never got that far.
  using Content = std::variant<Bytes, CameraDetections, Refusal>;

  std::string channel;
  Content content;
  Timestamp received{};
  std::chrono::steady_clock::time_point arrived{};  ///< From the detector: when it was done.
  std::chrono::steady_clock::duration looked{};     ///< From the detector: since the picture came.
  std::uint64_t number = 0;  ///< Given by the queue: the one total order of everything received.
};

/// Between the receiving threads and the fusion thread. Own sensors and BSMs wait in queues of
/// their own, so that a radio flood cannot push out a radar; each drops its oldest when full.
///
/// While the daemon keeps up, the order is that of arrival: the few BSMs that came before a frame
/// are in its PRIORITY list, live as in a replay. A backlog is not waited for: where more than
/// kMostAhead BSMs stand before an own message, it overtakes them all.
class MessageQueue {
 public:
  MessageQueue(std::size_t own_capacity, std::size_t bsm_capacity)
      : own_{own_capacity, {}, 0}, bsm_{bsm_capacity, {}, 0} {}

  void PushOwn(Arrival arrival) { Push(own_, std::move(arrival)); }
  void PushBsm(Arrival arrival) { Push(bsm_, std::move(arrival)); }

  static constexpr std::size_t kMostAhead = 16;

  /// The oldest of both queues by number, but for a backlog of BSMs; nullopt when none came in
  /// time.
  std::optional<Arrival> Pop(std::chrono::milliseconds timeout);

  /// Something of an own sensor waits.
  [[nodiscard]] bool has_own() const {
    const std::lock_guard lock(mutex_);
    return !own_.waiting.empty();
  }
  [[nodiscard]] std::int64_t own_drops() const { return Drops(own_); }
  [[nodiscard]] std::int64_t bsm_drops() const { return Drops(bsm_); }

 private:
  struct Bounded {
    std::size_t capacity;
    std::deque<Arrival> waiting;
    std::int64_t drops;
  };

  void Push(Bounded& queue, Arrival arrival);
  std::int64_t Drops(const Bounded& queue) const {
    const std::lock_guard lock(mutex_);
    return queue.drops;
  }

  mutable std::mutex mutex_;
  std::condition_variable has_some_;
  Bounded own_;
  Bounded bsm_;
  std::uint64_t next_number_ = 0;
};

}  // namespace v2vouch
