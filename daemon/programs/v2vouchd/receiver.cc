// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/v2vouchd/receiver.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "daemon/programs/v2vouchd/low_priority.h"

namespace v2vouch {
namespace {

using std::chrono::milliseconds;

constexpr int kHandleTimeout_ms = 100;
constexpr milliseconds kFirstPause{100};
constexpr milliseconds kLongestPause{2000};
constexpr milliseconds kSlice{50};  // How soon a stop is noticed.

}  // namespace

Receiver::Receiver(std::string url, std::vector<Subscription> subscriptions, Priority priority)
    : url_(std::move(url)),
      subscriptions_(std::move(subscriptions)),
      priority_(priority),
      thread_([this] { Run(); }) {}

Receiver::~Receiver() {
  must_stop_ = true;
  thread_.join();
}

bool Receiver::Open() {
  auto bus = LcmBus::Open(url_);
  if (!bus) return false;
  for (const Subscription& subscription : subscriptions_) {
    if (!bus->Subscribe(subscription.channel, subscription.sink)) return false;
  }
  bus_ = std::move(bus);
  is_open_ = true;
  return true;
}

void Receiver::Run() {
  if (priority_ == Priority::kLow)
    LowerThreadPriority();  // And that of liblcm's own thread, where it has one.
  for (milliseconds pause = kFirstPause; !must_stop_ && !Open();
       pause = std::min(2 * pause, kLongestPause)) {
    ++failures_;
    for (milliseconds waited{0}; waited < pause && !must_stop_; waited += kSlice) {
      ++ticks_;
      std::this_thread::sleep_for(kSlice);
    }
  }
  while (!must_stop_) {
    ++ticks_;
    if (!bus_->Handle(kHandleTimeout_ms)) std::this_thread::sleep_for(kSlice);
  }
}

bool Receiver::Publish(const std::string& channel, std::span<const std::uint8_t> bytes) {
  return is_open_ && bus_->Publish(channel, bytes);
}

}  // namespace v2vouch
