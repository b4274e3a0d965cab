// SPDX-License-Identifier: Apache-2.0
// What the receiver says of the ego's motion. Its positions are not used (drive_problem.h).
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "calibration/extrinsics/drive_equations.h"
#include "calibration/extrinsics/white_noise.h"

namespace v2vouch {
namespace {

constexpr double kMinSpeed_mps = 2.0;  // Slower, the direction of GNSS velocity says little.

struct GnssNoise {
  double speed_sigma = 0.0;
  double heading_sigma = 0.0;
};

// White noise of heading and speed, against the odometry's smooth signals.
GnssNoise NoiseOf(const DriveData& data) {
  std::vector<double> headings, speeds, heading_sigmas, speed_sigmas;
  for (const GnssFix& fix : data.log->fixes) {
    const Timestamp t = fix.stamp - FromSeconds(data.vehicle->gnss_latency_s);
    const auto nearest = data.ego->Nearest(t);
    if (!nearest || !fix.velocity_en_mps ||
        data.ego->samples()[*nearest].speed_mps < kMinSpeed_mps) {
      continue;
    }
    const EgoTrack::Sample& sample = data.ego->samples()[*nearest];
    speeds.push_back(fix.velocity_en_mps->norm() - sample.speed_mps);
    speed_sigmas.push_back(fix.velocity_sigma_mps);
    if (fix.yaw_rad) {
      const double off = *fix.yaw_rad - data.ego->At(t)->yaw_rad;
      headings.push_back(
          headings.empty() ? off : headings.back() + AngleDifference(off, headings.back()));
      heading_sigmas.push_back(fix.yaw_sigma_rad);
    }
  }
  return {WhiteSigmaWithin(speeds, std::move(speed_sigmas), 0.1),
          WhiteSigmaWithin(headings, std::move(heading_sigmas), FromDegrees(0.5))};
}

}  // namespace

void DriveEquations::AddGnss() {
  const auto [speed_sigma, heading_sigma] = NoiseOf(data);
  for (const GnssFix& fix : data.log->fixes) {
    const Timestamp t = fix.stamp - FromSeconds(data.vehicle->gnss_latency_s);
    const auto nearest = data.ego->Nearest(t);
    if (!nearest || !fix.velocity_en_mps) continue;
    const EgoTrack::Sample& sample = data.ego->samples()[*nearest];
    const Eigen::Vector2d& velocity = *fix.velocity_en_mps;
    if (sample.speed_mps < kMinSpeed_mps || velocity.norm() < kMinSpeed_mps) continue;
    // Without a heading the body is taken to point along the velocity: the length alone speaks.
    const double yaw = fix.yaw_rad ? *fix.yaw_rad : std::atan2(velocity.y(), velocity.x());
    GnssVelocityCost cost{.velocity_e = velocity.x(),
                          .velocity_n = velocity.y(),
                          .yaw_rad = yaw,
                          .dt_s = ToSeconds(t - sample.stamp),
                          .accel_mps2 = sample.accel_mps2,
                          .yaw_accel_radps2 = sample.yaw_accel_radps2,
                          .sigma_mps = speed_sigma,
                          .across = false};
    double* const epoch = Epoch(*nearest);
    Add(AutoDiff<GnssVelocityCost, 2, MountingParameters::kEgo>(cost), &cauchy,
        Group("gnss.velocity"), SecondsOf(t), epoch, parameters.Ego());
    if (!fix.yaw_rad) continue;
    cost.across = true;
    cost.sigma_mps = std::hypot(speed_sigma, velocity.norm() * heading_sigma);
    Add(AutoDiff<GnssVelocityCost, 2, MountingParameters::kEgo>(cost), &cauchy,
        Group("gnss.heading"), SecondsOf(t), epoch, parameters.Ego());
  }
  AddGyroDrift(heading_sigma);
}

// Single headings say nothing of the gyro's bias; their drift against its integral does. Where the
// receiver has no heading, its course on straight stretches serves.
void DriveEquations::AddGyroDrift(double heading_sigma) {
  constexpr double kKnot_s = 5.0;
  constexpr double kStraight_radps = 0.02;
  const auto& samples = data.ego->samples();
  const double sample_s = ToSeconds(samples.back().stamp - samples.front().stamp) /
                          static_cast<double>(samples.size() - 1);
  const double walk = data.ego->yaw_rate_sigma_radps() * std::sqrt(sample_s * kKnot_s);
  drifts.resize(static_cast<std::size_t>(SecondsOf(samples.back().stamp) / kKnot_s) + 2);
  const auto knot = [&](std::size_t k, double start) {
    if (!drifts[k]) {
      drifts[k] = start;
      blocks.push_back(&*drifts[k]);
    }
    return &*drifts[k];
  };
  std::optional<double> last;
  for (const GnssFix& fix : data.log->fixes) {
    const Timestamp t = fix.stamp - FromSeconds(data.vehicle->gnss_latency_s);
    const auto place = data.ego->At(t);
    if (!place || t < samples.front().stamp || t > samples.back().stamp) continue;
    double yaw = 0.0;
    double sigma = heading_sigma;
    if (fix.yaw_rad) {
      yaw = *fix.yaw_rad;
    } else if (fix.velocity_en_mps && fix.velocity_en_mps->norm() > kMinSpeed_mps &&
               std::abs(samples[*data.ego->Nearest(t)].yaw_rate_radps) < kStraight_radps) {
      yaw = std::atan2(fix.velocity_en_mps->y(), fix.velocity_en_mps->x());
      sigma = std::max(heading_sigma, fix.velocity_sigma_mps / fix.velocity_en_mps->norm());
    } else {
      continue;
    }
    const double off = yaw - place->yaw_rad;
    const double drift = last ? *last + AngleDifference(off, *last) : off;
    last = drift;
    const double at = SecondsOf(t) / kKnot_s;
    const auto k = static_cast<std::size_t>(at);
    double* const from = knot(k, drift);
    double* const to = knot(k + 1, drift);
    Add(AutoDiff<HeadingDriftCost, 1, 1>({drift, sigma, at - static_cast<double>(k)}), &cauchy,
        Group("gnss.heading"), SecondsOf(t), from, to);
  }
  for (std::size_t k = 0; k + 1 < drifts.size(); ++k) {
    if (!drifts[k] || !drifts[k + 1]) continue;
    Add(AutoDiff<GyroDriftCost, 1, 1, MountingParameters::kEgo>({kKnot_s, walk}), &cauchy,
        Group("odometry.yaw_rate"), kKnot_s * static_cast<double>(k), &*drifts[k], &*drifts[k + 1],
        parameters.Ego());
  }
}

}  // namespace v2vouch
