// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "daemon/obu/capture/live_capture.h"
#include "daemon/obu/gateway/gateway.h"
#include "daemon/rim/net/udp_receiver.h"

namespace v2vouch::obu {

/// One input of the configuration, open: a UDP socket or a network interface.
class InputDoor {
 public:
  /// @param index of the input.
  static std::unique_ptr<InputDoor> Open(const InputConfig& input, std::size_t index,
                                         std::string& error);

  /// Hands over what waits, at most 64. @return false where the interface is gone.
  bool Receive(const std::function<void(const Arrival&)>& sink);

  [[nodiscard]] int descriptor() const;
  [[nodiscard]] std::int64_t kernel_drops() const;
  [[nodiscard]] std::int64_t buffer_bytes() const;
  /// For the log: "address=0.0.0.0 port=5398", "interface=eth1".
  [[nodiscard]] std::string text() const;

 private:
  InputDoor(InputConfig input, std::size_t index) : input_(std::move(input)), index_(index) {}

  InputConfig input_;
  std::size_t index_;
  std::unique_ptr<net::UdpReceiver> socket_;
  std::unique_ptr<LiveCapture> capture_;
};

}  // namespace v2vouch::obu
