// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/io/udpm_receiver.h"

#include <chrono>
#include <utility>

#include "daemon/rim/io/event_log.h"

namespace v2vouch {
namespace {

constexpr std::size_t kBatch = 32;

// For what waits too long: a clock that is never set.
std::int64_t Now() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

Timestamp WallClock() {
  return FromMicros(std::chrono::duration_cast<std::chrono::microseconds>(
                        std::chrono::system_clock::now().time_since_epoch())
                        .count());
}

}  // namespace

std::unique_ptr<UdpmReceiver> UdpmReceiver::Open(const UdpmUrl& url) {
  net::UdpOptions options;
  options.address = url.group;
  options.port = url.port;
  options.buffer_bytes = url.receive_buffer_bytes;
  options.longest = lcm_packets::kLongestDatagram;
  options.batch = kBatch;
  std::string error;
  if (!net::SourceFilter::Parse(url.sources, options.sources, error)) return nullptr;
  auto socket = net::UdpReceiver::Open(options, error);
  if (!socket) return nullptr;
  return std::unique_ptr<UdpmReceiver>(new UdpmReceiver(std::move(socket)));
}

UdpmReceiver::UdpmReceiver(std::unique_ptr<net::UdpReceiver> socket)
    : socket_(std::move(socket)),
      assembler_([this](std::string_view channel) { return any_ || handlers_.contains(channel); },
                 {.message_bytes = kMaxEventBytes}) {}

void UdpmReceiver::Subscribe(const std::string& channel, Handler handler) {
  handlers_[channel].push_back(std::move(handler));
}

void UdpmReceiver::Handle(int timeout_ms) {
  std::int64_t now_us = Now();
  const auto take = [&](const net::Datagram& datagram) { Take(datagram, now_us); };
  // What waits already costs one call of the system, not two.
  if (socket_->Receive(take) == 0) {
    const bool has_some = socket_->Wait(timeout_ms);
    now_us = Now();
    if (has_some) {
      socket_->Receive(take);
    } else {
      assembler_.Expire(now_us);
    }
  }
  TellCounts();
}

void UdpmReceiver::Take(const net::Datagram& datagram, std::int64_t now_us) {
  const lcm_packets::Sender sender{datagram.source.ipv4(), datagram.source.port};
  const auto message = assembler_.Take(datagram.bytes, sender, now_us);
  if (!message) return;
  const auto found = handlers_.find(message->channel);
  const Timestamp received = datagram.utime != 0 ? FromMicros(datagram.utime) : WallClock();
  if (any_) {
    try {
      any_(message->channel, message->bytes, received);
    } catch (...) {
      // As below.
    }
  }
  if (found == handlers_.end()) return;
  for (const Handler& handler : found->second) {
    try {
      handler(message->bytes, message->bytes.size(), received);
    } catch (...) {
      // Out of memory at most. The message is lost, as it is with liblcm.
    }
  }
}

void UdpmReceiver::TellCounts() {
  const lcm_packets::PacketCounts& counts = assembler_.counts();
  for (std::size_t i = 0; i < counts.size(); ++i) {
    refused_[i].store(counts[i], std::memory_order_relaxed);
  }
  refused_[static_cast<std::size_t>(lcm_packets::PacketFault::kSource)].store(
      static_cast<std::uint64_t>(socket_->strangers()), std::memory_order_relaxed);
  rejoins_.store(socket_->rejoins(), std::memory_order_relaxed);
}

lcm_packets::PacketCounts UdpmReceiver::refused() const {
  lcm_packets::PacketCounts counts{};
  for (std::size_t i = 0; i < counts.size(); ++i) {
    counts[i] = refused_[i].load(std::memory_order_relaxed);
  }
  return counts;
}

}  // namespace v2vouch
