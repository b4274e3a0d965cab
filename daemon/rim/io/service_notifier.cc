// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/io/service_notifier.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <utility>

namespace v2vouch {
namespace {

std::optional<std::chrono::microseconds> WatchdogOfEnvironment() {
  const char* period = std::getenv("WATCHDOG_USEC");
  if (period == nullptr) return std::nullopt;
  if (const char* pid = std::getenv("WATCHDOG_PID"); pid && std::atol(pid) != getpid()) {
    return std::nullopt;  // Meant for another process that handed the variables on.
  }
  const long long micros = std::atoll(period);
  if (micros <= 0) return std::nullopt;
  return std::chrono::microseconds(micros);
}

}  // namespace

ServiceNotifier ServiceNotifier::FromEnvironment() {
  ServiceNotifier notifier;
  const char* address = std::getenv("NOTIFY_SOCKET");
  if (address == nullptr || (*address != '/' && *address != '@')) return notifier;
  notifier.address_ = address;
  if (notifier.address_.size() >= sizeof(sockaddr_un::sun_path)) return notifier;
  if (notifier.address_[0] == '@') notifier.address_[0] = '\0';
  notifier.socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (notifier.socket_ >= 0) notifier.watchdog_ = WatchdogOfEnvironment();
  return notifier;
}

ServiceNotifier::~ServiceNotifier() {
  if (socket_ >= 0) close(socket_);
}

ServiceNotifier::ServiceNotifier(ServiceNotifier&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)),
      address_(std::move(other.address_)),
      watchdog_(other.watchdog_) {}

bool ServiceNotifier::Send(std::string_view words) const {
  if (socket_ < 0) return false;
  sockaddr_un to{};
  to.sun_family = AF_UNIX;
  std::memcpy(to.sun_path, address_.data(), address_.size());
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + address_.size());
  const ssize_t sent = sendto(socket_, words.data(), words.size(), MSG_NOSIGNAL,
                              reinterpret_cast<const sockaddr*>(&to), length);
  return sent == static_cast<ssize_t>(words.size());
}

}  // namespace v2vouch
