// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/net/membership.h"

#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

namespace v2vouch::net {
namespace {

// The own address that the kernel would send to the group from; 0 where there is no route.
std::uint32_t AddressTowards(std::uint32_t group) {
  const int probe = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (probe < 0) return 0;
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(9);  // Nothing is sent.
  to.sin_addr.s_addr = group;
  sockaddr_in own{};
  socklen_t size = sizeof own;
  const bool has_route = connect(probe, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0 &&
                         getsockname(probe, reinterpret_cast<sockaddr*>(&own), &size) == 0;
  close(probe);
  return has_route ? own.sin_addr.s_addr : 0;
}

// Index of the interface that the routes name for the group; 0 where there is none.
int DeviceTowards(std::uint32_t group) {
  const std::uint32_t address = AddressTowards(group);
  ifaddrs* list = nullptr;
  if (address == 0 || getifaddrs(&list) != 0) return 0;
  int device = 0;
  for (const ifaddrs* each = list; each != nullptr && device == 0; each = each->ifa_next) {
    if (each->ifa_addr == nullptr || each->ifa_addr->sa_family != AF_INET) continue;
    if (reinterpret_cast<const sockaddr_in*>(each->ifa_addr)->sin_addr.s_addr != address) continue;
    device = static_cast<int>(if_nametoindex(each->ifa_name));
  }
  freeifaddrs(list);
  return device;
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
  if (device_ != 0) Set(IP_DROP_MEMBERSHIP, device_);
  const int error = Set(IP_ADD_MEMBERSHIP, device);
  device_ = error == 0 || error == EADDRINUSE ? device : 0;
  return device_ != 0;
}

}  // namespace v2vouch::net
