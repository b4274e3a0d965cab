// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "daemon/programs/spy/channel_table.h"
#include "daemon/rim/lcm_packets/assembler.h"
#include "daemon/rim/net/udp_receiver.h"

namespace v2vouch::spy {

/// Every channel of a udpm:// URL into a table, by our own receive path: no datagram can harm it.
class BusListener {
 public:
  /// @return nullptr with what is wrong in `error`.
  static std::unique_ptr<BusListener> Open(const std::string& url, std::string& error);
  /// Waits up to `timeout_ms`, then takes what waits, for at most `most_ms`.
  void Listen(int timeout_ms, int most_ms);

  [[nodiscard]] const ChannelTable& table() const { return table_; }
  [[nodiscard]] lcm_packets::PacketCounts refused() const;
  [[nodiscard]] std::int64_t kernel_drops() const { return socket_->kernel_drops(); }
  static std::int64_t Now();  ///< Wall clock [us], as arrivals are stamped.

 private:
  explicit BusListener(std::unique_ptr<net::UdpReceiver> socket);
  int Take();

  std::unique_ptr<net::UdpReceiver> socket_;
  lcm_packets::Assembler assembler_;
  ChannelTable table_;
};

}  // namespace v2vouch::spy
