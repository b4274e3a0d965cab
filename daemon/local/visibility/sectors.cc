// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "daemon/common/base/angle.h"
#include "daemon/local/visibility/visibility.h"

namespace v2vouch {

std::vector<SectorHealth> VisibilityMap::Sectors(std::span<const char> radar_alive,
                                                 std::span<const char> camera_alive) const {
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
    Kind kinds[2];
    for (std::size_t s = 0; s < sensors_.size(); ++s) {
      const bool is_radar = s < radar_count_;
      const auto alive = is_radar ? radar_alive : camera_alive;
      const std::size_t index = is_radar ? s : s - radar_count_;
      if (!sensors_[s].covers[static_cast<std::size_t>(i)]) continue;
      Kind& kind = kinds[is_radar ? 0 : 1];
      kind.is_mounted = true;
      if (index >= alive.size() || !alive[index]) continue;
      kind.is_alive = true;
      sector.range_m = std::max(sector.range_m, sensors_[s].max_range_m);
    }
    const auto is_served = [](const Kind& kind) { return kind.is_alive || !kind.is_mounted; };
    if (!kinds[0].is_alive && !kinds[1].is_alive) {
      sector.state = SectorState::kBlind;
    } else if (is_served(kinds[0]) && is_served(kinds[1])) {
      sector.state = SectorState::kWatched;
    } else {
      sector.state = SectorState::kDegraded;
    }
  }
  return sectors;
}

}  // namespace v2vouch
