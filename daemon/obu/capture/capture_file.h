// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "daemon/obu/octets/byte_reader.h"

namespace v2vouch::obu {

/// One packet, line or datagram of a file. Valid until the next one is asked for.
struct Captured {
  std::int64_t utime = 0;  ///< us UTC; 0 = the file tells no time.
  int link_type = -1;      ///< As libpcap numbers them; -1 = a datagram without link layer.
  Bytes bytes;
  bool is_cut = false;    ///< The capture kept only the beginning.
  std::int64_t line = 0;  ///< Of hex text, from 1.
  Fault fault;            ///< The line is no hex: nothing else is told.
};

/// A file read from the front, of the kind that its first bytes say.
class CaptureFile {
 public:
  virtual ~CaptureFile() = default;

  /// A pcap or pcapng file, hex text, or else one raw datagram.
  /// @param join_lines of hex text: all lines are one datagram.
  /// @return nullptr with what is wrong in `error`.
  static std::unique_ptr<CaptureFile> Open(const std::string& path, bool join_lines,
                                           std::string& error);

  /// nullopt at the end; then `error` is set where the file ends in the middle of a packet.
  virtual std::optional<Captured> Next(std::string& error) = 0;
};

}  // namespace v2vouch::obu
