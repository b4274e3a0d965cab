// SPDX-License-Identifier: Apache-2.0
#include "daemon/warnings/placement.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"

namespace v2vouch::warnings {
namespace {

// Beyond this sigma of the heading no list claims to know the axis.
constexpr double kUnknownAxis_rad = 0.5;
constexpr double kSameDirection_rad = 0.786;  // 45 degrees
constexpr double kOncoming_rad = 2.356;       // 135 degrees
constexpr double kStandsSigma_mps = 1.0;      // Of the speed of what shows none and no axis either.
// Comes nearer across the path: a change of lanes takes 1 to 1.5 m/s.
constexpr double kLeavesLane_mps = 0.8;
// Within its lane it wanders: velocity across, and what that changes by in a second.
constexpr double kWander_mps = 0.25;
// Of what crosses, beside what its track knows: acceleration along and across, sigmas.
constexpr double kUsualAccel_mps2 = 1.0;
constexpr double kUsualAcross_mps2 = 0.5;
constexpr double kContradicts_sigmas = 2.0;
constexpr double kEye_m = 1.5;  // Driver's eye ahead of the rear axle, about.

// Turns the place in a state into axes that lie at `yaw_rad`.
StateMatrix IntoAxes(double yaw_rad) {
  const double c = std::cos(yaw_rad);
  const double s = std::sin(yaw_rad);
  StateMatrix turn = StateMatrix::Identity();
  turn.topLeftCorner<2, 2>() << c, s, -s, c;
  return turn;
}

// Lowers the sigma of one state to `at_most`, correlations kept.
void Narrow(StateMatrix& covariance, int state, double at_most) {
  const double before = std::sqrt(std::max(covariance(state, state), 0.0));
  if (before <= at_most) return;
  covariance.row(state) *= at_most / before;
  covariance.col(state) *= at_most / before;
}

bool IsAxisKnown(const BodyTarget& target) {
  return target.covariance(kYaw, kYaw) <= kUnknownAxis_rad * kUnknownAxis_rad;
}

// The vehicle turned by `-off_rad` into a lane of this curvature, in which it wanders.
BodyTarget Along(const BodyTarget& target, double off_rad, double curvature_per_m) {
  const double speed_mps = target.mean[kSpeed];
  BodyTarget kept = target;
  kept.mean[kYaw] = WrapAngle(target.mean[kYaw] - off_rad);
  kept.mean[kYawRate] = curvature_per_m * speed_mps;
  const double wander_rad = kWander_mps / std::abs(speed_mps);
  for (const int state : {kYaw, kYawRate}) Narrow(kept.covariance, state, wander_rad);
  return kept;
}

// Joins the expectation that a state is 0 give or take `sigma`, where it does not contradict.
void Expect(BodyTarget& target, int state, double sigma) {
  const double variance = target.covariance(state, state) + sigma * sigma;
  const double off = target.mean[state];
  if (off * off > kContradicts_sigmas * kContradicts_sigmas * variance) return;
  const Eigen::Matrix<double, kStateSize, 1> gain = target.covariance.col(state) / variance;
  target.mean -= gain * off;
  target.covariance -= variance * gain * gain.transpose();
}

}  // namespace

BodyTarget InBody(const Target& target, const Eigen::Vector2d& ego_p_O, double ego_yaw_O) {
  BodyTarget out;
  const StateMatrix turn = IntoAxes(ego_yaw_O);
  StateVector mean = target.state_O.mean;
  mean.head<2>() -= ego_p_O;
  out.mean = turn * mean;
  out.mean[kYaw] = WrapAngle(mean[kYaw] - ego_yaw_O);
  out.covariance = turn * target.state_O.covariance * turn.transpose();
  out.size = {0.5 * target.extent.length_m, 0.5 * target.extent.width_m};
  if (!IsAxisKnown(out)) {
    out.size.length_m = std::min(out.size.length_m, out.size.width_m);
    // Nor a speed: what shows none stands.
    if (std::abs(mean[kSpeed]) < kTargetStands_mps) {
      Narrow(out.covariance, kSpeed, kStandsSigma_mps);
    }
  }
  return out;
}

bool IsInEgo(const BodyTarget& target, const EgoBody& body) {
  constexpr double kDeep_m = 0.3;
  const HalfSize own{0.5 * body.length_m - kDeep_m, 0.5 * body.width_m - kDeep_m};
  const StateVector& x = target.mean;
  return Touch({{body.centre_x_m, 0.0}, {1.0, 0.0}}, own,
               {x.head<2>(), {std::cos(x[kYaw]), std::sin(x[kYaw])}}, target.size);
}

BodyTarget InItsLane(const EgoPlan& plan, const BodyTarget& target, const Placement& placement) {
  const double speed_mps = target.mean[kSpeed];
  if (std::abs(speed_mps) < kTargetStands_mps) return target;
  const double left_mps = std::abs(speed_mps) * std::sin(placement.turned_rad);
  const double side = placement.place.left_m > 0.0 ? 1.0 : -1.0;
  const bool leaves = placement.zone == Zone::kAheadAside ? -side * left_mps > kLeavesLane_mps
                                                          : std::abs(left_mps) > kLeavesLane_mps;
  if (leaves) return target;
  return Along(target, placement.turned_rad, plan.curvature_per_m);
}

std::optional<BodyTarget> ComingInItsLane(const BodyTarget& target, const Placement& placement) {
  const double speed_mps = std::abs(target.mean[kSpeed]);
  if (speed_mps < kTargetStands_mps || !IsAxisKnown(target)) return std::nullopt;
  if (speed_mps * speed_mps < 4.0 * target.covariance(kSpeed, kSpeed)) return std::nullopt;
  if (speed_mps * std::abs(std::sin(placement.turned_rad)) > kLeavesLane_mps) return std::nullopt;
  BodyTarget kept = Along(target, WrapAngle(placement.turned_rad - kPi), 0.0);
  const StateMatrix turn = IntoAxes(placement.place.yaw_rad);
  kept.covariance = turn * kept.covariance * turn.transpose();
  kept.mean.head<2>() << placement.place.along_m, placement.place.left_m;
  kept.mean[kYaw] = WrapAngle(kept.mean[kYaw] - placement.place.yaw_rad);
  return kept;
}

BodyTarget Steadied(const BodyTarget& target) {
  BodyTarget steady = target;
  const double speed_mps = std::abs(target.mean[kSpeed]);
  Expect(steady, kAccel, kUsualAccel_mps2);
  Expect(steady, kYawRate, kUsualAcross_mps2 / std::max(speed_mps, kTargetStands_mps));
  return steady;
}

bool IsAlongside(const EgoBody& body, const BodyTarget& target, const Placement& placement) {
  return placement.zone == Zone::kAheadAside &&
         placement.place.along_m - target.size.length_m < body.centre_x_m + 0.5 * body.length_m;
}

Placement Classify(const EgoPlan& plan, const EgoBody& body, const BodyTarget& target,
                   const WarningsConfig& config) {
  Placement placement;
  placement.place = PlaceOnPath(plan, target.mean.head<2>());
  const double reverse = target.mean[kSpeed] < 0.0 ? kPi : 0.0;
  const double turned = WrapAngle(target.mean[kYaw] - placement.place.yaw_rad);
  placement.turned_rad = WrapAngle(turned + reverse);
  placement.half_across_m = std::abs(target.size.length_m * std::sin(turned)) +
                            std::abs(target.size.width_m * std::cos(turned));
  const double along = placement.place.along_m;
  const double in_path_m = 0.5 * body.width_m + placement.half_across_m + config.path_margin_m;
  const bool in_path = std::abs(placement.place.left_m) <= in_path_m;
  const bool stands = std::abs(target.mean[kSpeed]) < kTargetStands_mps;
  const double off = std::abs(placement.turned_rad);
  const double front_m = body.centre_x_m + 0.5 * body.length_m;
  if (stands) {
    if (along > front_m && in_path) placement.zone = Zone::kAhead;
    return placement;
  }
  if (off <= kSameDirection_rad) {
    if (target.mean[kX] < kEye_m) {
      placement.zone = Zone::kBehind;
    } else {
      placement.zone = in_path ? Zone::kAhead : Zone::kAheadAside;
    }
  } else if (along < 0.0) {
    placement.zone = Zone::kElsewhere;
  } else if (off >= kOncoming_rad) {
    placement.zone = Zone::kOncoming;
  } else {
    placement.zone = placement.turned_rad < 0.0 ? Zone::kFromLeft : Zone::kFromRight;
  }
  return placement;
}

}  // namespace v2vouch::warnings
