// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/obu/octets/byte_reader.h"

namespace v2vouch::obu {

struct ReceivedDatagram {
  Bytes bytes;
  std::string_view source;  ///< Address of the sender, as text.
  std::int64_t utime = 0;   ///< By the kernel, us UTC; 0 where it gave none.
  bool is_cut = false;      ///< Longer than kLongestDatagram.
};

/// One UDP socket. Fixed memory; never blocks.
class UdpReceiver {
 public:
  /// @param address own IPv4 or IPv6 address; an IPv4 multicast group is joined.
  /// @return nullptr with what is wrong in `error`.
  static std::unique_ptr<UdpReceiver> Open(const std::string& address, int port, int buffer_bytes,
                                           std::string& error);
  ~UdpReceiver();
  UdpReceiver(const UdpReceiver&) = delete;
  UdpReceiver& operator=(const UdpReceiver&) = delete;

  /// Hands over what waits, at most 64 datagrams. @return how many.
  int Receive(const std::function<void(const ReceivedDatagram&)>& sink);

  [[nodiscard]] int descriptor() const { return descriptor_; }
  [[nodiscard]] int port() const { return port_; }  ///< The one given by the kernel for port 0.
  [[nodiscard]] std::int64_t kernel_drops() const { return kernel_drops_; }
  [[nodiscard]] std::int64_t buffer_bytes() const { return buffer_bytes_; }

 private:
  struct Batch;
  explicit UdpReceiver(int descriptor);

  int descriptor_;
  int port_ = 0;
  std::int64_t kernel_drops_ = 0;
  std::int64_t buffer_bytes_ = 0;
  std::unique_ptr<Batch> batch_;
};

}  // namespace v2vouch::obu
