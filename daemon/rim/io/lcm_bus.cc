// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/io/lcm_bus.h"

#include <lcm/lcm.h>

#include <chrono>
#include <string_view>
#include <thread>
#include <utility>

#include "daemon/rim/io/event_log.h"
#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/io/udpm_receiver.h"

namespace v2vouch {
namespace {

// Beyond what waits in ours: the receive thread drains at once, so this only has to bridge a
// moment.
constexpr int kLiblcmQueue = 10'000;

std::string Escaped(const std::string& name) {
  std::string pattern;
  for (const char c : name) {
    if (std::string_view(".[]()*+?{}^$|\\").find(c) != std::string_view::npos) pattern += '\\';
    pattern += c;
  }
  return pattern;
}

}  // namespace

struct LcmBus::Subscription {
  Handler handler;
};

namespace {

// Called from C. The channel's name is not looked at: for a bare header it is that of an older
// message.
void OnReceive(const lcm_recv_buf_t* buffer, const char*, void* user) {
  const auto* subscription = static_cast<const LcmBus::Subscription*>(user);
  const std::size_t size = buffer->data_size;
  std::span<const std::uint8_t> bytes;
  if (size <= kMaxEventBytes) bytes = {static_cast<const std::uint8_t*>(buffer->data), size};
  try {
    subscription->handler(bytes, size, FromMicros(buffer->recv_utime));
  } catch (...) {
    // Out of memory at most. The message is lost; liblcm must not be left by an exception, or its
    // next call asserts.
  }
}

// For every channel. A bare header is left out: its channel is that of an older message.
void OnReceiveAny(const lcm_recv_buf_t* buffer, const char* channel, void* user) {
  if (buffer->data_size > kMaxEventBytes) return;
  try {
    (*static_cast<const LcmBus::AnyHandler*>(user))(
        channel, {static_cast<const std::uint8_t*>(buffer->data), buffer->data_size},
        FromMicros(buffer->recv_utime));
  } catch (...) {
    // As above.
  }
}

}  // namespace

std::unique_ptr<LcmBus> LcmBus::Open(const std::string& url) {
  const std::string effective = EffectiveLcmUrl(url);
  if (!LcmUrlProblems(effective).empty()) return nullptr;
  const std::string liblcm_url = UrlForLiblcm(effective);
  // Opens no receiving socket before its first subscription.
  lcm_t* lcm = lcm_create(liblcm_url.empty() ? nullptr : liblcm_url.c_str());
  if (lcm == nullptr) return nullptr;
  // liblcm hands out a tcpq bus whose server cannot be reached.
  if (effective.starts_with("tcpq:") && lcm_get_fileno(lcm) < 0) {
    lcm_destroy(lcm);
    return nullptr;
  }
  return std::unique_ptr<LcmBus>(new LcmBus(lcm, effective));
}

LcmBus::LcmBus(lcm_t* lcm, std::string url) : lcm_(lcm), url_(std::move(url)) {}

LcmBus::~LcmBus() { lcm_destroy(lcm_); }

bool LcmBus::Subscribe(const std::string& channel, Handler handler) {
  if (const auto own = OwnReceiverUrl(url_)) {
    if (!receiver_) receiver_ = UdpmReceiver::Open(*own);
    if (!receiver_) return false;
    receiver_->Subscribe(channel, std::move(handler));
    return true;
  }
  auto subscription = std::make_unique<Subscription>(Subscription{std::move(handler)});
  lcm_subscription_t* taken =
      lcm_subscribe(lcm_, Escaped(channel).c_str(), OnReceive, subscription.get());
  if (taken == nullptr) return false;
  lcm_subscription_set_queue_capacity(taken, kLiblcmQueue);
  subscriptions_.push_back(std::move(subscription));
  return true;
}

bool LcmBus::SubscribeAll(AnyHandler handler) {
  if (const auto own = OwnReceiverUrl(url_)) {
    if (!receiver_) receiver_ = UdpmReceiver::Open(*own);
    if (!receiver_) return false;
    receiver_->SubscribeAll(std::move(handler));
    return true;
  }
  any_ = std::make_unique<AnyHandler>(std::move(handler));
  lcm_subscription_t* taken = lcm_subscribe(lcm_, ".*", OnReceiveAny, any_.get());
  if (taken == nullptr) return false;
  lcm_subscription_set_queue_capacity(taken, kLiblcmQueue);
  return true;
}

bool LcmBus::Handle(int timeout_ms) {
  if (receiver_) {
    receiver_->Handle(timeout_ms);
    return true;
  }
  // liblcm would open its own receiving socket here.
  if (OwnReceiverUrl(url_)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(timeout_ms));
    return true;
  }
  // A tcpq server that went away, or no route: liblcm 1.3.1 would give select() a descriptor of -1,
  // which aborts the program.
  if (lcm_get_fileno(lcm_) < 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(timeout_ms));
    return false;
  }
  return lcm_handle_timeout(lcm_, timeout_ms) >= 0;
}

bool LcmBus::Publish(const std::string& channel, std::span<const std::uint8_t> bytes) {
  return lcm_publish(lcm_, channel.c_str(), bytes.data(),
                     static_cast<unsigned int>(bytes.size())) == 0;
}

lcm_packets::PacketCounts LcmBus::refused() const {
  return receiver_ ? receiver_->refused() : lcm_packets::PacketCounts{};
}

std::int64_t LcmBus::rejoins() const { return receiver_ ? receiver_->rejoins() : 0; }

}  // namespace v2vouch
