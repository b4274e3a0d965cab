// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/net/membership.h"

#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>

namespace v2vouch::net {
namespace {

// Index of the interface that the routes name for the group; 0 where there is none. The kernel is
// asked (RTM_GETROUTE): an own address would not do, since multicast on `lo` has none.
int DeviceTowards(std::uint32_t group) {
  struct {
    nlmsghdr header{};
    rtmsg route{};
    rtattr attribute{};
    std::uint32_t address = 0;
  } request;
  request.header.nlmsg_len = sizeof request;
  request.header.nlmsg_type = RTM_GETROUTE;
  request.header.nlmsg_flags = NLM_F_REQUEST;
  request.route.rtm_family = AF_INET;
  request.route.rtm_dst_len = 32;
  request.attribute.rta_type = RTA_DST;
  request.attribute.rta_len = RTA_LENGTH(sizeof group);
  request.address = group;
  const int netlink = socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE);
  if (netlink < 0) return 0;
  alignas(nlmsghdr) std::array<char, 4096> answer{};
  const bool is_asked = send(netlink, &request, sizeof request, 0) == sizeof request;
  const ssize_t size = is_asked ? recv(netlink, answer.data(), answer.size(), 0) : -1;
  close(netlink);
  const auto* const header = reinterpret_cast<const nlmsghdr*>(answer.data());
  if (size < static_cast<ssize_t>(sizeof(nlmsghdr)) || header->nlmsg_type != RTM_NEWROUTE ||
      header->nlmsg_len > static_cast<std::size_t>(size)) {
    return 0;
  }
  const auto* const route = reinterpret_cast<const rtmsg*>(NLMSG_DATA(header));
  int left = static_cast<int>(RTM_PAYLOAD(header));
  for (const rtattr* each = RTM_RTA(route); RTA_OK(each, left); each = RTA_NEXT(each, left)) {
    if (each->rta_type != RTA_OIF) continue;
    int device = 0;
    std::memcpy(&device, RTA_DATA(each), sizeof device);
    return device;
  }
  return 0;
}

// Whether the interface listens to the group. Where the table cannot be read it is taken to.
bool IsListening(int device, std::uint32_t group) {
  std::ifstream table("/proc/net/igmp");
  std::string line;
  if (!std::getline(table, line)) return true;
  bool is_ours = false;
  while (std::getline(table, line)) {
    if (!line.empty() && line.front() != '\t') {  // "2  eth0  : ..."
      is_ours = std::atoi(line.c_str()) == device;
    } else if (is_ours && std::strtoul(line.c_str(), nullptr, 16) == group) {
      return true;
    }
  }
  return false;
}

}  // namespace

int Membership::Set(int option, int device) const {
  ip_mreqn request{};
  request.imr_multiaddr.s_addr = group_;
  request.imr_ifindex = device;
  return setsockopt(descriptor_, IPPROTO_IP, option, &request, sizeof request) == 0 ? 0 : errno;
}

int Membership::Join() {
  device_ = DeviceTowards(group_);
  return Set(IP_ADD_MEMBERSHIP, device_);  // 0: the kernel asks the routes itself.
}

bool Membership::Renew() {
  const int device = DeviceTowards(group_);
  if (device == 0) return false;  // Down: some day there is a route again.
  if (device == device_ && IsListening(device, group_)) return false;
  // The old one first: left behind on an interface that came back it would make the new one fail.
  if (device_ != 0) static_cast<void>(Set(IP_DROP_MEMBERSHIP, device_));
  const int error = Set(IP_ADD_MEMBERSHIP, device);
  device_ = error == 0 || error == EADDRINUSE ? device : 0;
  return device_ != 0;
}

}  // namespace v2vouch::net
