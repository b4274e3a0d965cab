// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/net/udp_receiver.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <vector>

namespace v2vouch::net {
namespace {

constexpr std::chrono::seconds kRenewPeriod{1};

struct Address {
  sockaddr_storage storage{};
  socklen_t size = 0;
  bool is_multicast = false;
};

bool ParseAddress(const std::string& text, int port, Address& address) {
  auto* const v4 = reinterpret_cast<sockaddr_in*>(&address.storage);
  auto* const v6 = reinterpret_cast<sockaddr_in6*>(&address.storage);
  if (inet_pton(AF_INET, text.c_str(), &v4->sin_addr) == 1) {
    v4->sin_family = AF_INET;
    v4->sin_port = htons(static_cast<std::uint16_t>(port));
    address.size = sizeof *v4;
    address.is_multicast = (ntohl(v4->sin_addr.s_addr) >> 28) == 0xE;
    return true;
  }
  if (inet_pton(AF_INET6, text.c_str(), &v6->sin6_addr) == 1) {
    v6->sin6_family = AF_INET6;
    v6->sin6_port = htons(static_cast<std::uint16_t>(port));
    address.size = sizeof *v6;
    return true;
  }
  return false;
}

Source SourceOf(const sockaddr_storage& from) {
  Source source;
  if (from.ss_family == AF_INET) {
    const auto* const v4 = reinterpret_cast<const sockaddr_in*>(&from);
    source.address = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF};
    std::memcpy(source.address.data() + 12, &v4->sin_addr, 4);
    source.port = ntohs(v4->sin_port);
  } else if (from.ss_family == AF_INET6) {
    const auto* const v6 = reinterpret_cast<const sockaddr_in6*>(&from);
    std::memcpy(source.address.data(), &v6->sin6_addr, 16);
    source.port = ntohs(v6->sin6_port);
  }
  return source;
}

bool Set(int descriptor, int level, int option, int value) {
  return setsockopt(descriptor, level, option, &value, sizeof value) == 0;
}

}  // namespace

// One byte more than the longest: what fills it was longer, whatever the kernel says.
struct UdpReceiver::Batch {
  struct Slot {
    alignas(cmsghdr) std::array<char, 128> control;
    sockaddr_storage from;
    iovec piece;
  };
  Batch(std::size_t count, std::size_t longest)
      : stride(longest + 1), bytes(new std::uint8_t[count * stride]), slots(count), headers(count) {
    for (std::size_t i = 0; i < count; ++i) Prepare(i);
  }
  void Prepare(std::size_t i) {
    slots[i].piece = {bytes.get() + i * stride, stride};
    msghdr& header = headers[i].msg_hdr;
    header = msghdr{};
    header.msg_name = &slots[i].from;
    header.msg_namelen = sizeof slots[i].from;
    header.msg_iov = &slots[i].piece;
    header.msg_iovlen = 1;
    header.msg_control = slots[i].control.data();
    header.msg_controllen = slots[i].control.size();
  }

  std::size_t stride;
  std::unique_ptr<std::uint8_t[]>
      bytes;  // Not filled: pages that no datagram reaches cost nothing.
  std::vector<Slot> slots;
  std::vector<mmsghdr> headers;
};

UdpReceiver::UdpReceiver(int descriptor, const UdpOptions& options)
    : descriptor_(descriptor),
      longest_(options.longest),
      sources_(options.sources),
      renewed_(std::chrono::steady_clock::now()),
      batch_(std::make_unique<Batch>(options.batch, options.longest)) {}

UdpReceiver::~UdpReceiver() { close(descriptor_); }

std::unique_ptr<UdpReceiver> UdpReceiver::Open(const UdpOptions& options, std::string& error) {
  const std::string name = options.address + ":" + std::to_string(options.port);
  const auto failed = [&](int code) {
    error = name + ": " + std::strerror(code);
    return nullptr;
  };
  Address own;
  if (!ParseAddress(options.address, options.port, own)) {
    error = name + ": is no IPv4 or IPv6 address";
    return nullptr;
  }
  const int descriptor =
      socket(own.storage.ss_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return failed(errno);
  std::unique_ptr<UdpReceiver> receiver(new UdpReceiver(descriptor, options));
  // Several programs may listen to a group; a unicast port belongs to one program.
  if (own.is_multicast) {
    Set(descriptor, SOL_SOCKET, SO_REUSEADDR, 1);
    Set(descriptor, IPPROTO_IP, IP_MULTICAST_ALL, 0);
  }
  Set(descriptor, SOL_SOCKET, SO_TIMESTAMPNS, 1);
  Set(descriptor, SOL_SOCKET, SO_RXQ_OVFL, 1);
  Set(descriptor, SOL_SOCKET, SO_RCVBUF, options.buffer_bytes);
  if (bind(descriptor, reinterpret_cast<const sockaddr*>(&own.storage), own.size) != 0) {
    return failed(errno);
  }
  if (own.is_multicast) {
    receiver->membership_.emplace(
        descriptor, reinterpret_cast<const sockaddr_in*>(&own.storage)->sin_addr.s_addr);
    if (const int code = receiver->membership_->Join(); code != 0) return failed(code);
  }
  int granted = 0;
  socklen_t size = sizeof granted;
  if (getsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &granted, &size) == 0) {
    receiver->buffer_bytes_ = granted;
  }
  Address bound;
  bound.size = sizeof bound.storage;
  getsockname(descriptor, reinterpret_cast<sockaddr*>(&bound.storage), &bound.size);
  receiver->port_ = SourceOf(bound.storage).port;
  return receiver;
}

void UdpReceiver::KeepMembership() {
  if (!membership_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - renewed_ < kRenewPeriod) return;
  renewed_ = now;
  if (membership_->Renew()) ++rejoins_;
}

bool UdpReceiver::Wait(int timeout_ms) const {
  pollfd wait{descriptor_, POLLIN, 0};
  return poll(&wait, 1, timeout_ms) > 0;
}

void UdpReceiver::ReadControl(void* header, Datagram& datagram) {
  auto* const message = static_cast<msghdr*>(header);
  for (cmsghdr* each = CMSG_FIRSTHDR(message); each != nullptr; each = CMSG_NXTHDR(message, each)) {
    if (each->cmsg_level != SOL_SOCKET) continue;
    if (each->cmsg_type == SCM_TIMESTAMPNS) {
      timespec time{};
      std::memcpy(&time, CMSG_DATA(each), sizeof time);
      datagram.utime = std::int64_t{time.tv_sec} * 1000000 + time.tv_nsec / 1000;
    } else if (each->cmsg_type == SO_RXQ_OVFL) {
      std::uint32_t counter = 0;
      std::memcpy(&counter, CMSG_DATA(each), sizeof counter);
      kernel_drops_ += static_cast<std::uint32_t>(counter - drop_counter_);
      drop_counter_ = counter;
    }
  }
}

int UdpReceiver::Receive(const std::function<void(const Datagram&)>& sink) {
  KeepMembership();
  Batch& batch = *batch_;
  const int count = recvmmsg(descriptor_, batch.headers.data(),
                             static_cast<unsigned>(batch.headers.size()), MSG_DONTWAIT, nullptr);
  for (int n = 0; n < count; ++n) {
    const auto i = static_cast<std::size_t>(n);
    msghdr& header = batch.headers[i].msg_hdr;
    const std::size_t size = batch.headers[i].msg_len;
    Datagram datagram;
    datagram.is_cut = (header.msg_flags & MSG_TRUNC) != 0 || size > longest_;
    datagram.bytes = {batch.bytes.get() + i * batch.stride, std::min(size, longest_)};
    datagram.source = SourceOf(batch.slots[i].from);
    ReadControl(&header, datagram);
    if (sources_.Allows(datagram.source)) {
      sink(datagram);
    } else {
      ++strangers_;
    }
    batch.Prepare(i);
  }
  return std::max(count, 0);
}

}  // namespace v2vouch::net
