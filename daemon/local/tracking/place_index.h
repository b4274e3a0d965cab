// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace v2vouch {

/// Points in a plane, searchable by place: a square grid of which only the cells in use are kept,
/// in order. Building costs n log n, a search what lies in the cells that it touches: traffic of
/// constant density costs the same however long the road is and wherever it leads. Memory is kept.
class PlaceIndex {
 public:
  void Clear() { entries_.clear(); }

  /// Points that are not finite, or farther away than kFarthest_m, are never found.
  void Add(const Eigen::Vector2d& p, std::size_t index) {
    if (!(std::abs(p.x()) <= kFarthest_m) || !(std::abs(p.y()) <= kFarthest_m)) return;
    entries_.push_back({CellOf(p.x()), CellOf(p.y()), static_cast<std::uint32_t>(index)});
  }

  /// To be called after the last Add, before ForEachNear.
  void Sort() {
    std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
      if (a.column != b.column) return a.column < b.column;
      return a.row != b.row ? a.row < b.row : a.index < b.index;
    });
  }

  /// Calls visit(index) for every point nearer to `p` than `reach_m` in both axes, and for some
  /// that are not.
  template <class Visitor>
  void ForEachNear(const Eigen::Vector2d& p, double reach_m, Visitor&& visit) const {
    if (!(std::abs(p.x()) <= kFarthest_m) || !(std::abs(p.y()) <= kFarthest_m)) return;
    const double reach = std::min(reach_m, kFarthest_m);
    const std::int32_t last_column = CellOf(p.x() + reach);
    const std::int32_t first_row = CellOf(p.y() - reach);
    const std::int32_t last_row = CellOf(p.y() + reach);
    auto it = LowerBound(entries_.begin(), CellOf(p.x() - reach), first_row);
    while (it != entries_.end() && it->column <= last_column) {
      if (it->row < first_row) {
        it = LowerBound(it, it->column, first_row);
      } else if (it->row > last_row) {
        it = LowerBound(it, it->column + 1, first_row);
      } else {
        visit(static_cast<std::size_t>(it->index));
        ++it;
      }
    }
  }

  static constexpr double kFarthest_m = 1e7;

 private:
  struct Entry {
    std::int32_t column = 0;
    std::int32_t row = 0;
    std::uint32_t index = 0;
  };
  using Iterator = std::vector<Entry>::const_iterator;

  // About the reach of a gate: a search touches four to nine cells.
  static constexpr double kCell_m = 8.0;
  static std::int32_t CellOf(double x_m) {
    return static_cast<std::int32_t>(std::floor(x_m / kCell_m));
  }
  [[nodiscard]] Iterator LowerBound(Iterator from, std::int32_t column, std::int32_t row) const {
    return std::lower_bound(from, entries_.end(), 0, [column, row](const Entry& a, int) {
      return a.column != column ? a.column < column : a.row < row;
    });
  }

  std::vector<Entry> entries_;
};

}  // namespace v2vouch
