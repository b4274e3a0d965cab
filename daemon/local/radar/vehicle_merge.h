// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "daemon/local/radar/dbscan.h"

namespace v2vouch {

/// What two clusters must look like together to be one vehicle.
struct VehicleShape {
  double gap_m = 4.0;           ///< Between their nearest reflections, at most.
  double length_m = 13.0;       ///< Along the common direction of motion, at most, noise aside.
  double width_m = 2.2;         ///< Across it.
  double range_sigma_m = 0.25;  ///< Of one reflection, as the next two.
  double azimuth_sigma_rad = 0.005;
  double ground_rate_sigma_mps = 0.15;
};

/// Joins moving clusters that can be one vehicle: a few reflections spread over a long flank lie
/// farther apart than two cars side by side do, so no radius alone can tell the two cases. What
/// tells them is that a vehicle moves along its length. The common velocity V follows from how
/// Doppler changes with azimuth (Kellner et al., FUSION 2013),
///
///     minimise  sum ([cos a_i, sin a_i] . V - g_i)^2 / sigma_i^2  +  V_across^2 / (10 m/s)^2,
///
/// the last term standing for "speed across the ray is unknown, but a vehicle's". Two clusters join
/// when one V explains both (chi-square) and the reflections fit a box of length x width along V,
/// 2 sigma of position noise allowed. Nearest pairs are tried first. A vehicle that turns sharply
/// breaks the formula and at worst stays in pieces; so does what lies beyond the first few thousand
/// pairs, in order of range, of a scan full of interference.
class VehicleMerge {
 public:
  /// @param members indices into `reflections`, cluster after cluster, rearranged in place.
  /// @param ends end of each cluster in `members`; replaced. Standing clusters are left alone.
  void Run(std::span<const Reflection> reflections, const VehicleShape& shape,
           std::vector<int>& members, std::vector<std::size_t>& ends);

 private:
  struct Edge {
    double gap2 = 0.0;
    int a = 0;  // Clusters, a < b.
    int b = 0;
  };
  int Root(int cluster);
  void CollectEdges(std::span<const Reflection> reflections, const VehicleShape& shape);
  [[nodiscard]] bool IsOneVehicle(std::span<const Reflection> reflections,
                                  const VehicleShape& shape, int a, int b) const;

  std::vector<int> cluster_of_;  // By position in members.
  std::vector<Edge> edges_;
  std::vector<int> parent_;
  std::vector<std::vector<int>> content_;  // Reflections by root.
};

}  // namespace v2vouch
