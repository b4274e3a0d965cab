// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "daemon/obu/capture/capture_file.h"

namespace v2vouch::obu {

/// What passes a network interface, by libpcap: Ethernet, or 802.11 of a card in monitor mode.
/// Needs the right to capture (root, or CAP_NET_RAW). Never blocks.
class LiveCapture {
 public:
  /// @param filter of libpcap (pcap-filter(7)); "" = everything.
  /// @return nullptr with what is wrong in `error`.
  static std::unique_ptr<LiveCapture> Open(const std::string& interface, const std::string& filter,
                                           int buffer_bytes, std::string& error);
  ~LiveCapture();
  LiveCapture(const LiveCapture&) = delete;
  LiveCapture& operator=(const LiveCapture&) = delete;

  /// Hands over what waits, at most 64 packets. @return how many; -1 where the interface is gone.
  int Receive(const std::function<void(const Captured&)>& sink);

  [[nodiscard]] int descriptor() const;      ///< To wait on.
  [[nodiscard]] std::int64_t drops() const;  ///< Of the kernel and the interface.

 private:
  struct Handle;
  explicit LiveCapture(std::unique_ptr<Handle> handle);
  std::unique_ptr<Handle> handle_;
};

}  // namespace v2vouch::obu
