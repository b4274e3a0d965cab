// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/radar_candidates.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "daemon/common/base/angle.h"
#include "daemon/local/tracking/crowd_shape.h"
#include "daemon/local/tracking/existence.h"

namespace v2vouch {
namespace {

// Range rates of clutter spread over this much [m/s]: +-30.
constexpr double kDopplerSpan_mps = 60.0;
// Standing returns share a narrow band of ground range rate.
constexpr double kStaticDopplerSpan_mps = 1.2;
// Added to the reach of a cluster's own noise.
constexpr double kReachMargin_m = 1.0;
// An echo between two vehicles against twice the nearer one's range, bearing and range rate.
constexpr double kEchoRange_m = 2.0;
constexpr double kEchoSigmas = 3.0;
constexpr double kEchoBearing_rad = 0.01;
constexpr double kFaceHalf_m = 1.2;  // A face throws back from so far beside what was seen of it.
constexpr double kEchoRate_mps = 0.6;
constexpr double kEchoWeaker_db = 15.0;

bool IsFinite(const RadarMeasurement& z) {
  return std::isfinite(z.range_m) && std::isfinite(z.azimuth_rad) &&
         std::isfinite(z.range_rate_mps) && z.covariance.allFinite() && z.range_m > 0.0;
}

// How far beside a cluster a bearing is; 0 between its edges.
double AsideOf(const RadarMeasurement& z, double azimuth_rad) {
  const double left = AngleDifference(azimuth_rad, std::max(z.azimuth_max_rad, z.azimuth_rad));
  const double right = AngleDifference(std::min(z.azimuth_min_rad, z.azimuth_rad), azimuth_rad);
  return std::max({left, right, 0.0});
}

// What is reflected between the car and the vehicle before it comes back from twice as far, at
// twice the range rate, in the same direction and weaker: it starts nothing, and by itself it keeps
// nothing alive.
void DenyEchoes(const RadarLook& look, std::span<const RadarMeasurement> measurements,
                Candidates& candidates) {
  const double bearing_rad = kEchoSigmas * look.radar.azimuth_sigma_rad + kEchoBearing_rad;
  for (std::size_t j = 0; j < measurements.size(); ++j) {
    const RadarMeasurement& echo = measurements[j];
    if (!candidates[j].may_start || echo.outline_count == 0) continue;
    for (const RadarMeasurement& z : measurements) {
      if (z.outline_count == 0 || std::abs(echo.range_m - 2.0 * z.range_m) > kEchoRange_m) continue;
      if (AsideOf(z, echo.azimuth_rad) > bearing_rad + kFaceHalf_m / z.range_m) continue;
      if (std::abs(echo.range_rate_mps - 2.0 * z.range_rate_mps) > kEchoRate_mps) continue;
      if (z.outline[0].strength_db < echo.outline[0].strength_db + kEchoWeaker_db) continue;
      candidates[j].may_start = false;
      candidates[j].is_echo = true;
      break;
    }
  }
}

}  // namespace

void AddRadarCandidates(const RadarLook& look, std::span<const RadarMeasurement> measurements,
                        double birth_per_m2_s, const TrackTable& table,
                        const ClutterMap& clutter_map, Candidates& candidates) {
  const RadarConfig& radar = look.radar;
  const double cells = (radar.max_range_m - radar.min_range_m) * 2.0 * radar.half_fov_rad;
  const double births =
      birth_per_m2_s * radar.period_s * radar.half_fov_rad * radar.max_range_m * radar.max_range_m;
  const auto standing = std::ranges::count_if(measurements, &RadarMeasurement::is_static);
  const double crowd = table.CrowdOf(measurements.size() - static_cast<std::size_t>(standing));
  const bool is_crowded = crowd > radar.clutter_per_scan;
  const double clutter = is_crowded ? crowd : radar.clutter_per_scan;
  CrowdShape crowd_shape;
  if (is_crowded) crowd_shape.Fill(radar, measurements);
  const double moving_density = clutter / (cells * kDopplerSpan_mps);
  const double static_density =
      (static_cast<double>(standing) + 1.0) / (cells * kStaticDopplerSpan_mps);

  for (const RadarMeasurement& z : measurements) {
    Candidate candidate;
    if (IsFinite(z)) {
      const Fix fix = FixOf(look, z);
      candidate.p_O = fix.p_O;
      candidate.reach_m = kCoarseSigmas * LargestSigma(fix.covariance) + kReachMargin_m;
      candidate.may_start = !z.is_static;
    } else {
      candidate.p_O = Candidate::Nowhere();
    }
    double density = static_density;
    if (!z.is_static) {
      const double of_scan = is_crowded ? moving_density * crowd_shape.At(z) : moving_density;
      density = std::max(of_scan, clutter_map.DensityAt(radar, z));
    }
    candidate.birth_existence =
        BirthExistence(births, clutter * std::max(density / moving_density, 1.0));
    candidate.log_density = std::log(density / (1.0 - candidate.birth_existence));
    candidates.Add(candidate);
  }
  DenyEchoes(look, measurements, candidates);
  candidates.Sort();
}

bool KeepNearest(std::span<const RadarMeasurement> measurements, std::size_t most,
                 std::vector<std::size_t>& which) {
  if (which.size() <= most) return false;
  std::ranges::sort(which, {},
                    [&](std::size_t j) { return std::pair(measurements[j].range_m, j); });
  which.resize(most);
  std::ranges::sort(which);
  return true;
}

}  // namespace v2vouch
