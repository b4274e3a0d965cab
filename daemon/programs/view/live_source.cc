// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/view/live_source.h"

#include <chrono>
#include <utility>

#include "daemon/rim/io/lcm_bus.h"

namespace v2vouch {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kMostBytes = 16u << 20;
constexpr int kHandleTimeout_ms = 100;
constexpr milliseconds kPause{200};  // Before the bus is tried again.

}  // namespace

LiveSource::LiveSource(std::string url, std::vector<std::string> channels)
    : url_(std::move(url)), channels_(std::move(channels)), thread_([this] { Run(); }) {}

LiveSource::~LiveSource() {
  must_stop_ = true;
  thread_.join();
}

void LiveSource::Drain(std::vector<Message>& messages) {
  messages.clear();
  const std::lock_guard lock(mutex_);
  messages.swap(waiting_);
  waiting_bytes_ = 0;
}

void LiveSource::Run() {
  while (!must_stop_) {
    const auto bus = LcmBus::Open(url_);
    bool is_good = bus != nullptr;
    for (const std::string& channel : channels_) {
      is_good = is_good && bus->Subscribe(channel, [this, channel](auto bytes, std::size_t size,
                                                                   Timestamp received) {
        if (bytes.size() != size) return;
        const std::lock_guard lock(mutex_);
        if (waiting_bytes_ + size > kMostBytes) {
          ++dropped_;
          return;
        }
        waiting_bytes_ += size + 100;
        waiting_.push_back({channel, {bytes.begin(), bytes.end()}, received});
      });
    }
    is_open_ = is_good;
    while (is_good && !must_stop_) {
      if (!bus->Handle(kHandleTimeout_ms)) std::this_thread::sleep_for(kPause);
    }
    if (!must_stop_) std::this_thread::sleep_for(kPause);
  }
}

}  // namespace v2vouch
