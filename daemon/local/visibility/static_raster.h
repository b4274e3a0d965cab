// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "daemon/common/base/time.h"

namespace v2vouch {

/// Where radar has met standing things lately: a sparse raster in O of fixed size (12 kB).
///
/// Counted per cell: at most one hit per stamp; a cell silent for longer than `hold_s` starts
/// again. A cell is *active* with `min_hits` hits, until `hold_s` after the last. It is part of a
/// *structure* when at least two active cells lie some 3 to 4.5 m from it: a wall or a rail, where
/// a lone pole is not. A crowded neighbourhood drops its oldest cell.
class StaticRaster {
 public:
  StaticRaster(double cell_m, double hold_s, int min_hits);

  void Add(Timestamp stamp, const Eigen::Vector2d& p_O);

  /// Something behind was measured along the line from `from_O` to `to_O`: the cells that it
  /// crosses (a rail, a hedge, stray returns) hide nothing and count as no one's neighbour until
  /// they start again.
  void SeeThrough(const Eigen::Vector2d& from_O, const Eigen::Vector2d& to_O);

  /// Calls visit(p_O of the cell's centre, is_structure) for every active cell, in a fixed order.
  /// `near_O`: a place within 30 km cells of all of them, e.g. the ego.
  template <class Visit>
  void ForEachActive(Timestamp now, const Eigen::Vector2d& near_O, Visit&& visit) const {
    const Key near = KeyOf(near_O);
    const Eigen::Vector2d corner(std::floor(near_O.x() / cell_m_),
                                 std::floor(near_O.y() / cell_m_));
    for (const Cell& cell : cells_) {
      if (!IsActive(cell, now)) continue;
      // Keys wrap; the difference to a place nearby does not.
      const auto dx = static_cast<std::int16_t>(static_cast<std::uint16_t>(cell.key.x - near.x));
      const auto dy = static_cast<std::int16_t>(static_cast<std::uint16_t>(cell.key.y - near.y));
      visit(Eigen::Vector2d((corner + Eigen::Vector2d(dx + 0.5, dy + 0.5)) * cell_m_),
            cell.is_structure);
    }
  }

 private:
  static constexpr std::size_t kBuckets = 96;
  static constexpr std::size_t kSlots = 8;

  struct Key {
    std::uint16_t x = 0;  // Cell index modulo 65536.
    std::uint16_t y = 0;
    friend bool operator==(const Key&, const Key&) = default;
  };
  struct Cell {
    Timestamp last_hit{};
    Key key;
    std::uint8_t hits = 0;  // 0: empty slot.
    bool is_structure = false;
    bool is_transparent = false;
  };
  static_assert(sizeof(Cell) == 16);

  [[nodiscard]] Key KeyOf(const Eigen::Vector2d& p_O) const;
  [[nodiscard]] static std::size_t BucketOf(Key key);
  [[nodiscard]] const Cell* Find(Key key) const;
  [[nodiscard]] bool IsFresh(const Cell& cell, Timestamp now) const {
    return cell.hits > 0 && now - cell.last_hit <= hold_;
  }
  [[nodiscard]] bool IsActive(const Cell& cell, Timestamp now) const {
    return cell.hits >= min_hits_ && !cell.is_transparent && IsFresh(cell, now);
  }
  [[nodiscard]] bool HasFarNeighbours(Timestamp now, const Eigen::Vector2d& p_O) const;

  double cell_m_;
  Duration hold_;
  int min_hits_;
  std::array<Cell, kBuckets * kSlots> cells_{};
};

}  // namespace v2vouch
