// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/obu/input_door.h"

#include <chrono>

namespace v2vouch::obu {
namespace {

constexpr int kReceiveBufferBytes = 4 << 20;
constexpr std::int64_t kRetry_us = 1000000;

std::int64_t Now() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

// Without a filter, what we publish over LCM would come back in, and all else that passes by.
std::string DefaultFilter(const InputConfig& input) {
  return "(udp dst port " + std::to_string(input.port) +
         ") or (ether proto 0x88dc) or (ether proto 0x8947)";
}

}  // namespace

std::unique_ptr<InputDoor> InputDoor::Open(const InputConfig& input, std::size_t index,
                                           std::string& error) {
  std::unique_ptr<InputDoor> door(new InputDoor(input, index));
  if (input.interface.empty()) {
    door->socket_ = net::UdpReceiver::Open({.address = input.bind,
                                            .port = input.port,
                                            .buffer_bytes = kReceiveBufferBytes,
                                            .longest = kLongestDatagram,
                                            .batch = 64,
                                            .sources = {}},  // The gateway judges and counts.
                                           error);
    return door->socket_ ? std::move(door) : nullptr;
  }
  return door->OpenCapture(error) ? std::move(door) : nullptr;
}

bool InputDoor::OpenCapture(std::string& error) {
  const bool has_filter = !input_.filter.empty();
  capture_ = LiveCapture::Open(input_.interface, has_filter ? input_.filter : DefaultFilter(input_),
                               kReceiveBufferBytes, error);
  // An 802.11 interface has no Ethernet types to filter by.
  if (!capture_ && !has_filter) {
    std::string other;
    capture_ = LiveCapture::Open(input_.interface, "", kReceiveBufferBytes, other);
  }
  return capture_ != nullptr;
}

bool InputDoor::Receive(const std::function<void(const Arrival&)>& sink) {
  if (!input_.interface.empty()) {
    if (!capture_) {
      const std::int64_t now = Now();
      std::string error;
      if (now < retry_utime_ && retry_utime_ - now <= kRetry_us) return false;
      retry_utime_ = now + kRetry_us;
      if (!OpenCapture(error)) return false;
    }
    const int count = capture_->Receive([&](const Captured& packet) {
      sink({packet.bytes, input_.interface, index_, packet.utime != 0 ? packet.utime : Now(),
            packet.is_cut, packet.link_type});
    });
    if (count >= 0) return true;
    earlier_drops_ += capture_->drops();
    capture_.reset();
    return false;
  }
  socket_->Receive([&](const net::Datagram& datagram) {
    const std::string source = datagram.source.Text();
    sink({datagram.bytes, source, index_, datagram.utime != 0 ? datagram.utime : Now(),
          datagram.is_cut});
  });
  return true;
}

int InputDoor::descriptor() const {
  if (socket_) return socket_->descriptor();
  return capture_ ? capture_->descriptor() : -1;
}
std::int64_t InputDoor::kernel_drops() const {
  if (socket_) return socket_->kernel_drops();
  return earlier_drops_ + (capture_ ? capture_->drops() : 0);
}
std::int64_t InputDoor::buffer_bytes() const {
  return socket_ ? socket_->buffer_bytes() : kReceiveBufferBytes;
}

std::string InputDoor::text() const {
  if (!socket_) return "interface=" + input_.interface;
  return "address=" + input_.bind + " port=" + std::to_string(socket_->port());
}

}  // namespace v2vouch::obu
