// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace v2vouch {

/// Tells the service manager how it stands with this process: datagrams to $NOTIFY_SOCKET, as
/// systemd's sd_notify(3) defines them. Without that variable nothing is sent.
class ServiceNotifier {
 public:
  /// Reads NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID.
  static ServiceNotifier FromEnvironment();
  ~ServiceNotifier();
  ServiceNotifier(ServiceNotifier&& other) noexcept;
  ServiceNotifier(const ServiceNotifier&) = delete;
  ServiceNotifier& operator=(const ServiceNotifier&) = delete;

  /// "READY=1", "STATUS=...", "WATCHDOG=1", "STOPPING=1"; several with a newline between. Never
  /// waits. @return false where it could not be sent or nobody is to be told.
  bool Send(std::string_view words) const;

  /// Within which time a WATCHDOG=1 is expected; nullopt where none is.
  [[nodiscard]] std::optional<std::chrono::microseconds> watchdog() const { return watchdog_; }

 private:
  ServiceNotifier() = default;
  int socket_ = -1;
  std::string address_;  // Path; '\0' first where it is an abstract name.
  std::optional<std::chrono::microseconds> watchdog_;
};

}  // namespace v2vouch
