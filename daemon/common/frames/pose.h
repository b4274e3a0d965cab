// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/frames/frames.h"

namespace v2vouch {

/// A point of the plane, expressed in frame A [m].
template <class A>
struct Point {
  double x_m = 0.0;
  double y_m = 0.0;

  [[nodiscard]] Eigen::Vector2d vector() const { return {x_m, y_m}; }
  friend bool operator==(const Point&, const Point&) = default;
};

/// X_AB: planar pose of frame B in frame A. Only chains whose inner frames match will compile.
///
///     p_AQ = X_AB * p_BQ,   X_AC = X_AB * X_BC
template <class A, class B>
class Pose {
 public:
  Pose() = default;
  Pose(double x_m, double y_m, double yaw_rad)
      : x_m_(x_m), y_m_(y_m), yaw_rad_(WrapAngle(yaw_rad)) {}

  [[nodiscard]] double x_m() const { return x_m_; }
  [[nodiscard]] double y_m() const { return y_m_; }
  [[nodiscard]] double yaw_rad() const { return yaw_rad_; }
  [[nodiscard]] Point<A> origin() const { return {x_m_, y_m_}; }

  /// R_AB: turns a direction expressed in B into A.
  [[nodiscard]] Eigen::Matrix2d rotation() const {
    const double c = std::cos(yaw_rad_);
    const double s = std::sin(yaw_rad_);
    return (Eigen::Matrix2d() << c, -s, s, c).finished();
  }

  [[nodiscard]] Pose<B, A> Inverse() const {
    const double c = std::cos(yaw_rad_);
    const double s = std::sin(yaw_rad_);
    return {-c * x_m_ - s * y_m_, s * x_m_ - c * y_m_, -yaw_rad_};
  }

  friend Point<A> operator*(const Pose& X_AB, const Point<B>& p_BQ) {
    const double c = std::cos(X_AB.yaw_rad_);
    const double s = std::sin(X_AB.yaw_rad_);
    return {X_AB.x_m_ + c * p_BQ.x_m - s * p_BQ.y_m, X_AB.y_m_ + s * p_BQ.x_m + c * p_BQ.y_m};
  }

  template <class C>
  friend Pose<A, C> operator*(const Pose& X_AB, const Pose<B, C>& X_BC) {
    const Point<A> p_AC = X_AB * X_BC.origin();
    return {p_AC.x_m, p_AC.y_m, X_AB.yaw_rad_ + X_BC.yaw_rad()};
  }

  friend bool operator==(const Pose&, const Pose&) = default;

 private:
  double x_m_ = 0.0;
  double y_m_ = 0.0;
  double yaw_rad_ = 0.0;  // (-pi, pi]
};

}  // namespace v2vouch
