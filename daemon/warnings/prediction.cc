// SPDX-License-Identifier: Apache-2.0
#include "daemon/warnings/prediction.h"

#include <algorithm>
#include <cstddef>

#include "daemon/common/base/angle.h"

namespace v2vouch::warnings {
namespace {

constexpr double kAccelHolds_s = 1.0;      // Then the speed holds; braking goes on to rest.
constexpr double kYawRateFades_s = 3.0;    // Time constant: bends and turns end.
constexpr double kLargestTurn_rad = 1.75;  // 100 degrees: a turn at a crossing ends.
constexpr double kStartSpeed_mps = 5.0;    // An ego that starts goes no faster within the horizon.

Eigen::Vector2d Turned(const Eigen::Vector2d& v, double by_rad) {
  // Short steps: a second-order rotation, brought back to length one.
  const double c = 1.0 - 0.5 * by_rad * by_rad;
  const Eigen::Vector2d turned(c * v.x() - by_rad * v.y(), by_rad * v.x() + c * v.y());
  return turned * (1.5 - 0.5 * turned.squaredNorm());  // One Newton step of 1 / norm.
}

bool HasGapAlong(const Eigen::Vector2d& axis, const Eigen::Vector2d& between, const Box& a,
                 const HalfSize& size_a, const Box& b, const HalfSize& size_b) {
  const auto reach = [&axis](const Box& box, const HalfSize& size) {
    const double c = std::abs(axis.dot(box.along));
    const double s = std::abs(axis.x() * box.along.y() - axis.y() * box.along.x());
    return size.length_m * c + size.width_m * s;
  };
  return std::abs(axis.dot(between)) > reach(a, size_a) + reach(b, size_b);
}

// Length along a polyline and the direction there.
PathPlace PlaceOnPolyline(const std::vector<Eigen::Vector2d>& path, const Eigen::Vector2d& p) {
  PathPlace best;
  double best_m2 = -1.0;
  double along_m = 0.0;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const Eigen::Vector2d leg = path[i + 1] - path[i];
    const double length_m = leg.norm();
    if (length_m < 1e-6) continue;
    const Eigen::Vector2d along = leg / length_m;
    const double raw_m = along.dot(p - path[i]);
    const bool is_first = i == 0;
    const bool is_last = i + 2 == path.size();
    const double low_m = is_first ? -1e9 : 0.0;
    const double high_m = is_last ? 1e9 : length_m;
    const double at_m = std::clamp(raw_m, low_m, high_m);
    const Eigen::Vector2d off = p - (path[i] + at_m * along);
    if (best_m2 < 0.0 || off.squaredNorm() < best_m2) {
      best_m2 = off.squaredNorm();
      best.along_m = along_m + at_m;
      best.left_m = along.x() * off.y() - along.y() * off.x();
      best.yaw_rad = std::atan2(along.y(), along.x());
    }
    along_m += length_m;
  }
  return best;
}

Box OnPolyline(const std::vector<Eigen::Vector2d>& path, double at_m) {
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const Eigen::Vector2d leg = path[i + 1] - path[i];
    const double length_m = leg.norm();
    if (length_m < 1e-6) continue;
    if (at_m <= length_m || i + 2 == path.size()) {
      return {path[i] + leg * (at_m / length_m), leg / length_m};
    }
    at_m -= length_m;
  }
  return {path.empty() ? Eigen::Vector2d(at_m, 0.0) : path.front(), {1.0, 0.0}};
}

}  // namespace

bool Touch(const Box& a, const HalfSize& size_a, const Box& b, const HalfSize& size_b) {
  const Eigen::Vector2d between = b.centre - a.centre;
  const double radii_m = size_a.radius_m() + size_b.radius_m();
  if (between.squaredNorm() > radii_m * radii_m) return false;
  const Eigen::Vector2d left_a(-a.along.y(), a.along.x());
  const Eigen::Vector2d left_b(-b.along.y(), b.along.x());
  return !HasGapAlong(a.along, between, a, size_a, b, size_b) &&
         !HasGapAlong(left_a, between, a, size_a, b, size_b) &&
         !HasGapAlong(b.along, between, a, size_a, b, size_b) &&
         !HasGapAlong(left_b, between, a, size_a, b, size_b);
}

void PredictTarget(const StateVector& state, bool keeps_braking, int steps, Motion& motion) {
  motion.resize(static_cast<std::size_t>(steps) + 1);
  Box box{{state[kX], state[kY]}, {std::cos(state[kYaw]), std::sin(state[kYaw])}};
  double speed_mps = state[kSpeed];
  double yaw_rate_radps = std::abs(speed_mps) < 0.5 ? 0.0 : state[kYawRate];
  const double fade = 1.0 - kStep_s / kYawRateFades_s;
  for (int k = 0; k <= steps; ++k) {
    motion[static_cast<std::size_t>(k)] = box;
    const bool accelerates = k * kStep_s < kAccelHolds_s - 1e-9 || keeps_braking;
    const double before_mps = speed_mps;
    if (accelerates && std::abs(speed_mps) >= 0.2) {
      speed_mps += kStep_s * state[kAccel];
      if (before_mps * speed_mps < 0.0) speed_mps = 0.0;
    }
    const double moved_m = 0.5 * kStep_s * (before_mps + speed_mps);
    const double by_rad = speed_mps == 0.0 ? 0.0 : kStep_s * yaw_rate_radps;
    const Eigen::Vector2d middle = Turned(box.along, 0.5 * by_rad);
    box.centre += moved_m * middle;
    box.along = Turned(box.along, by_rad);
    yaw_rate_radps *= fade;
  }
}

TargetLanes::TargetLanes(const std::array<StateVector, kLanes>& states, bool keeps_braking)
    : keeps_braking_(keeps_braking) {
  for (std::size_t i = 0; i < kLanes; ++i) {
    const StateVector& state = states[i];
    x_[i] = state[kX];
    y_[i] = state[kY];
    cos_[i] = std::cos(state[kYaw]);
    sin_[i] = std::sin(state[kYaw]);
    speed_[i] = state[kSpeed];
    yaw_rate_[i] = std::abs(state[kSpeed]) < 0.5 ? 0.0 : state[kYawRate];
    accel_[i] = state[kAccel];
  }
}

void TargetLanes::Step() {
  constexpr double kFade = 1.0 - kStep_s / kYawRateFades_s;
  const bool accelerates = steps_ * kStep_s < kAccelHolds_s - 1e-9 || keeps_braking_;
  ++steps_;
  // No branch inside, so that lanes go together; operations and order are PredictTarget's.
  for (std::size_t i = 0; i < kLanes; ++i) {
    const double before_mps = speed_[i];
    double speed_mps = before_mps + kStep_s * accel_[i];
    speed_mps = before_mps * speed_mps < 0.0 ? 0.0 : speed_mps;
    speed_mps = accelerates && std::abs(before_mps) >= 0.2 ? speed_mps : before_mps;
    const double moved_m = 0.5 * kStep_s * (before_mps + speed_mps);
    const double by_rad = speed_mps == 0.0 ? 0.0 : kStep_s * yaw_rate_[i];
    const double half_rad = 0.5 * by_rad;
    const double c_half = 1.0 - 0.5 * half_rad * half_rad;
    const double middle_x = c_half * cos_[i] - half_rad * sin_[i];
    const double middle_y = half_rad * cos_[i] + c_half * sin_[i];
    const double middle_n = 1.5 - 0.5 * (middle_x * middle_x + middle_y * middle_y);
    x_[i] += moved_m * (middle_x * middle_n);
    y_[i] += moved_m * (middle_y * middle_n);
    const double c = 1.0 - 0.5 * by_rad * by_rad;
    const double turned_x = c * cos_[i] - by_rad * sin_[i];
    const double turned_y = by_rad * cos_[i] + c * sin_[i];
    const double n = 1.5 - 0.5 * (turned_x * turned_x + turned_y * turned_y);
    cos_[i] = turned_x * n;
    sin_[i] = turned_y * n;
    speed_[i] = speed_mps;
    yaw_rate_[i] *= kFade;
  }
}

double TargetLanes::FurthestIn(double time_s) const {
  const double accelerates_s =
      keeps_braking_ ? time_s : std::clamp(kAccelHolds_s - steps_ * kStep_s, 0.0, time_s);
  double furthest_m = 0.0;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const double speed_mps = std::abs(speed_[i]) + std::abs(accel_[i]) * accelerates_s;
    furthest_m = std::max(furthest_m, speed_mps * time_s);
  }
  return furthest_m;
}

void PredictEgo(const EgoPlan& plan, const EgoBody& body, int steps, Motion& motion) {
  motion.resize(static_cast<std::size_t>(steps) + 1);
  Box axle{{0.0, 0.0}, {1.0, 0.0}};
  double speed_mps = plan.speed_mps;
  double along_m = 0.0;
  double turned_rad = 0.0;
  for (int k = 0; k <= steps; ++k) {
    const double t_s = k * kStep_s;
    motion[static_cast<std::size_t>(k)] = {axle.centre + body.centre_x_m * axle.along, axle.along};
    const double before_mps = speed_mps;
    if (plan.starts) {
      speed_mps =
          std::max(speed_mps, std::min(kStartSpeed_mps, speed_mps + kStep_s * plan.accel_mps2));
    } else if (plan.accel_mps2 < 0.0 || t_s < kAccelHolds_s - 1e-9) {
      speed_mps += kStep_s * plan.accel_mps2;
      if (before_mps * speed_mps < 0.0 || (before_mps == 0.0 && plan.accel_mps2 < 0.0)) {
        speed_mps = 0.0;
      }
    }
    const double moved_m = 0.5 * kStep_s * (before_mps + speed_mps);
    along_m += moved_m;
    if (plan.path_B.size() >= 2) {
      axle = OnPolyline(plan.path_B, along_m);
      continue;
    }
    const bool has_begun = plan.turn_after_s >= 0.0 && t_s >= plan.turn_after_s - 1e-9;
    double curvature = has_begun ? plan.turn_curvature_per_m : plan.curvature_per_m;
    if (std::abs(turned_rad) > kLargestTurn_rad) curvature = 0.0;
    const double by_rad = moved_m * curvature;
    turned_rad += by_rad;
    axle.centre += moved_m * Turned(axle.along, 0.5 * by_rad);
    axle.along = Turned(axle.along, by_rad);
  }
}

PathPlace PlaceOnPath(const EgoPlan& plan, const Eigen::Vector2d& p_B) {
  if (plan.path_B.size() >= 2) return PlaceOnPolyline(plan.path_B, p_B);
  const double curvature = plan.curvature_per_m;
  // Behind the car the path is not known better than straight.
  if (std::abs(curvature) < 1e-5 || p_B.x() < 0.0) return {p_B.x(), p_B.y(), 0.0};
  const Eigen::Vector2d centre(0.0, 1.0 / curvature);
  const Eigen::Vector2d from = p_B - centre;
  const double side = curvature > 0.0 ? 1.0 : -1.0;
  const double angle_rad = std::atan2(from.x(), -side * from.y());
  PathPlace place;
  place.along_m = angle_rad / std::abs(curvature);
  place.left_m = side * (1.0 / std::abs(curvature) - from.norm());
  place.yaw_rad = side * angle_rad;
  return place;
}

}  // namespace v2vouch::warnings
