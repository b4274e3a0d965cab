// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "daemon/obu/capture/capture_file.h"
#include "daemon/obu/framing/datagram.h"
#include "daemon/obu/security/verifier.h"
#include "v2vouch/bsm_t.hpp"

namespace v2vouch::obu {

/// What is told of one packet.
struct DatagramReport {
  std::int64_t number = 0;  ///< Of the packet, from 1.
  Captured captured;
  Datagram datagram;
  Judgement judgement;
  std::optional<bsm_t> message;  ///< What would be published, or would be were it not refused.
  Fault refused;

  /// Outermost layer of the datagram itself; nullopt = none known.
  [[nodiscard]] std::optional<Layer> framing() const;
};

/// One object, one line.
std::string JsonOf(const DatagramReport& report);
/// A paragraph: layer by layer, field by field with units.
std::string TextOf(const DatagramReport& report);

/// "192.168.88.40:1516"; "" where the packet was no UDP.
std::string SourceOf(const Datagram& datagram);
/// "2023-09-13 18:31:47.495000 UTC".
std::string TimeText(std::int64_t utime);

}  // namespace v2vouch::obu
