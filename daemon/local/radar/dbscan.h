// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace v2vouch {

/// One reflection on its way into a cluster, in the radar's frame R.
struct Reflection {
  double range_m = 0.0;
  double azimuth_rad = 0.0;
  double x_m = 0.0;
  double y_m = 0.0;
  double ground_rate_mps = 0.0;  ///< Range rate with the antenna's motion taken out.
  double strength_db = 0.0;      ///< SNR; 0 where the sensor tells none.
  bool is_standing = false;
  bool is_outline = false;  ///< Marks its cluster's outline; known once that is emitted.
  int object_id = -1;
};

/// When two reflections are neighbours: both standing or both moving, and
///
///     (distance / radius)^2 + (difference of ground rate / speed)^2 <= 1,
///     radius = scale (eps + eps_per_m x mean range)
struct Neighbourhood {
  double eps_m = 1.6;
  double eps_per_m = 0.015;
  double eps_speed_mps = 1.5;
  int min_points = 1;  ///< Neighbours that make a core point, itself included.
  double scale = 1.0;
};

/// Density-based clustering (Ester, Kriegel, Sander, Xu 1996). Unlike the original the answer does
/// not depend on the order of visits: a border point joins the cluster of its nearest core point.
/// A window over range keeps small scans near linear; large ones are searched by a square grid, so
/// that a wall at one range costs no more than a field of posts.
class Dbscan {
 public:
  /// Clusters the reflections named by `members` (ascending indices; `reflections` ordered by
  /// range). Rearranges `members` so that clusters lie one after another, ascending inside, noise
  /// at the end.
  /// @return end position of each cluster in `members`. Valid until the next call.
  std::span<const std::size_t> Run(std::span<const Reflection> reflections,
                                   const Neighbourhood& neighbourhood, std::span<int> members);

 private:
  struct Cell {
    std::int32_t column = 0;
    std::int32_t row = 0;
    std::uint32_t member = 0;
    friend auto operator<=>(const Cell&, const Cell&) = default;
  };
  std::size_t Root(std::size_t i);
  template <class Visit>
  void ForEachPair(std::span<const Reflection> reflections, const Neighbourhood& neighbourhood,
                   std::span<const int> members, Visit&& visit) const;
  void FillGrid(std::span<const Reflection> reflections, const Neighbourhood& neighbourhood,
                std::span<const int> members);

  std::vector<std::size_t> parent_, ends_;
  std::vector<int> neighbours_;
  std::vector<std::pair<std::size_t, int>> order_;  // Cluster's root, member.
  std::vector<double> nearest_;
  std::vector<std::size_t> nearest_core_;
  std::vector<Cell> cells_;  // In order; empty for a small scan.
};

}  // namespace v2vouch
