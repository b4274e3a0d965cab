// SPDX-License-Identifier: Apache-2.0
#include "daemon/app/message_queue.h"

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
  std::deque<Arrival>* oldest = nullptr;
  for (std::deque<Arrival>* waiting : {&own_.waiting, &bsm_.waiting}) {
    if (waiting->empty()) continue;
    if (oldest == nullptr || waiting->front().number < oldest->front().number) oldest = waiting;
  }
  if (oldest == nullptr) return std::nullopt;
  Arrival arrival = std::move(oldest->front());
  oldest->pop_front();
  return arrival;
}

}  // namespace v2vouch
