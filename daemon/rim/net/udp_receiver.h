// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "daemon/rim/net/membership.h"
#include "daemon/rim/net/source.h"

namespace v2vouch::net {

struct UdpOptions {
  std::string address;          ///< Own IPv4 or IPv6 address; an IPv4 multicast group is joined.
  int port = 0;                 ///< 0: of the kernel's choice.
  int buffer_bytes = 4 << 20;   ///< Asked of the kernel; it grants what net.core.rmem_max allows.
  std::size_t longest = 65507;  ///< Of a datagram; what is longer is cut and marked.
  std::size_t batch = 64;       ///< Datagrams taken at once, at most.
  SourceFilter sources{};       ///< Who may send.
};

struct Datagram {
  std::span<const std::uint8_t> bytes;
  Source source;
  std::int64_t utime = 0;  ///< Reception by the kernel, us UTC; 0 where it gave none.
  bool is_cut = false;     ///< Longer than UdpOptions::longest.
};

/// One UDP socket. Fixed memory; Receive() never blocks. A group's socket hears what is sent to the
/// group and nothing else of its port, and joins again within a second where the system lost the
/// membership: interface removed, made new, or without address for a moment.
class UdpReceiver {
 public:
  /// @return nullptr with what is wrong in `error`.
  static std::unique_ptr<UdpReceiver> Open(const UdpOptions& options, std::string& error);
  ~UdpReceiver();
  UdpReceiver(const UdpReceiver&) = delete;
  UdpReceiver& operator=(const UdpReceiver&) = delete;

  /// Hands over what waits, at most a batch. @return how many, those from strangers included.
  int Receive(const std::function<void(const Datagram&)>& sink);
  /// Until something waits. @return false where nothing came in time.
  [[nodiscard]] bool Wait(int timeout_ms) const;

  [[nodiscard]] int descriptor() const { return descriptor_; }
  [[nodiscard]] int port() const { return port_; }  ///< The one given by the kernel for port 0.
  /// Datagrams that the kernel had no room for, as told with the newest one.
  [[nodiscard]] std::int64_t kernel_drops() const { return kernel_drops_; }
  [[nodiscard]] std::int64_t buffer_bytes() const { return buffer_bytes_; }  ///< Granted.
  [[nodiscard]] std::int64_t strangers() const { return strangers_; }        ///< Not allowed.
  [[nodiscard]] std::int64_t rejoins() const { return rejoins_; }

 private:
  struct Batch;
  UdpReceiver(int descriptor, const UdpOptions& options);
  void KeepMembership();
  void ReadControl(void* header, Datagram& datagram);

  int descriptor_;
  std::size_t longest_;
  SourceFilter sources_;
  int port_ = 0;
  std::uint32_t drop_counter_ = 0;  // The kernel's, which wraps.
  std::int64_t kernel_drops_ = 0;
  std::int64_t buffer_bytes_ = 0;
  std::int64_t strangers_ = 0;
  std::int64_t rejoins_ = 0;
  std::optional<Membership> membership_;
  std::chrono::steady_clock::time_point renewed_;
  std::unique_ptr<Batch> batch_;
};

}  // namespace v2vouch::net
