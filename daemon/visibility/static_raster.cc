// SPDX-License-Identifier: Apache-2.0
#include "daemon/visibility/static_raster.h"

#include <algorithm>

#include "daemon/base/angle.h"

namespace v2vouch {

StaticRaster::StaticRaster(double cell_m, double hold_s, int min_hits)
    : cell_m_(cell_m), hold_(FromSeconds(hold_s)), min_hits_(std::min(min_hits, 250)) {}

StaticRaster::Key StaticRaster::KeyOf(const Eigen::Vector2d& p_O) const {
  const auto index = [&](double value_m) {
    return static_cast<std::uint16_t>(static_cast<std::int64_t>(std::floor(value_m / cell_m_)));
  };
  return {index(p_O.x()), index(p_O.y())};
}

std::size_t StaticRaster::BucketOf(Key key) {
  // Fibonacci hashing: the multiplier is 2^32 over the golden ratio.
  const std::uint32_t mixed = (std::uint32_t{key.x} << 16 | key.y) * 2654435769U;
  return (mixed >> 12) % kBuckets;
}

const StaticRaster::Cell* StaticRaster::Find(Key key) const {
  const Cell* bucket = &cells_[BucketOf(key) * kSlots];
  for (std::size_t i = 0; i < kSlots; ++i) {
    if (bucket[i].hits > 0 && bucket[i].key == key) return &bucket[i];
  }
  return nullptr;
}

bool StaticRaster::HasFarNeighbours(Timestamp now, const Eigen::Vector2d& p_O) const {
  constexpr int kDirections = 16;
  int found = 0;
  for (const double distance_m : {3.0, 4.5}) {
    for (int i = 0; i < kDirections; ++i) {
      const double angle = 2.0 * kPi * i / kDirections;
      const Cell* cell =
          Find(KeyOf(p_O + distance_m * Eigen::Vector2d(std::cos(angle), std::sin(angle))));
      if (cell != nullptr && IsActive(*cell, now) && ++found == 2) return true;
    }
  }
  return false;
}

void StaticRaster::Add(Timestamp stamp, const Eigen::Vector2d& p_O) {
  const Key key = KeyOf(p_O);
  Cell* const bucket = &cells_[BucketOf(key) * kSlots];
  Cell* slot = bucket;  // The cell itself, else an empty slot, else the oldest.
  for (std::size_t i = 0; i < kSlots; ++i) {
    if (bucket[i].hits > 0 && bucket[i].key == key) {
      slot = &bucket[i];
      break;
    }
    const bool is_better =
        slot->hits > 0 && (bucket[i].hits == 0 || bucket[i].last_hit < slot->last_hit);
    if (is_better) slot = &bucket[i];
  }
  if (slot->hits == 0 || !(slot->key == key) || !IsFresh(*slot, stamp)) {
    *slot = {.last_hit = stamp, .key = key, .hits = 1};
  } else if (slot->last_hit < stamp) {
    slot->last_hit = stamp;
    if (slot->hits < 255) ++slot->hits;
  }
  if (IsActive(*slot, stamp)) slot->is_structure = HasFarNeighbours(stamp, p_O);
}

}  // namespace v2vouch
