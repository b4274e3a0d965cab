// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace v2vouch {

struct SocketFigures {
  std::int64_t kernel_drops = -1;          ///< Datagrams, all our UDP sockets together; -1 unknown.
  std::int64_t receive_buffer_bytes = -1;  ///< Granted, the smallest of our receiving sockets.
};

/// Reads what the kernel says of this process's own UDP sockets that are bound to a port: the drops
/// column of /proc/net/udp and the granted SO_RCVBUF. liblcm hands out neither, and the kernel
/// clips a request for a larger buffer silently.
SocketFigures ReadSocketFigures();

}  // namespace v2vouch
