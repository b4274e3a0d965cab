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
// Comes nearer across the path: a change of lanes takes 1 to 1.5 m/s.
constexpr double kLeavesLane_mps = 0.8;
// Within its lane it wanders: velocity across, and what that changes by in a second.
constexpr double kWander_mps = 0.25;
constexpr double kEye_m = 1.5;  // Driver's eye ahead of the rear axle, about.

}  // namespace

BodyTarget InBody(const Target& target, const Eigen::Vector2d& ego_p_O, double ego_yaw_O) {
  BodyTarget out;
  const double c = std::cos(ego_yaw_O);
  const double s = std::sin(ego_yaw_O);
  StateMatrix turn = StateMatrix::Identity();
  turn(kX, kX) = c;
  turn(kX, kY) = s;
  turn(kY, kX) = -s;
  turn(kY, kY) = c;
  StateVector mean = target.state_O.mean;
  mean.head<2>() -= ego_p_O;
  out.mean = turn * mean;
  out.mean[kYaw] = WrapAngle(mean[kYaw] - ego_yaw_O);
  out.covariance = turn * target.state_O.covariance * turn.transpose();
  out.size = {0.5 * target.extent.length_m, 0.5 * target.extent.width_m};
  if (out.covariance(kYaw, kYaw) > kUnknownAxis_rad * kUnknownAxis_rad) {
    out.size.length_m = std::min(out.size.length_m, out.size.width_m);
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
  BodyTarget kept = target;
  kept.mean[kYaw] = WrapAngle(target.mean[kYaw] - placement.turned_rad);
  kept.mean[kYawRate] = plan.curvature_per_m * speed_mps;
  const double wander_rad = kWander_mps / std::abs(speed_mps);
  for (const int state : {kYaw, kYawRate}) {
    const double before = std::sqrt(std::max(kept.covariance(state, state), 0.0));
    const double share = before > wander_rad ? wander_rad / before : 1.0;
    kept.covariance.row(state) *= share;
    kept.covariance.col(state) *= share;
  }
  return kept;
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
