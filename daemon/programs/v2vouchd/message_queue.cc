// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/v2vouchd/message_queue.h"

#include <utility>

namespace v2vouch {

void MessageQueue::Push(Bounded& queue, Arrival arrival) {
  {
    const std::lock_guard lock(mutex_);
    arrival.number = next_number_++;
    if (queue.waiting.size() >= queue.capacity) {
      queue.waiting.pop_front();
      ++queue.drops;
    }
    queue.waiting.push_back(std::move(arrival));
  }
  has_some_.notify_one();
}

std::optional<Arrival> MessageQueue::Pop(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  has_some_.wait_for(lock, timeout,
                     [this] { return !own_.waiting.empty() || !bsm_.waiting.empty(); });
  if (own_.waiting.empty() && bsm_.waiting.empty()) return std::nullopt;
  // How many BSMs came before the oldest own message: none, a few, or a backlog.
  const auto is_before_own = [this](std::size_t bsm) {
    return bsm < bsm_.waiting.size() &&
           (own_.waiting.empty() || bsm_.waiting[bsm].number < own_.waiting.front().number);
  };
  const bool is_bsm = is_before_own(0) && (own_.waiting.empty() || !is_before_own(kMostAhead));
  std::deque<Arrival>& waiting = is_bsm ? bsm_.waiting : own_.waiting;
  Arrival arrival = std::move(waiting.front());
  waiting.pop_front();
  return arrival;
}

}  // namespace v2vouch
