// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>

#include "daemon/obu/framing/datagram.h"
#include "v2vouch/bsm_t.hpp"

namespace v2vouch::obu {

/// What is known beside the bytes of a datagram.
struct Reception {
  std::int64_t rx_utime = 0;  ///< us UTC; 0 = not known (hex text).
  std::int64_t seq = 0;
  HashedId8 digest{};               ///< Of the certificate that signed; zeros = none.
  std::int8_t signature_state = 0;  ///< As bsm_t: 0 unknown, 1 valid, 2 invalid.
  int cam_count = 0;                ///< msgCnt of a CAM, which has none of its own.
};

/// Counts the CAMs of each station, 0 to 127, for BSM's msgCnt: copies of one CAM get the same
/// count, and none is missing at 1 Hz. Bounded: the station not heard for longest is forgotten.
class CamCounts {
 public:
  int CountOf(const Cam& cam);

 private:
  struct Station {
    int delta_time = -1;
    int count = 0;
    std::uint64_t heard = 0;
  };
  static constexpr std::size_t kMostStations = 4096;
  std::map<std::uint32_t, Station> stations_;
  std::map<std::uint64_t, std::uint32_t> by_age_;
  std::uint64_t heard_ = 0;
};

/// The message for channel BSM, of a datagram with a BSM or CAM in it.
bsm_t BsmMessage(const Datagram& datagram, const Reception& reception);

}  // namespace v2vouch::obu
