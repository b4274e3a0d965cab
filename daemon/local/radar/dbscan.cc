// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/radar/dbscan.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace v2vouch {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr std::size_t kNoise = std::numeric_limits<std::size_t>::max();
// From here on a grid is worth its building.
constexpr std::size_t kSmallScan = 96;

double Radius(const Reflection& a, const Reflection& b, const Neighbourhood& n) {
  return n.scale * (n.eps_m + n.eps_per_m * 0.5 * (a.range_m + b.range_m));
}

// At most 1 for neighbours.
double Distance2(const Reflection& a, const Reflection& b, const Neighbourhood& n) {
  if (a.is_standing != b.is_standing) return kFar;
  const double radius = Radius(a, b, n);
  const double dx = (a.x_m - b.x_m) / radius;
  const double dy = (a.y_m - b.y_m) / radius;
  const double dv = (a.ground_rate_mps - b.ground_rate_mps) / n.eps_speed_mps;
  return dx * dx + dy * dy + dv * dv;
}

}  // namespace

std::size_t Dbscan::Root(std::size_t i) {
  while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
  return i;
}

// Cells as wide as the largest radius: neighbours lie in the same cell or in the next ones.
void Dbscan::FillGrid(std::span<const Reflection> reflections, const Neighbourhood& neighbourhood,
                      std::span<const int> members) {
  cells_.clear();
  if (members.size() < kSmallScan) return;
  const Reflection& farthest = reflections[static_cast<std::size_t>(members.back())];
  const double cell_m = Radius(farthest, farthest, neighbourhood);
  for (std::size_t i = 0; i < members.size(); ++i) {
    const Reflection& r = reflections[static_cast<std::size_t>(members[i])];
    cells_.push_back({static_cast<std::int32_t>(std::floor(r.x_m / cell_m)),
                      static_cast<std::int32_t>(std::floor(r.y_m / cell_m)),
                      static_cast<std::uint32_t>(i)});
  }
  std::sort(cells_.begin(), cells_.end());
}

// Calls visit(i, j, distance2), i < j, for every pair of neighbours, in any order.
template <class Visit>
void Dbscan::ForEachPair(std::span<const Reflection> reflections,
                         const Neighbourhood& neighbourhood, std::span<const int> members,
                         Visit&& visit) const {
  const auto at = [&](std::size_t i) -> const Reflection& {
    return reflections[static_cast<std::size_t>(members[i])];
  };
  const auto look_at = [&](std::size_t i, std::size_t j) {
    const double distance2 = Distance2(at(i), at(j), neighbourhood);
    if (distance2 <= 1.0) visit(i, j, distance2);
  };
  if (cells_.empty()) {
    // Two points differ in range by no more than their distance, and members are in order of range:
    // the inner loop ends early.
    for (std::size_t i = 0; i < members.size(); ++i) {
      for (std::size_t j = i + 1; j < members.size(); ++j) {
        if (at(j).range_m - at(i).range_m > Radius(at(i), at(j), neighbourhood)) break;
        look_at(i, j);
      }
    }
    return;
  }
  // Each pair once: within a cell, and with the four of the eight next cells that come after it.
  for (std::size_t a = 0; a < cells_.size(); ++a) {
    const Cell& cell = cells_[a];
    const auto meet = [&](auto from, std::int32_t column, std::int32_t last_row) {
      for (; from != cells_.end() && from->column == column && from->row <= last_row; ++from) {
        look_at(std::min(cell.member, from->member), std::max(cell.member, from->member));
      }
    };
    meet(cells_.begin() + static_cast<std::ptrdiff_t>(a) + 1, cell.column, cell.row + 1);
    meet(std::lower_bound(cells_.begin() + static_cast<std::ptrdiff_t>(a), cells_.end(),
                          Cell{cell.column + 1, cell.row - 1, 0}),
         cell.column + 1, cell.row + 1);
  }
}

std::span<const std::size_t> Dbscan::Run(std::span<const Reflection> reflections,
                                         const Neighbourhood& neighbourhood,
                                         std::span<int> members) {
  const std::size_t count = members.size();
  FillGrid(reflections, neighbourhood, members);
  const auto for_each_pair = [&](auto&& visit) {
    ForEachPair(reflections, neighbourhood, members, visit);
  };

  neighbours_.assign(count, 1);
  if (neighbourhood.min_points > 1) {
    for_each_pair([&](std::size_t i, std::size_t j, double) {
      ++neighbours_[i];
      ++neighbours_[j];
    });
  }
  const auto is_core = [&](std::size_t i) { return neighbours_[i] >= neighbourhood.min_points; };

  // Core points that are neighbours share a cluster, whose root is its lowest member.
  parent_.resize(count);
  for (std::size_t i = 0; i < count; ++i) parent_[i] = i;
  for_each_pair([&](std::size_t i, std::size_t j, double) {
    if (!is_core(i) || !is_core(j)) return;
    const std::size_t a = Root(i);
    const std::size_t b = Root(j);
    parent_[std::max(a, b)] = std::min(a, b);
  });
  // Border points join their nearest core; the lowest index wins a tie.
  nearest_.assign(count, kFar);
  nearest_core_.assign(count, kNoise);
  if (neighbourhood.min_points > 1) {
    for_each_pair([&](std::size_t i, std::size_t j, double distance2) {
      if (is_core(i) == is_core(j)) return;
      const std::size_t border = is_core(i) ? j : i;
      const std::size_t core = is_core(i) ? i : j;
      if (std::pair(distance2, core) < std::pair(nearest_[border], nearest_core_[border])) {
        nearest_[border] = distance2;
        nearest_core_[border] = core;
        parent_[border] = core;
      }
    });
  }

  // Gather cluster by cluster, in order of their lowest core point.
  const auto cluster_of = [&](std::size_t i) {
    const bool is_noise = !is_core(i) && nearest_[i] == kFar;
    return is_noise ? kNoise : Root(i);
  };
  order_.resize(count);
  for (std::size_t i = 0; i < count; ++i) order_[i] = {cluster_of(i), members[i]};
  std::sort(order_.begin(), order_.end());
  ends_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    members[i] = order_[i].second;
    const bool is_last = i + 1 == count || order_[i + 1].first != order_[i].first;
    if (is_last && order_[i].first != kNoise) ends_.push_back(i + 1);
  }
  return ends_;
}

}  // namespace v2vouch
