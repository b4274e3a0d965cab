// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "daemon/common/base/time.h"
#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/lcm_packets/assembler.h"
#include "daemon/rim/net/udp_receiver.h"

namespace v2vouch {

/// Our own receiving end of udpm://: one socket, read by the thread that calls Handle(). No thread,
/// no queue: a handler runs as soon as its message is complete.
class UdpmReceiver {
 public:
  using Handler = std::function<void(std::span<const std::uint8_t> bytes, std::size_t size,
                                     Timestamp received)>;

  /// @return nullptr where the group cannot be joined, e.g. without a route.
  static std::unique_ptr<UdpmReceiver> Open(const UdpmUrl& url);

  void Subscribe(const std::string& channel, Handler handler);
  /// Hears every channel, besides those subscribed to. Set before the first Handle().
  using AnyHandler = std::function<void(std::string_view channel,
                                        std::span<const std::uint8_t> bytes, Timestamp received)>;
  void SubscribeAll(AnyHandler handler) { any_ = std::move(handler); }
  /// Waits up to `timeout_ms` for datagrams, then takes those that wait, up to a batch.
  void Handle(int timeout_ms);

  /// Refused below the message so far; from any thread.
  [[nodiscard]] lcm_packets::PacketCounts refused() const;
  [[nodiscard]] std::int64_t rejoins() const { return rejoins_; }

 private:
  // Looked up by the name as it lies in the datagram.
  struct NameHash {
    using is_transparent = void;
    std::size_t operator()(std::string_view name) const {
      return std::hash<std::string_view>()(name);
    }
  };
  explicit UdpmReceiver(std::unique_ptr<net::UdpReceiver> socket);
  void Take(const net::Datagram& datagram, std::int64_t now_us);
  void TellCounts();

  std::unique_ptr<net::UdpReceiver> socket_;
  std::unordered_map<std::string, std::vector<Handler>, NameHash, std::equal_to<>> handlers_;
  AnyHandler any_;
  lcm_packets::Assembler assembler_;
  std::array<std::atomic<std::uint64_t>, lcm_packets::kPacketFaultCount> refused_{};
  std::atomic<std::int64_t> rejoins_ = 0;
};

}  // namespace v2vouch
