// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/clutter_map.h"

#include <algorithm>
#include <span>

namespace v2vouch {
namespace {

// Scans after which what was counted has faded to a third.
constexpr double kMemory = 200.0;
// The first scans count as so many.
constexpr double kLeastScans = 20.0;
// So many clusters in a memory's time are a vehicle's own false starts.
constexpr double kFree = 3.0;
// Range rates are spread up to this on both sides.
constexpr double kMostRate_mps = 30.0;

std::size_t BandOf(std::span<const double> edges, double value) {
  return static_cast<std::size_t>(std::ranges::lower_bound(edges, value) - edges.begin());
}

// Width of a band between `first` and `last`, which bound the outer ones; the part that there is.
double WidthOf(std::span<const double> edges, std::size_t band, double first, double last) {
  const double from = band == 0 ? first : std::max(edges[band - 1], first);
  const double to = band == edges.size() ? last : std::min(edges[band], last);
  return std::max(to - from, 1.0);
}

}  // namespace

int ClutterMap::CellOf(const RadarConfig& radar, const RadarMeasurement& z) {
  const double share = 0.5 + 0.5 * z.azimuth_rad / radar.half_fov_rad;
  const auto azimuth = static_cast<std::size_t>(
      std::clamp(share * kAzimuths, 0.0, static_cast<double>(kAzimuths) - 1.0));
  const std::size_t range = BandOf(kRangeEdges_m, z.range_m);
  const std::size_t rate = BandOf(kRateEdges_mps, z.ground_range_rate_mps);
  const std::size_t cell = (range * kAzimuths + azimuth) * kRates + rate;
  return static_cast<int>(static_cast<std::size_t>(z.radar) * kCells + cell);
}

void ClutterMap::Age(int radar) {
  constexpr auto kStays = static_cast<float>(1.0 - 1.0 / kMemory);
  const auto of_radar =
      std::span(counts_).subspan(static_cast<std::size_t>(radar) * kCells, kCells);
  for (float& count : of_radar) count *= kStays;
  float& scans = scans_[static_cast<std::size_t>(radar)];
  scans = kStays * scans + 1.0F;
}

void ClutterMap::Count(int cell, int clusters) {
  if (cell >= 0) counts_[static_cast<std::size_t>(cell)] += static_cast<float>(clusters);
}

double ClutterMap::DensityAt(const RadarConfig& radar, const RadarMeasurement& z) const {
  const auto index = static_cast<std::size_t>(CellOf(radar, z));
  const double counted = static_cast<double>(counts_[index]) - kFree;
  if (counted <= 0.0) return 0.0;
  const std::size_t cell = index % kCells;
  const double volume =
      WidthOf(kRangeEdges_m, cell / (kAzimuths * kRates), radar.min_range_m, radar.max_range_m) *
      (2.0 * radar.half_fov_rad / kAzimuths) *
      WidthOf(kRateEdges_mps, cell % kRates, -kMostRate_mps, kMostRate_mps);
  const double scans = std::max<double>(scans_[index / kCells], kLeastScans);
  return counted / (scans * volume);
}

}  // namespace v2vouch
