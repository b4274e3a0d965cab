// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "daemon/common/data/measurement.h"
#include "daemon/common/data/vehicle.h"

namespace v2vouch {

/// How much moving clutter each radar shows and where: rain, spray, moving leaves and what
/// multipath shows for a moment, which no data sheet promises. It is learnt from tracks that came
/// to nothing, so that a vehicle which is being confirmed does not speak against itself. Cells of
/// range, azimuth and ground range rate, relative to the antenna, as weather is. With n clusters of
/// tracks that came to nothing, of which the first few do not count, in the last s scans (both
/// fade alike), a cell of volume v [m rad m/s] has
///
///     density = max(n - kFree, 0) / (s v)
///
/// Copyable; allocates when it is made only. Cell -1 is none.
class ClutterMap {
 public:
  explicit ClutterMap(std::size_t radars) : counts_(radars * kCells), scans_(radars) {}

  /// The cell that a cluster of this radar lies in.
  [[nodiscard]] static int CellOf(const RadarConfig& radar, const RadarMeasurement& z);
  /// A scan of the radar: what came to nothing long ago fades, with the scans that it was of.
  void Age(int radar);
  /// A track that started in this cell has come to nothing after so many clusters.
  void Count(int cell, int clusters);
  /// Clusters of clutter per scan and unit of range, azimuth and range rate [1 / (m rad m/s)].
  [[nodiscard]] double DensityAt(const RadarConfig& radar, const RadarMeasurement& z) const;

 private:
  static constexpr std::array kRangeEdges_m{10.0, 20.0, 30.0, 40.0, 60.0, 90.0, 130.0};
  static constexpr std::array kRateEdges_mps{-6.0, -2.0, 2.0, 6.0};
  static constexpr std::size_t kRanges = kRangeEdges_m.size() + 1;
  static constexpr std::size_t kAzimuths = 4;
  static constexpr std::size_t kRates = kRateEdges_mps.size() + 1;
  static constexpr std::size_t kCells = kRanges * kAzimuths * kRates;

  std::vector<float> counts_;  // Clusters, by radar and cell.
  std::vector<float> scans_;   // That they are of, by radar.
};

}  // namespace v2vouch
