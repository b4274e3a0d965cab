// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/visibility/static_raster.h"

#include <algorithm>
#include <bit>

#include "daemon/common/base/angle.h"

namespace v2vouch {
namespace {

constexpr std::size_t kDirections = 16;
using Ring = std::array<Eigen::Vector2d, 2 * kDirections>;

// Where the other cells of a wall would be: once round at 3 m, then at 4.5 m.
Ring MakeRing() {
  Ring ring;
  std::size_t next = 0;
  for (const double distance_m : {3.0, 4.5}) {
    for (std::size_t i = 0; i < kDirections; ++i) {
      const double angle = 2.0 * kPi * static_cast<double>(i) / kDirections;
      ring[next++] = distance_m * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    }
  }
  return ring;
}

const Ring kRing = MakeRing();

// std::floor is a call on plain x86-64.
std::int64_t Floor(double value) {
  const auto whole = static_cast<std::int64_t>(value);
  return static_cast<double>(whole) > value ? whole - 1 : whole;
}

}  // namespace

StaticRaster::StaticRaster(double cell_m, double hold_s, int min_hits)
    : cell_m_(cell_m), hold_(FromSeconds(hold_s)), min_hits_(std::min(min_hits, 250)) {}

StaticRaster::Key StaticRaster::KeyOf(const Eigen::Vector2d& p_O) const {
  const auto index = [&](double value_m) {
    return static_cast<std::uint16_t>(Floor(value_m / cell_m_));
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
  // A wall's neighbours are searched at 32 places per hit: one comparison of 32 bits per cell.
  const auto wanted = std::bit_cast<std::uint32_t>(key);
  for (std::size_t i = 0; i < kSlots; ++i) {
    if (std::bit_cast<std::uint32_t>(bucket[i].key) == wanted && bucket[i].hits > 0) {
      return &bucket[i];
    }
  }
  return nullptr;
}

bool StaticRaster::HasFarNeighbours(Timestamp now, const Eigen::Vector2d& p_O) const {
  int found = 0;
  for (const Eigen::Vector2d& offset : kRing) {
    const Cell* cell = Find(KeyOf(p_O + offset));
    if (cell != nullptr && IsActive(*cell, now) && ++found == 2) return true;
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

void StaticRaster::SeeThrough(const Eigen::Vector2d& from_O, const Eigen::Vector2d& to_O) {
  const Eigen::Vector2d line = to_O - from_O;
  // Half a cell: no cell that is crossed near its middle is stepped over.
  const int steps = static_cast<int>(line.norm() / (0.5 * cell_m_));
  for (int i = 0; i <= steps; ++i) {
    const Key key = KeyOf(from_O + line * (static_cast<double>(i) / std::max(steps, 1)));
    Cell* const bucket = &cells_[BucketOf(key) * kSlots];
    for (std::size_t k = 0; k < kSlots; ++k) {
      if (bucket[k].hits > 0 && bucket[k].key == key) bucket[k].is_transparent = true;
    }
  }
}

}  // namespace v2vouch
