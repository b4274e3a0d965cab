// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/spy/bus_listener.h"

#include <chrono>

#include "daemon/rim/io/lcm_url.h"

namespace v2vouch::spy {
namespace {

std::int64_t SteadyNow() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

std::int64_t BusListener::Now() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

std::unique_ptr<BusListener> BusListener::Open(const std::string& url, std::string& error) {
  const std::string effective = EffectiveLcmUrl(url);
  const auto parts = OwnReceiverUrl(effective);
  if (!parts) {
    error = effective + ": only udpm:// buses can be listened to";
    return nullptr;
  }
  net::UdpOptions options;
  options.address = parts->group;
  options.port = parts->port;
  options.buffer_bytes = parts->receive_buffer_bytes;
  options.longest = lcm_packets::kLongestDatagram;
  if (!net::SourceFilter::Parse(parts->sources, options.sources, error)) return nullptr;
  auto socket = net::UdpReceiver::Open(options, error);
  if (!socket) return nullptr;
  return std::unique_ptr<BusListener>(new BusListener(std::move(socket)));
}

BusListener::BusListener(std::unique_ptr<net::UdpReceiver> socket)
    : socket_(std::move(socket)), assembler_([](std::string_view) { return true; }) {}

int BusListener::Take() {
  const std::int64_t now_us = SteadyNow();
  return socket_->Receive([&](const net::Datagram& datagram) {
    const lcm_packets::Sender sender{datagram.source.ipv4(), datagram.source.port};
    const auto message = assembler_.Take(datagram.bytes, sender, now_us);
    if (!message) return;
    table_.Take(message->channel, message->bytes, datagram.utime != 0 ? datagram.utime : Now());
  });
}

void BusListener::Listen(int timeout_ms, int most_ms) {
  if (!socket_->Wait(timeout_ms)) {
    assembler_.Expire(SteadyNow());
    return;
  }
  const std::int64_t end_us = SteadyNow() + 1000 * std::int64_t{most_ms};
  while (Take() > 0 && SteadyNow() < end_us) {
  }
}

lcm_packets::PacketCounts BusListener::refused() const {
  auto counts = assembler_.counts();
  counts[static_cast<std::size_t>(lcm_packets::PacketFault::kSource)] =
      static_cast<std::uint64_t>(socket_->strangers());
  return counts;
}

}  // namespace v2vouch::spy
