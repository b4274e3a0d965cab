// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/receive/udp_receiver.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>

#include "daemon/obu/octets/hex_text.h"

namespace v2vouch::obu {
namespace {

constexpr std::size_t kBatch = 64;

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

// As text; an IPv4 sender on an IPv6 socket keeps its IPv4 form.
std::string_view SourceText(const sockaddr_storage& from, std::array<char, 64>& text) {
  if (from.ss_family == AF_INET) {
    const auto* const v4 = reinterpret_cast<const sockaddr_in*>(&from);
    inet_ntop(AF_INET, &v4->sin_addr, text.data(), static_cast<socklen_t>(text.size()));
  } else if (from.ss_family == AF_INET6) {
    const auto* const v6 = reinterpret_cast<const sockaddr_in6*>(&from);
    inet_ntop(AF_INET6, &v6->sin6_addr, text.data(), static_cast<socklen_t>(text.size()));
  } else {
    text[0] = '\0';
  }
  std::string_view view(text.data());
  if (view.starts_with("::ffff:") && view.find('.') != std::string_view::npos) {
    view.remove_prefix(7);
  }
  return view;
}

bool SetFlag(int descriptor, int level, int option) {
  const int on = 1;
  return setsockopt(descriptor, level, option, &on, sizeof on) == 0;
}

}  // namespace

// One byte more than the longest: what fills it was longer, whatever the kernel says.
struct UdpReceiver::Batch {
  std::array<std::array<std::uint8_t, kLongestDatagram + 1>, kBatch> bytes;
  std::array<std::array<char, 128>, kBatch> control;
  std::array<sockaddr_storage, kBatch> from;
  std::array<iovec, kBatch> pieces;
  std::array<mmsghdr, kBatch> headers;
};

UdpReceiver::UdpReceiver(int descriptor)
    : descriptor_(descriptor), batch_(std::make_unique<Batch>()) {}

UdpReceiver::~UdpReceiver() { close(descriptor_); }

std::unique_ptr<UdpReceiver> UdpReceiver::Open(const std::string& address, int port,
                                               int buffer_bytes, std::string& error) {
  const std::string name = address + ":" + std::to_string(port);
  Address own;
  if (!ParseAddress(address, port, own)) {
    error = name + ": is no IPv4 or IPv6 address";
    return nullptr;
  }
  const int descriptor =
      socket(own.storage.ss_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (descriptor < 0) {
    error = name + ": " + std::strerror(errno);
    return nullptr;
  }
  std::unique_ptr<UdpReceiver> receiver(new UdpReceiver(descriptor));
  // Several may listen to a group; a port of one's own is nobody else's.
  if (own.is_multicast) SetFlag(descriptor, SOL_SOCKET, SO_REUSEADDR);
  SetFlag(descriptor, SOL_SOCKET, SO_TIMESTAMPNS);
  SetFlag(descriptor, SOL_SOCKET, SO_RXQ_OVFL);
  setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &buffer_bytes, sizeof buffer_bytes);
  if (bind(descriptor, reinterpret_cast<const sockaddr*>(&own.storage), own.size) != 0) {
    error = name + ": " + std::strerror(errno);
    return nullptr;
  }
  if (own.is_multicast) {
    ip_mreqn group{};
    group.imr_multiaddr = reinterpret_cast<const sockaddr_in*>(&own.storage)->sin_addr;
    const int off = 0;
    setsockopt(descriptor, IPPROTO_IP, IP_MULTICAST_ALL, &off, sizeof off);
    if (setsockopt(descriptor, IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof group) != 0) {
      error = name + ": " + std::strerror(errno);
      return nullptr;
    }
  }
  int granted = 0;
  socklen_t size = sizeof granted;
  if (getsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &granted, &size) == 0) {
    receiver->buffer_bytes_ = granted;
  }
  Address bound;
  bound.size = sizeof bound.storage;
  getsockname(descriptor, reinterpret_cast<sockaddr*>(&bound.storage), &bound.size);
  receiver->port_ = ntohs(reinterpret_cast<const sockaddr_in*>(&bound.storage)->sin_port);
  return receiver;
}

int UdpReceiver::Receive(const std::function<void(const ReceivedDatagram&)>& sink) {
  Batch& batch = *batch_;
  for (std::size_t i = 0; i < kBatch; ++i) {
    batch.pieces[i] = {batch.bytes[i].data(), batch.bytes[i].size()};
    msghdr& header = batch.headers[i].msg_hdr;
    header = msghdr{};
    header.msg_name = &batch.from[i];
    header.msg_namelen = sizeof batch.from[i];
    header.msg_iov = &batch.pieces[i];
    header.msg_iovlen = 1;
    header.msg_control = batch.control[i].data();
    header.msg_controllen = batch.control[i].size();
  }
  const int count = recvmmsg(descriptor_, batch.headers.data(), kBatch, MSG_DONTWAIT, nullptr);
  for (int n = 0; n < count; ++n) {
    const auto i = static_cast<std::size_t>(n);
    msghdr& header = batch.headers[i].msg_hdr;
    ReceivedDatagram datagram;
    const std::size_t size = batch.headers[i].msg_len;
    datagram.is_cut = (header.msg_flags & MSG_TRUNC) != 0 || size > kLongestDatagram;
    datagram.bytes = Bytes(batch.bytes[i].data(), std::min(size, kLongestDatagram));
    for (cmsghdr* each = CMSG_FIRSTHDR(&header); each != nullptr;
         each = CMSG_NXTHDR(&header, each)) {
      if (each->cmsg_level != SOL_SOCKET) continue;
      if (each->cmsg_type == SCM_TIMESTAMPNS) {
        timespec time{};
        std::memcpy(&time, CMSG_DATA(each), sizeof time);
        datagram.utime = std::int64_t{time.tv_sec} * 1000000 + time.tv_nsec / 1000;
      } else if (each->cmsg_type == SO_RXQ_OVFL) {
        std::uint32_t drops = 0;
        std::memcpy(&drops, CMSG_DATA(each), sizeof drops);
        kernel_drops_ = drops;
      }
    }
    std::array<char, 64> text{};
    datagram.source = SourceText(batch.from[i], text);
    sink(datagram);
  }
  return std::max(count, 0);
}

}  // namespace v2vouch::obu
