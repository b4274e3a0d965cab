// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/v2vouchd/background_publisher.h"

#include <memory>
#include <utility>

#include "daemon/programs/v2vouchd/low_priority.h"
#include "daemon/rim/io/lcm_bus.h"

namespace v2vouch {

BackgroundPublisher::BackgroundPublisher(std::string url)
    : url_(std::move(url)), thread_([this] { Run(); }) {}

BackgroundPublisher::~BackgroundPublisher() {
  {
    const std::lock_guard lock(mutex_);
    must_stop_ = true;
  }
  has_one_.notify_one();
  thread_.join();
}

void BackgroundPublisher::Offer(const std::string& channel, std::span<const std::uint8_t> bytes) {
  {
    const std::lock_guard lock(mutex_);
    channel_ = channel;
    bytes_.assign(bytes.begin(), bytes.end());
    is_waiting_ = true;
  }
  has_one_.notify_one();
}

void BackgroundPublisher::Run() {
  LowerThreadPriority();
  std::unique_ptr<LcmBus> bus;
  std::string channel;
  std::vector<std::uint8_t> bytes;
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      has_one_.wait(lock, [this] { return is_waiting_ || must_stop_; });
      if (must_stop_) return;
      std::swap(channel, channel_);
      std::swap(bytes, bytes_);
      is_waiting_ = false;
    }
    if (!bus) bus = LcmBus::Open(url_);
    if (bus) bus->Publish(channel, bytes);
  }
}

}  // namespace v2vouch
