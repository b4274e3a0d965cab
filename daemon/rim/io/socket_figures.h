// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

namespace v2vouch {

struct SocketFigures {
  std::int64_t kernel_drops = -1;          ///< Datagrams, all of them together; -1 unknown.
  std::int64_t receive_buffer_bytes = -1;  ///< Granted, the smallest of them.
};

/// Reads what the kernel says of this process's own UDP sockets that receive on one of these ports:
/// the drops column of /proc/net/udp and the granted SO_RCVBUF. liblcm hands out neither, and the
/// kernel clips a request for a larger buffer silently. LCM's sending socket has a port of its own
/// and is not meant.
SocketFigures ReadSocketFigures(std::span<const int> ports);

}  // namespace v2vouch
