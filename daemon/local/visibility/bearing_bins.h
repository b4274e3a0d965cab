// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>

#include "daemon/common/base/angle.h"

namespace v2vouch {

/// Bin of one degree that a direction in O falls into. `bearing_O` within three half circles.
inline std::size_t BinOf(double bearing_O) {
  constexpr double kBinSize = 2.0 * kPi / 360.0;
  const int bin = static_cast<int>((bearing_O + 3.0 * kPi) / kBinSize);
  return static_cast<std::size_t>(std::clamp(bin, 0, 3 * 360 - 1) % 360);
}

}  // namespace v2vouch
