// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/io/socket_figures.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

namespace v2vouch {
namespace {

// Inode -> drops, of every UDP socket of this network namespace that takes any peer's datagrams
// (its remote port is 0) on one of the ports.
std::map<std::uint64_t, std::int64_t> DropsByInode(std::span<const int> ports) {
  const auto is_ours = [&](const std::string& address) {  // ADDRESS:PORT, hexadecimal.
    const auto colon = address.rfind(':');
    if (colon == std::string::npos) return false;
    const long port = std::strtol(address.c_str() + colon + 1, nullptr, 16);
    return std::ranges::find(ports, static_cast<int>(port)) != ports.end();
  };
  std::map<std::uint64_t, std::int64_t> drops;
  std::ifstream table("/proc/net/udp");
  std::string line;
  std::getline(table, line);  // Heading.
  while (std::getline(table, line)) {
    std::istringstream words(line);
    std::string slot, local, remote, state, queues, timer, retransmit, uid, timeout;
    std::uint64_t inode = 0;
    std::string references, pointer;
    std::int64_t dropped = 0;
    words >> slot >> local >> remote >> state >> queues >> timer >> retransmit >> uid >> timeout >>
        inode >> references >> pointer >> dropped;
    if (words && remote.ends_with(":0000") && is_ours(local)) drops[inode] = dropped;
  }
  return drops;
}

}  // namespace

SocketFigures ReadSocketFigures(std::span<const int> ports) {
  SocketFigures figures;
  const auto drops = DropsByInode(ports);
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", error)) {
    const int fd = std::atoi(entry.path().filename().c_str());
    struct stat status {};
    if (fstat(fd, &status) != 0 || !S_ISSOCK(status.st_mode)) continue;
    const auto ours = drops.find(status.st_ino);
    if (ours == drops.end()) continue;
    figures.kernel_drops = std::max<std::int64_t>(figures.kernel_drops, 0) + ours->second;
    int bytes = 0;
    socklen_t length = sizeof(bytes);
    if (getsockopt(fd, SOL_SOCKET, SO_RCVBUF, &bytes, &length) != 0) continue;
    figures.receive_buffer_bytes =
        figures.receive_buffer_bytes < 0
            ? bytes
            : std::min<std::int64_t>(figures.receive_buffer_bytes, bytes);
  }
  return figures;
}

}  // namespace v2vouch
