// SPDX-License-Identifier: Apache-2.0
#include "calibration/extrinsics/static_doppler.h"

#include <algorithm>
#include <cmath>

namespace v2vouch {
namespace {

constexpr int kIterations = 4;

}  // namespace

std::array<double, 2> MotionAt(const EgoTrack::Sample& sample, const double* ego) {
  const double omega = sample.yaw_rate_radps - ego[MountingParameters::kYawRateBias];
  return {sample.speed_mps / ego[MountingParameters::kSpeedScale] +
              omega * ego[MountingParameters::kOdometerY],
          omega};
}

double DopplerResidual::operator()(const double* radar, const double* motion, double slip,
                                   double* d_radar, double* d_motion, double* d_slip) const {
  const double v = motion[0] + dt_s * accel_mps2;
  const double omega = motion[1] + dt_s * yaw_accel_radps2;
  const double vx = v - omega * radar[1];
  const double vy = omega * (radar[0] - slip * v * v);
  const double wd = 1.0 / (range_rate_sigma_mps * range_rate_sigma_mps);
  const double wa = 1.0 / (azimuth_sigma_rad * azimuth_sigma_rad);
  double c = 0.0;
  double s = 0.0;
  double k = 0.0;
  double correction = 0.0;
  for (int i = 0; i < kIterations; ++i) {
    s = std::sin(radar[2] + azimuth_rad + correction);
    k = std::cos(radar[2] + azimuth_rad + correction);
    const double e = range_rate_mps + vx * k + vy * s;
    const double slope = vy * k - vx * s;
    // Gauss-Newton on e(t + c)^2 wd + c^2 wa.
    c = (e * slope * wd + correction * wa) / (slope * slope * wd + wa);
    correction -= c;
  }
  s = std::sin(radar[2] + azimuth_rad + correction);
  k = std::cos(radar[2] + azimuth_rad + correction);
  const double slope = vy * k - vx * s;
  const double scale = 1.0 / std::sqrt(1.0 / wd + slope * slope / wa);
  const double r = scale * (range_rate_mps + vx * k + vy * s - slope * correction);
  if (d_radar != nullptr) {
    d_radar[0] = scale * s * omega;
    d_radar[1] = -scale * k * omega;
    d_radar[2] = scale * slope;
  }
  if (d_motion != nullptr) {
    d_motion[0] = scale * (k - 2.0 * s * slip * v * omega);
    d_motion[1] = scale * (s * (radar[0] - slip * v * v) - k * radar[1]);
  }
  if (d_slip != nullptr) *d_slip = -scale * s * v * v * omega;
  return r;
}

DopplerResidual ResidualOf(const StaticReturn& one, const EgoTrack& ego, const RadarConfig& radar) {
  const EgoTrack::Sample& sample = ego.samples()[one.epoch];
  return {.azimuth_rad = one.azimuth_rad,
          .range_rate_mps = one.range_rate_mps,
          .dt_s = one.dt_s,
          .accel_mps2 = sample.accel_mps2,
          .yaw_accel_radps2 = sample.yaw_accel_radps2,
          .range_rate_sigma_mps = radar.range_rate_sigma_mps,
          .azimuth_sigma_rad = radar.azimuth_sigma_rad};
}

std::vector<StaticReturn> SelectStaticReturns(const DriveLog& log, const EgoTrack& ego,
                                              const VehicleConfig& vehicle,
                                              const MountingParameters& parameters,
                                              const DopplerSelection& selection) {
  std::vector<std::vector<std::vector<StaticReturn>>> by_radar(vehicle.radars.size());
  std::vector<std::size_t> counts(vehicle.radars.size(), 0);
  const double slip = parameters.Ego()[MountingParameters::kSlip];
  for (const RadarScan& scan : log.scans) {
    const auto radar = static_cast<std::size_t>(scan.radar);
    const RadarConfig& config = vehicle.radars[radar];
    const auto epoch = ego.Nearest(scan.stamp);
    if (!epoch) continue;
    const EgoTrack::Sample& sample = ego.samples()[*epoch];
    if (sample.speed_mps < selection.min_speed_mps) continue;
    const auto motion = MotionAt(sample, parameters.Ego());
    std::vector<StaticReturn> kept;
    for (const RadarDetection& detection : scan.detections) {
      const StaticReturn one{.radar = scan.radar,
                             .epoch = *epoch,
                             .dt_s = ToSeconds(scan.stamp - sample.stamp),
                             .azimuth_rad = detection.azimuth_rad,
                             .range_rate_mps = detection.range_rate_mps};
      const DopplerResidual residual = ResidualOf(one, ego, config);
      std::array<double, 3> d{};
      const double r =
          residual(parameters.Radar(scan.radar), motion.data(), slip, d.data(), nullptr, nullptr);
      // The odometry's own noise comes on top of the radar's.
      const double sigma_mps = std::hypot(config.range_rate_sigma_mps, ego.speed_sigma_mps());
      const double gate = selection.gate_sigmas * sigma_mps / config.range_rate_sigma_mps +
                          std::abs(d[2]) * selection.slack_rad +
                          selection.slack_speed * sample.speed_mps / config.range_rate_sigma_mps;
      if (std::abs(r) <= gate) kept.push_back(one);
    }
    counts[radar] += kept.size();
    by_radar[radar].push_back(std::move(kept));
  }
  std::vector<StaticReturn> selected;
  for (std::size_t radar = 0; radar < by_radar.size(); ++radar) {
    const std::size_t step = 1 + counts[radar] / static_cast<std::size_t>(selection.max_per_radar);
    for (std::size_t i = 0; i < by_radar[radar].size(); i += step) {
      selected.insert(selected.end(), by_radar[radar][i].begin(), by_radar[radar][i].end());
    }
  }
  return selected;
}

}  // namespace v2vouch
