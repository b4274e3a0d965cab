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

  /// Hands over what waits, at most 64. An interface that goes away is opened again once it is
  /// back, looked for once a second. @return false while it is gone.
  bool Receive(const std::function<void(const Arrival&)>& sink);

  [[nodiscard]] int descriptor() const;  ///< To wait on; -1 while the interface is gone.
  [[nodiscard]] std::int64_t kernel_drops() const;
  [[nodiscard]] std::int64_t buffer_bytes() const;
  /// For the log: "address=0.0.0.0 port=5398", "interface=eth1".
  [[nodiscard]] std::string text() const;

 private:
  InputDoor(InputConfig input, std::size_t index) : input_(std::move(input)), index_(index) {}

  bool OpenCapture(std::string& error);

  InputConfig input_;
  std::size_t index_;
  std::int64_t retry_utime_ = 0;
  std::int64_t earlier_drops_ = 0;  // Of captures that have ended.
  std::unique_ptr<net::UdpReceiver> socket_;
  std::unique_ptr<LiveCapture> capture_;
};

}  // namespace v2vouch::obu
