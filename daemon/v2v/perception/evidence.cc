// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/perception/evidence.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"

namespace v2vouch {
namespace {

// Below this a direction is a memory rather than a measurement.
constexpr double kDirectionSpeed_mps = 2.0;
constexpr double kClearShare = 0.9;
constexpr double kHit_s = 0.35;  // As BridgeConfig::support_s by default.

struct VelocityResidual {
  double speed_mps = 0.0;
  std::optional<double> yaw_rad;
};

VelocityResidual CompareVelocity(const ClaimInOdometry& claim, const StateVector& sensed) {
  VelocityResidual residual{claim.speed_mps - sensed[kSpeed], std::nullopt};
  double yaw_rad = AngleDifference(claim.yaw_rad, sensed[kYaw]);
  const double turned_mps = claim.speed_mps + sensed[kSpeed];
  if (!claim.has_course) {
    // Only the amount can be compared.
    residual.speed_mps = std::abs(claim.speed_mps) - std::abs(sensed[kSpeed]);
    return residual;
  }
  if (std::abs(yaw_rad) > 0.5 * kPi && std::abs(turned_mps) < std::abs(residual.speed_mps)) {
    residual.speed_mps = turned_mps;
    yaw_rad = WrapAngle(yaw_rad + kPi);
  }
  if (std::abs(sensed[kSpeed]) > kDirectionSpeed_mps &&
      std::abs(claim.speed_mps) > kDirectionSpeed_mps) {
    residual.yaw_rad = yaw_rad;
  }
  return residual;
}

SectorState StateAt(double azimuth_rad, double range_m, std::span<const SectorHealth> sectors) {
  for (const SectorHealth& sector : sectors) {
    const double span_rad = sector.to_rad - sector.from_rad;
    double into_rad = std::remainder(azimuth_rad - sector.from_rad, 2.0 * kPi);
    if (into_rad < 0.0) into_rad += 2.0 * kPi;
    if (into_rad < (span_rad > 0.0 ? span_rad : span_rad + 2.0 * kPi)) {
      return range_m <= sector.range_m ? sector.state : SectorState::kBlind;
    }
  }
  return SectorState::kBlind;
}

SectorState HealthAt(const Eigen::Vector2d& p_O, const LocalFrame& frame) {
  const Point<Body> p_B = frame.ego.X_OB.Inverse() * Point<Odometry>{p_O.x(), p_O.y()};
  return StateAt(std::atan2(p_B.y_m, p_B.x_m), std::hypot(p_B.x_m, p_B.y_m), frame.sectors);
}

// Two kinds of sensors do not make one mistake.
constexpr int kKindsThatVouch = 2;

int HitsNeeded(SensorKind kind, const SensorSupportConfig& config) {
  switch (kind) {
    case SensorKind::kRadar:
      return config.radar_hits;
    case SensorKind::kCamera:
      return config.camera_hits;
    case SensorKind::kObjects:
      break;
  }
  return config.object_hits;
}

bool Covers(View view) { return view == View::kClear || view == View::kUnknown; }

}  // namespace

bool WasHitLately(const LocalTrack& track, Timestamp now) {
  return ToSeconds(now - track.support.last()) <= kHit_s;
}

double PositionSigma(const KinematicState& state) {
  return std::sqrt(std::max(state.covariance(kX, kX), state.covariance(kY, kY)));
}

PairObservation Compare(const ClaimInOdometry& claim, const KinematicState& sensed) {
  PairObservation observation;
  observation.stamp = claim.stamp;
  observation.residual_m = claim.p_O - sensed.mean.head<2>();
  observation.sensed = sensed.covariance.topLeftCorner<2, 2>();
  observation.noise = claim.noise;
  observation.alignment = claim.alignment;
  const Eigen::Vector2d stale_m = kStalePositionSigma_s * sensed.velocity();
  observation.stale = stale_m * stale_m.transpose();
  const VelocityResidual velocity = CompareVelocity(claim, sensed.mean);
  observation.speed_residual_mps = velocity.speed_mps;
  observation.speed_sigma_mps =
      std::hypot(claim.speed_sigma_mps, std::sqrt(sensed.covariance(kSpeed, kSpeed)), 0.2);
  observation.yaw_residual_rad = velocity.yaw_rad;
  observation.yaw_sigma_rad =
      std::hypot(claim.yaw_sigma_rad, std::sqrt(sensed.covariance(kYaw, kYaw)), 0.05);
  return observation;
}

CoObservation ForTrust(const ClaimInOdometry& claim, const KinematicState& sensed) {
  CoObservation observation;
  observation.stamp = claim.stamp;
  observation.residual_O = claim.p_O - sensed.mean.head<2>();
  observation.alignment_sigma_m = std::sqrt(0.5 * std::max(0.0, claim.alignment.trace()));
  observation.track_yaw_rad = sensed.mean[kYaw];
  observation.track_speed_mps = sensed.mean[kSpeed];
  const VelocityResidual velocity = CompareVelocity(claim, sensed.mean);
  observation.speed_residual_mps = velocity.speed_mps;
  observation.speed_sigma_mps = std::sqrt(sensed.covariance(kSpeed, kSpeed));
  observation.yaw_residual_rad = velocity.yaw_rad;
  observation.yaw_sigma_rad = std::sqrt(sensed.covariance(kYaw, kYaw));
  if (claim.has_course) {
    observation.velocity_residual_O = claim.velocity_O() - sensed.velocity();
  }
  observation.accel_residual_mps2 = claim.accel_mps2 - sensed.mean[kAccel];
  observation.accel_sigma_mps2 = std::sqrt(sensed.covariance(kAccel, kAccel));
  observation.sensed_sigma_m =
      std::sqrt(0.5 * (sensed.covariance(kX, kX) + sensed.covariance(kY, kY)));
  return observation;
}

bool AreSensorsSure(const LocalTrack& track, const LocalFrame& frame, const VisibilityMap& map,
                    const VehicleConfig& vehicle, const SensorSupportConfig& config) {
  int sure = 0;
  int most_hits = 0;
  for (const SensorKind kind : kAllSensorKinds) {
    const int hits = track.support.hits(kind);
    most_hits = std::max(most_hits, hits);
    if (hits >= HitsNeeded(kind, config)) ++sure;
  }
  if (sure >= kKindsThatVouch) return true;
  const Occluder footprint = FootprintOf(track);
  int covering = 0;
  for (const SensorKind kind : kAllSensorKinds) {
    bool covers = false;
    for (int i = 0; i < vehicle.SensorsOf(kind) && !covers; ++i) {
      covers = Covers(map.From({kind, i}, footprint).view);
    }
    covering += covers ? 1 : 0;
  }
  // A silent sensor covers nothing, whatever its geometry says.
  const bool is_watched = HealthAt(footprint.centre_O, frame) == SectorState::kWatched;
  if (covering >= kKindsThatVouch && is_watched) return false;
  return ToSeconds(frame.stamp - track.start) >= config.single_s && most_hits >= config.single_hits;
}

bool AreClose(const Occluder& claimed, const LocalTrack& track, double slack_m) {
  const double yaw = track.state_O.mean[kYaw];
  const Eigen::Vector2d d = claimed.centre_O - track.state_O.mean.head<2>();
  const double along = std::cos(yaw) * d.x() + std::sin(yaw) * d.y();
  const double across = -std::sin(yaw) * d.x() + std::cos(yaw) * d.y();
  const double c = std::abs(std::cos(claimed.yaw_rad - yaw));
  const double s = std::abs(std::sin(claimed.yaw_rad - yaw));
  const double half_along =
      0.5 * (track.extent.length_m + c * claimed.length_m + s * claimed.width_m);
  const double half_across =
      0.5 * (track.extent.width_m + s * claimed.length_m + c * claimed.width_m);
  return std::abs(along) <= half_along + slack_m && std::abs(across) <= half_across + slack_m;
}

std::optional<double> ClearDetection(const Occluder& footprint, const LocalFrame& frame,
                                     const VisibilityMap& map, const VehicleConfig& vehicle,
                                     ClearTo whom, double least_detection) {
  const SectorState health = HealthAt(footprint.centre_O, frame);
  if (health == SectorState::kBlind) return std::nullopt;
  std::optional<double> best;
  for (const SensorKind kind : kAllSensorKinds) {
    bool is_clear = vehicle.SensorsOf(kind) == 0;
    for (int i = 0; i < vehicle.SensorsOf(kind); ++i) {
      const SensorView seen = map.From({kind, i}, footprint);
      if (seen.view != View::kClear || seen.uncovered < kClearShare) continue;
      const double probability = vehicle.DetectionProbabilityOf({kind, i});
      best = std::max(best.value_or(0.0), probability * seen.uncovered);
      is_clear = true;
    }
    if (whom == ClearTo::kEveryKind && !is_clear) return std::nullopt;
  }
  if (best && health == SectorState::kDegraded) best = std::min(*best, least_detection);
  return best;
}

}  // namespace v2vouch
