// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/ego.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sim/sensors/subject.h"

namespace v2vouch::sim {

GeographicLib::LocalCartesian PlaneOf(const OriginSpec& origin) {
  return {ToDegrees(origin.latitude_rad), ToDegrees(origin.longitude_rad), origin.height_m};
}

GeodeticPlace GeodeticOf(const GeographicLib::LocalCartesian& plane, const Vec2& point,
                         double height_m) {
  GeodeticPlace place;
  std::vector<double> turn(9);  // Takes east-north-up there to axes of the plane, row-major.
  plane.Reverse(point.x(), point.y(), height_m, place.latitude_deg, place.longitude_deg,
                place.height_m, turn);
  // The plane's x axis in east and north components there is the matrix's first row.
  place.turn_rad = std::atan2(turn[1], turn[0]);
  return place;
}

double HeadingOf(double yaw_rad) {
  const double heading = WrapAngle(kPi / 2 - yaw_rad);
  return heading < 0.0 ? heading + 2.0 * kPi : heading;
}

void OdometrySimulator::Measure(const Snapshot& snapshot, std::int64_t seq,
                                ego_motion_t& motion) const {
  const OdometrySpec& spec = world_.scenario().odometry;
  const EgoTruth& ego = snapshot.ego;
  Random random = SubjectRandom(seed_, "odometry", {static_cast<std::uint64_t>(seq)});
  const double speed_noise = random.Normal(0.0, spec.speed_sigma_mps);
  const double yaw_noise = random.Normal(0.0, spec.yaw_rate_sigma_radps);
  const double long_noise = random.Normal(0.0, spec.accel_sigma_mps2);
  const double lat_noise = random.Normal(0.0, spec.accel_sigma_mps2);
  const bool stands = std::abs(ego.speed_mps) < 0.1;
  motion.seq = seq;
  const double speed_mps = ego.speed_mps - spec.y_m * ego.yaw_rate_radps;
  motion.speed_mps = stands ? 0.0 : spec.speed_scale * speed_mps + speed_noise;
  // What a careful supplier would state: noise and scale error together.
  motion.speed_sigma_mps =
      std::hypot(std::max(0.01, spec.speed_sigma_mps), (spec.speed_scale - 1.0) * ego.speed_mps);
  motion.yaw_rate_radps = ego.yaw_rate_radps + spec.yaw_rate_bias_radps + yaw_noise;
  motion.yaw_rate_sigma_radps =
      std::max(1e-4, std::hypot(spec.yaw_rate_sigma_radps, spec.yaw_rate_bias_radps));
  motion.accel_long_mps2 = ego.accel_mps2 + long_noise;
  motion.accel_long_sigma_mps2 = std::max(0.01, spec.accel_sigma_mps2);
  motion.accel_lat_mps2 = ego.speed_mps * ego.yaw_rate_radps + lat_noise;
  motion.accel_lat_sigma_mps2 = std::max(0.01, spec.accel_sigma_mps2);
  motion.gear = ego.speed_mps < -0.1 ? ego_motion_t::GEAR_REVERSE : ego_motion_t::GEAR_FORWARD;
}

EgoGnssSimulator::EgoGnssSimulator(const World& world, std::uint64_t seed)
    : world_(world),
      seed_(seed),
      plane_(PlaneOf(world.scenario().origin)),
      error_(world.scenario().gnss.error, 1.0, SubjectRandom(seed, "ego gnss", {})) {}

void SetCovariance(const GnssErrorSpec& e, gnss_fix_t& fix) {
  const double variance = e.bias_sigma_m * e.bias_sigma_m + e.markov_sigma_m * e.markov_sigma_m +
                          e.white_sigma_m * e.white_sigma_m;
  std::fill(std::begin(fix.covariance_enu_m2), std::end(fix.covariance_enu_m2), 0.0);
  fix.covariance_enu_m2[0] = std::max(1e-6, variance);
  fix.covariance_enu_m2[4] = std::max(1e-6, variance);
  fix.covariance_enu_m2[8] = std::max(1e-6, e.height_sigma_m * e.height_sigma_m + variance);
}

void EgoGnssSimulator::Measure(const Snapshot& snapshot, std::int64_t seq, double dt_s,
                               gnss_fix_t& fix) {
  const EgoGnssSpec& spec = world_.scenario().gnss;
  const VehicleConfig& vehicle = world_.vehicle();
  Random random = SubjectRandom(seed_, "ego gnss noise", {static_cast<std::uint64_t>(seq)});
  const GnssError::Value error = error_.Step(dt_s);
  const Vec2 antenna = snapshot.ego.PointAt(vehicle.antenna_x_m, vehicle.antenna_y_m);
  Vec2 shift = error.horizontal;
  if (spec.jump_at_s > 0.0 && snapshot.time_s >= spec.jump_at_s) {
    shift += Vec2(spec.jump_east_m, spec.jump_north_m);
  }
  Vec2 drag_mps = Vec2::Zero();
  if (spec.ramp_s > 0.0) {
    const Vec2 whole(spec.ramp_east_m, spec.ramp_north_m);
    const double share = (snapshot.time_s - spec.ramp_at_s) / spec.ramp_s;
    shift += std::clamp(share, 0.0, 1.0) * whole;
    if (share > 0.0 && share < 1.0) drag_mps = whole / spec.ramp_s;
  }
  const GeodeticPlace place = GeodeticOf(plane_, antenna + shift, error.height_m);
  fix.seq = seq;
  fix.latitude_rad = FromDegrees(place.latitude_deg);
  fix.longitude_rad = FromDegrees(place.longitude_deg);
  fix.altitude_m = place.height_m;
  SetCovariance(spec.error, fix);
  const double heading_noise = random.Normal(0.0, spec.heading_sigma_rad);
  const double east_noise = random.Normal(0.0, spec.velocity_sigma_mps);
  const double north_noise = random.Normal(0.0, spec.velocity_sigma_mps);
  const double up_noise = random.Normal(0.0, spec.velocity_sigma_mps);
  Vec2 outlier_mps = Vec2::Zero();
  double outlier_rad = 0.0;
  const double outliers = world_.scenario().sensors.outlier_share;
  if (outliers > 0.0 && random.Bernoulli(outliers)) {
    const double by = kOutlierSigmas * random.Uniform(-1.0, 1.0);
    if (random.Bernoulli(0.5)) {
      outlier_rad = by * spec.heading_sigma_rad;
    } else {
      outlier_mps = by * spec.velocity_sigma_mps * Direction(random.Uniform(-kPi, kPi));
    }
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  fix.heading_rad = spec.has_heading
                        ? HeadingOf(snapshot.ego.yaw_rad + place.turn_rad + spec.heading_bias_rad +
                                    heading_noise + outlier_rad)
                        : nan;
  fix.heading_sigma_rad =
      spec.has_heading ? std::max(1e-4, std::hypot(spec.heading_sigma_rad, spec.heading_bias_rad))
                       : nan;
  const Vec2 velocity_W = snapshot.ego.VelocityAt(antenna) + drag_mps + outlier_mps;
  const Vec2 east_W = Direction(-place.turn_rad);  // True east, seen in W.
  fix.velocity_east_mps = velocity_W.dot(east_W) + east_noise;
  fix.velocity_north_mps = velocity_W.dot(LeftOf(east_W)) + north_noise;
  fix.velocity_up_mps = up_noise;
  fix.velocity_sigma_mps = std::max(0.01, spec.velocity_sigma_mps);
  fix.fix_type = gnss_fix_t::FIX_3D;
}

}  // namespace v2vouch::sim
