// SPDX-License-Identifier: Apache-2.0
#include "sim/bench/traffic.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/random.h"

namespace v2vouch::bench {
namespace {

constexpr double kSlowest_mps = 18.0;
constexpr double kFastest_mps = 26.0;
constexpr double kJitter_m = 4.0;  // Of the place within a lane; spacing keeps cars apart.

// A vehicle on its lane: speed mean + sway cos(rate t + phase), along the lane's direction.
struct Driver {
  bool is_oncoming = false;
  double across_m = 0.0;  // From the middle line to the left.
  double start_m = 0.0;   // Along the middle line.
  double mean_mps = 0.0;
  double sway_mps = 0.0;
  double sway_radps = 0.0;
  double phase_rad = 0.0;
};

// The pose at `along` metres of the middle line, `across` to its left. Speeds hold on the lane: a
// lane inside of a bend is shorter.
VehiclePose OnRoad(double along_m, double across_m, double speed_mps, bool is_oncoming,
                   double curvature_per_m) {
  const double yaw = curvature_per_m * along_m;
  VehiclePose pose;
  if (curvature_per_m == 0.0) {
    pose.x_m = along_m;
    pose.y_m = across_m;
  } else {
    const double radius_m = 1.0 / curvature_per_m;
    pose.x_m = (radius_m - across_m) * std::sin(yaw);
    pose.y_m = radius_m - (radius_m - across_m) * std::cos(yaw);
  }
  pose.speed_mps = speed_mps;
  pose.yaw_rad = WrapAngle(is_oncoming ? yaw + kPi : yaw);
  const double lane_curvature = curvature_per_m / (1.0 - across_m * curvature_per_m);
  pose.yaw_rate_radps = (is_oncoming ? -1.0 : 1.0) * speed_mps * lane_curvature;
  return pose;
}

Driver MakeDriver(const TrafficSpec& spec, int index, Random& random) {
  const int lane = index % spec.lanes;
  const int each_way = std::max(spec.lanes / 2, 1);
  const int rank = lane % each_way;  // 0 is the slow lane, at the edge of the road.
  const int rows = spec.vehicles / spec.lanes;
  const int place = index / spec.lanes;
  const double row = place - 0.5 * rows;
  Driver driver;
  driver.is_oncoming = lane >= each_way;
  const double from_middle_m = (each_way - rank - 0.5) * spec.lane_width_m;
  driver.across_m = driver.is_oncoming ? from_middle_m : -from_middle_m;
  driver.start_m = row * spec.spacing_m + random.Uniform(-kJitter_m, kJitter_m);
  driver.mean_mps = kSlowest_mps + (kFastest_mps - kSlowest_mps) * rank / std::max(each_way - 1, 1);
  driver.sway_mps = random.Uniform(0.0, 0.8);
  driver.sway_radps = 2.0 * kPi / random.Uniform(8.0, 20.0);
  driver.phase_rad = random.Uniform(0.0, 2.0 * kPi);
  return driver;
}

VehiclePose TruthOf(const Driver& d, int id, double t_s, double curvature_per_m) {
  const double angle = d.sway_radps * t_s + d.phase_rad;
  const double way_m =
      d.mean_mps * t_s + d.sway_mps / d.sway_radps * (std::sin(angle) - std::sin(d.phase_rad));
  const double stretch = 1.0 - d.across_m * curvature_per_m;
  const double along_m = d.start_m + (d.is_oncoming ? -way_m : way_m) / stretch;
  VehiclePose pose = OnRoad(along_m, d.across_m, d.mean_mps + d.sway_mps * std::cos(angle),
                            d.is_oncoming, curvature_per_m);
  pose.id = id;
  return pose;
}

VehiclePose Noisy(const VehiclePose& truth, const PoseNoise& noise, Random& random) {
  VehiclePose z = truth;
  z.id = -1;
  z.x_m += random.Normal(0.0, noise.position_m);
  z.y_m += random.Normal(0.0, noise.position_m);
  z.speed_mps += random.Normal(0.0, noise.speed_mps);
  z.yaw_rad = WrapAngle(z.yaw_rad + random.Normal(0.0, noise.yaw_rad));
  z.yaw_rate_radps += random.Normal(0.0, noise.yaw_rate_radps);
  return z;
}

}  // namespace

Recording GenerateTraffic(const TrafficSpec& spec) {
  Random random(spec.seed);
  std::vector<Driver> drivers;
  drivers.reserve(static_cast<std::size_t>(std::max(spec.vehicles, 0)));
  for (int i = 0; i < spec.vehicles; ++i) drivers.push_back(MakeDriver(spec, i, random));
  const double half_road_m = 0.5 * spec.lane_width_m * spec.lanes;
  const int rows = spec.vehicles / spec.lanes + 1;
  const double half_length_m = 0.5 * spec.spacing_m * rows + kJitter_m;

  Recording out;
  for (int number = 0; number < spec.frames; ++number) {
    Frame frame{.number = number, .time_s = number * spec.period_s, .truth = {}, .detections = {}};
    for (int i = 0; i < spec.vehicles; ++i) {
      const auto& driver = drivers[static_cast<std::size_t>(i)];
      frame.truth.push_back(TruthOf(driver, i, frame.time_s, spec.curvature_per_m));
      if (!random.Bernoulli(spec.detection_probability)) continue;
      frame.detections.push_back(Noisy(frame.truth.back(), spec.noise, random));
    }
    const int clutter = random.Poisson(spec.clutter_share * spec.vehicles);
    for (int i = 0; i < clutter; ++i) {
      // Each half of the road drives away from where it began.
      const bool is_oncoming = random.Bernoulli(0.5);
      const double way_m = 0.5 * (kSlowest_mps + kFastest_mps) * frame.time_s;
      const double along_m =
          random.Uniform(-half_length_m, half_length_m) + (is_oncoming ? -way_m : way_m);
      const double across_m = (is_oncoming ? 1.0 : -1.0) * random.Uniform(0.0, half_road_m);
      frame.detections.push_back(
          Noisy(OnRoad(along_m, across_m, random.Uniform(kSlowest_mps, kFastest_mps), is_oncoming,
                       spec.curvature_per_m),
                spec.noise, random));
    }
    for (std::size_t i = frame.detections.size(); i > 1; --i) {
      std::swap(frame.detections[i - 1], frame.detections[random.Bits() % i]);
    }
    out.push_back(std::move(frame));
  }
  return spec.heading_rad == 0.0 ? out : Rotated(out, spec.heading_rad);
}

}  // namespace v2vouch::bench
