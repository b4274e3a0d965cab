// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/doctor/network_check.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <random>
#include <sstream>

#include "daemon/rim/io/lcm_bus.h"
#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/net/udp_receiver.h"

namespace v2vouch {
namespace {

using State = Advice::State;

constexpr std::int64_t kLargePicture = 1 << 20;  // Of bytes that a camera may send at once.

// By which interface the kernel sends to `group`: the most specific line of its table. "" unknown.
std::string InterfaceTo(in_addr group) {
  std::ifstream table("/proc/net/route");
  std::string line;
  std::string best;
  std::uint32_t best_mask = 0;
  std::getline(table, line);  // Heading.
  while (std::getline(table, line)) {
    std::istringstream words(line);
    std::string interface, flags, count, use, metric;
    std::uint32_t destination = 0, gateway = 0, mask = 0;
    words >> interface >> std::hex >> destination >> gateway >> flags >> count >> use >> metric >>
        mask;
    if (!words || (group.s_addr & mask) != destination) continue;
    if (!best.empty() && ntohl(mask) < best_mask) continue;
    best = interface;
    best_mask = ntohl(mask);
  }
  return best;
}

// IFF_ flags; 0 where there is no such interface.
unsigned FlagsOf(const std::string& interface) {
  ifaddrs* all = nullptr;
  unsigned flags = 0;
  if (getifaddrs(&all) != 0) return flags;
  for (const ifaddrs* each = all; each != nullptr; each = each->ifa_next) {
    if (interface == each->ifa_name) flags = each->ifa_flags;
  }
  freeifaddrs(all);
  return flags;
}

bool CheckRoute(const UdpmUrl& url, const std::string& use, AdviceList& findings) {
  const int probe = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(url.port));
  inet_pton(AF_INET, url.group.c_str(), &to.sin_addr);
  const bool has_route = connect(probe, reinterpret_cast<const sockaddr*>(&to), sizeof(to)) == 0;
  const int error = errno;
  close(probe);
  if (!has_route) {
    findings.push_back(
        {State::kBad, "route",
         use + ": no route to the group " + url.group + " (" + std::strerror(error) + ")",
         "as root, for messages inside this computer: ip link set lo multicast on; "
         "ip route add 224.0.0.0/4 dev lo; for a sensor network name its interface "
         "instead of lo"});
    return false;
  }
  const std::string interface = InterfaceTo(to.sin_addr);
  const unsigned flags = FlagsOf(interface);
  const bool is_known = flags != 0;
  if (is_known && (flags & IFF_MULTICAST) == 0 && (flags & IFF_LOOPBACK) == 0) {
    findings.push_back({State::kBad, "interface",
                        use + ": " + interface + " has multicast switched off",
                        "as root: ip link set " + interface + " multicast on"});
    return true;
  }
  if (is_known && (flags & IFF_RUNNING) == 0) {
    findings.push_back({State::kBad, "interface", use + ": " + interface + " has no link",
                        "check cable and switch of " + interface});
    return true;
  }
  findings.push_back(
      {State::kGood, "route",
       use + ": " + url.group + ":" + std::to_string(url.port) + " goes by " + interface, ""});
  return true;
}

void CheckBuffer(const UdpmUrl& url, const net::UdpReceiver& receiver, const std::string& use,
                 AdviceList& findings) {
  // Linux doubles what it is asked for, for its own book-keeping.
  const std::int64_t granted = receiver.buffer_bytes() / 2;
  const std::string text = use + ": receive buffer of " + std::to_string(granted / 1024) + " kB";
  if (granted >= std::min<std::int64_t>(url.receive_buffer_bytes, kLargePicture)) {
    findings.push_back({State::kGood, "buffer", text, ""});
    return;
  }
  findings.push_back(
      {State::kNote, "buffer",
       text + " instead of " + std::to_string(url.receive_buffer_bytes / 1024) +
           " kB: pictures above 400 kB will be lost silently",
       "as root: sysctl -w net.core.rmem_max=8388608 (the package does that at each boot)"});
}

// A word to ourselves over the same bus.
void CheckEcho(const std::string& url, const std::string& use, AdviceList& findings) {
  const auto bus = LcmBus::Open(url);
  std::array<std::uint8_t, 16> word{};
  std::random_device random;
  for (auto& byte : word) byte = static_cast<std::uint8_t>(random());
  bool is_heard = false;
  if (bus) {
    bus->Subscribe("V2VOUCH_DOCTOR",
                   [&](std::span<const std::uint8_t> bytes, std::size_t, Timestamp) {
                     is_heard |= std::equal(bytes.begin(), bytes.end(), word.begin(), word.end());
                   });
    using Clock = std::chrono::steady_clock;
    for (const auto until = Clock::now() + std::chrono::seconds(1);
         !is_heard && Clock::now() < until;) {
      bus->Publish("V2VOUCH_DOCTOR", word);
      bus->Handle(100);
    }
  }
  if (is_heard) {
    findings.push_back({State::kGood, "loopback", use + ": a message to ourselves comes back", ""});
  } else {
    findings.push_back({State::kBad, "loopback",
                        use + ": a message sent from here is not heard here",
                        "look for a firewall rule on the port (nft list ruleset), for "
                        "net.ipv4.conf.*.rp_filter, and for from= in the URL"});
  }
}

}  // namespace

bool CheckNetwork(const std::string& url, const std::string& use, AdviceList& findings) {
  const std::string effective = EffectiveLcmUrl(url);
  const auto udpm = OwnReceiverUrl(effective);
  if (!udpm) {
    findings.push_back({State::kNote, "url",
                        use + ": " + effective + " is received by liblcm: nothing to look at", ""});
    return true;
  }
  if (!CheckRoute(*udpm, use, findings)) return false;
  net::UdpOptions options;
  options.address = udpm->group;
  options.port = udpm->port;
  options.buffer_bytes = udpm->receive_buffer_bytes;
  std::string error;
  const auto receiver = net::UdpReceiver::Open(options, error);
  if (!receiver) {
    findings.push_back(
        {State::kBad, "port",
         use + ": port " + std::to_string(udpm->port) + " cannot be opened: " + error,
         "another program holds it for itself alone: ss -ulpn 'sport = :" +
             std::to_string(udpm->port) +
             "' names it; end it or choose another "
             "port in the URL"});
    return false;
  }
  CheckBuffer(*udpm, *receiver, use, findings);
  CheckEcho(url, use, findings);
  if (effective.find("ttl=") != std::string::npos && effective.find("ttl=0") == std::string::npos) {
    findings.push_back({State::kNote, "ttl",
                        use + ": ttl above 0: our messages leave this computer",
                        "put ttl=0 into the URL where nobody else is to hear them"});
  }
  return true;
}

}  // namespace v2vouch
