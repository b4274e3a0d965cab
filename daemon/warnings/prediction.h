// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "daemon/common/data/track.h"
#include "daemon/warnings/scene.h"
#include "daemon/warnings/warnings_config.h"

namespace v2vouch::warnings {

inline constexpr double kStep_s = 0.1;

/// A box on the ground: centre, unit vector along it.
struct Box {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  Eigen::Vector2d along{1.0, 0.0};
};

struct HalfSize {
  double length_m = 2.3;
  double width_m = 0.9;
  [[nodiscard]] double radius_m() const { return std::hypot(length_m, width_m); }
};

/// Where a body is at 0, kStep_s, 2 kStep_s, ...
using Motion = std::vector<Box>;

/// Whether two boxes touch (separating axes).
bool Touch(const Box& a, const HalfSize& size_a, const Box& b, const HalfSize& size_b);

/// A vehicle at constant acceleration for 1 s, then at constant speed; one that brakes for sure
/// goes on braking. The yaw rate fades with 3 s. Nothing starts to roll backwards.
void PredictTarget(const StateVector& state, bool keeps_braking, int steps, Motion& motion);

/// Eight vehicles side by side, step by step: each goes as by PredictTarget, bit for bit. One
/// vehicle's steps wait for each other; eight do not, and the compiler takes two at a time.
class TargetLanes {
 public:
  static constexpr std::size_t kLanes = 8;
  using Row = std::array<double, kLanes>;

  TargetLanes(const std::array<StateVector, kLanes>& states, bool keeps_braking);
  void Step();
  [[nodiscard]] const Row& x_m() const { return x_; }
  [[nodiscard]] const Row& y_m() const { return y_; }
  [[nodiscard]] Box At(std::size_t lane) const {
    return {{x_[lane], y_[lane]}, {cos_[lane], sin_[lane]}};
  }
  /// No lane gets further than this [m] within `time_s` from now.
  [[nodiscard]] double FurthestIn(double time_s) const;

 private:
  bool keeps_braking_;
  int steps_ = 0;
  alignas(64) Row x_, y_, cos_, sin_, speed_, yaw_rate_, accel_;
};

/// What the ego may do next.
struct EgoPlan {
  double speed_mps = 0.0;
  double accel_mps2 = 0.0;
  double curvature_per_m = 0.0;
  double turn_after_s = -1.0;  ///< Below 0: no turn is begun.
  double turn_curvature_per_m = 0.0;
  bool starts = false;                  ///< From a stop, with `accel_mps2` up to 5 m/s.
  std::vector<Eigen::Vector2d> path_B;  ///< Of the rear axle; empty = curvature counts.
};

/// Motion of the ego's footprint in its body frame now. Braking goes on to a stop, acceleration
/// for 1 s. A curve ends where it has turned the car by 100 degrees.
void PredictEgo(const EgoPlan& plan, const EgoBody& body, int steps, Motion& motion);

/// The line that the ego follows, whatever its speed: for lane offsets.
struct PathPlace {
  double along_m = 0.0;  ///< From the rear axle; negative behind.
  double left_m = 0.0;
  double yaw_rad = 0.0;  ///< Of the path there.
};
PathPlace PlaceOnPath(const EgoPlan& plan, const Eigen::Vector2d& p_B);

}  // namespace v2vouch::warnings
