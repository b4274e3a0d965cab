// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "daemon/obu/framing/datagram.h"
#include "v2vouch/bsm_t.hpp"

namespace v2vouch::obu {

/// What is known beside the bytes of a datagram.
struct Reception {
  std::int64_t rx_utime = 0;  ///< us UTC; 0 = not known (hex text).
  std::int64_t seq = 0;
  HashedId8 digest{};               ///< Of the certificate that signed; zeros = none.
  std::int8_t signature_state = 0;  ///< As bsm_t: 0 unknown, 1 valid, 2 invalid.
};

/// The message for channel BSM, of a datagram with a BSM or CAM in it.
bsm_t BsmMessage(const Datagram& datagram, const Reception& reception);

}  // namespace v2vouch::obu
