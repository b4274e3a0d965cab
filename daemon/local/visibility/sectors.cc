// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "daemon/common/base/angle.h"
#include "daemon/local/visibility/visibility.h"

namespace v2vouch {

std::vector<SectorHealth> VisibilityMap::Sectors(std::span<const char> alive) const {
  constexpr double kSize = 2.0 * kPi / kSectors;
  struct Kind {
    bool is_mounted = false;
    bool is_alive = false;
  };
  std::vector<SectorHealth> sectors(kSectors);
  for (int i = 0; i < kSectors; ++i) {
    SectorHealth& sector = sectors[static_cast<std::size_t>(i)];
    sector.from_rad = -kPi + kSize * i;
    sector.to_rad = -kPi + kSize * (i + 1);
    std::array<Kind, kSensorKinds> kinds;
    for (std::size_t s = 0; s < sensors_.size(); ++s) {
      if (!sensors_[s].covers[static_cast<std::size_t>(i)]) continue;
      Kind& kind = kinds[static_cast<std::size_t>(sensors_[s].kind)];
      kind.is_mounted = true;
      if (s >= alive.size() || !alive[s]) continue;
      kind.is_alive = true;
      sector.range_m = std::max(sector.range_m, sensors_[s].max_range_m);
    }
    const auto is_alive = [](const Kind& kind) { return kind.is_alive; };
    const auto is_served = [](const Kind& kind) { return kind.is_alive || !kind.is_mounted; };
    if (std::ranges::none_of(kinds, is_alive)) {
      sector.state = SectorState::kBlind;
    } else if (std::ranges::all_of(kinds, is_served)) {
      sector.state = SectorState::kWatched;
    } else {
      sector.state = SectorState::kDegraded;
    }
  }
  return sectors;
}

}  // namespace v2vouch
