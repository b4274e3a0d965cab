// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/alignment/alignment_start.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"

namespace v2vouch {
namespace {

constexpr double kMostHeadingSigma_rad = 0.3;  // A vaguer heading gives no direction to start with.
constexpr double kHeadingAgainstCourse_rad = 0.5;
constexpr double kStartSigma_rad = 0.1;
constexpr double kBetweenPlaces_m = 0.5;  // Nearer fixes say nothing of a direction.
constexpr double kLeastWay_m = 5.0;
constexpr double kMostWay_m = 1000.0;  // The odometry's own errors grow: begin anew.
constexpr double kLeastSpeed_mps = 0.5;
// Odometry and receiver must agree on how fast the car is; a receiver that leaves 0 does not.
constexpr double kSpeedDifference_mps = 0.5;
constexpr double kSpeedShare = 0.05;
constexpr double kSigmas = 4.0;

Eigen::Vector2d Turned(double yaw_rad, const Eigen::Vector2d& v) {
  const double c = std::cos(yaw_rad);
  const double s = std::sin(yaw_rad);
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

}  // namespace

std::optional<AlignmentFilter> AlignmentStart::OnFix(const FixInPlane& fix, const EgoState& ego,
                                                     const Eigen::Vector2d& antenna_B,
                                                     double min_course_speed_mps, double jump_m) {
  const auto course = AlignmentFilter::YawFromCourse(fix, antenna_B, ego, min_course_speed_mps);
  if (fix.yaw_L_rad && fix.yaw_sigma_rad <= kMostHeadingSigma_rad) {
    const double yaw = *fix.yaw_L_rad - ego.X_OB.yaw_rad();
    if (!course || std::abs(AngleDifference(yaw, *course)) <= kHeadingAgainstCourse_rad) {
      return AlignmentFilter(fix, yaw, fix.yaw_sigma_rad, antenna_B, ego);
    }
  }
  if (course) {
    return AlignmentFilter(fix, *course, AlignmentFilter::CourseSigma(fix, ego), antenna_B, ego);
  }
  Follow(ego);
  AddVelocity(fix, ego, antenna_B);
  AddPlace(fix, ego, antenna_B, jump_m);
  return Solve(fix, ego, antenna_B);
}

void AlignmentStart::Follow(const EgoState& ego) {
  if (last_) {
    if (AlignmentFilter::IsStanding(ego)) {
      held_rad_ += AngleDifference(ego.X_OB.yaw_rad(), last_->X_OB.yaw_rad());
    }
    body_ += Turned(-held_rad_, ego.X_OB.origin().vector() - last_->X_OB.origin().vector());
  }
  last_ = ego;
}

void AlignmentStart::AddVelocity(const FixInPlane& fix, const EgoState& ego,
                                 const Eigen::Vector2d& antenna_B) {
  if (!fix.v_L || std::abs(ego.speed_mps) < kLeastSpeed_mps) return;
  const Eigen::Vector2d v_O =
      Turned(ego.X_OB.yaw_rad() - held_rad_, AlignmentFilter::AntennaVelocity_B(antenna_B, ego));
  const double speed = v_O.norm();
  const double most = kSpeedDifference_mps + kSpeedShare * speed + kSigmas * fix.velocity_sigma_mps;
  if (std::abs(fix.v_L->norm() - speed) > most || 2.0 * fix.v_L->norm() < speed) return;
  const double dt = timed_ ? ToSeconds(ego.stamp - *timed_) : 0.1;
  timed_ = ego.stamp;
  const double variance =
      fix.velocity_sigma_mps * fix.velocity_sigma_mps * AlignmentFilter::ColourOfVelocities(dt);
  velocity_.Add(v_O, *fix.v_L, 1.0 / variance);
}

void AlignmentStart::AddPlace(const FixInPlane& fix, const EgoState& ego,
                              const Eigen::Vector2d& antenna_B, double jump_m) {
  const double sigma = std::sqrt(0.5 * fix.covariance.trace());
  const Eigen::Vector2d place_O = body_ + Turned(ego.X_OB.yaw_rad() - held_rad_, antenna_B);
  if (places_ == 0) {
    placed_ = ego.stamp;
    return Begin(place_O, fix.p_L, sigma);
  }
  if ((place_O - newest_O_).norm() < kBetweenPlaces_m) return;
  const double way_O = (place_O - first_O_).norm();
  const double way_L = (fix.p_L - first_L_).norm();
  const double most = jump_m + kSigmas * std::hypot(sigma, sigma_m_);
  const double dt = ToSeconds(ego.stamp - placed_);
  if (std::abs(way_O - way_L) > most) {
    if (++misfits_ >= places_) {
      placed_ = ego.stamp;
      Begin(place_O, fix.p_L, sigma);
    }
    return;
  }
  if (way_O > kMostWay_m) return Begin(place_O, fix.p_L, sigma);
  newest_O_ = place_O;
  placed_ = ego.stamp;
  sigma_m_ = std::max(sigma_m_, sigma);
  colour_ = std::max(colour_, AlignmentFilter::ColourOfPositions(dt));
  ++places_;
  const Eigen::Vector2d from_mean_O = place_O - mean_O_;
  const Eigen::Vector2d from_mean_L = fix.p_L - mean_L_;
  mean_O_ += from_mean_O / places_;
  mean_L_ += from_mean_L / places_;
  way_.Add(from_mean_O, from_mean_L, static_cast<double>(places_ - 1) / places_);
}

void AlignmentStart::Begin(const Eigen::Vector2d& place_O, const Eigen::Vector2d& place_L,
                           double sigma_m) {
  places_ = 1;
  misfits_ = 0;
  first_O_ = newest_O_ = mean_O_ = place_O;
  first_L_ = mean_L_ = place_L;
  sigma_m_ = sigma_m;
  colour_ = 1.0;
  way_ = {};
}

std::optional<AlignmentFilter> AlignmentStart::Solve(const FixInPlane& fix, const EgoState& ego,
                                                     const Eigen::Vector2d& antenna_B) const {
  double c = 0.0;
  double s = 0.0;
  double information = 0.0;
  const auto add = [&](const Rotation& rotation, double variance) {
    const double length = std::hypot(rotation.dot, rotation.cross);
    if (length <= 0.0) return;
    c += rotation.dot / length / variance;
    s += rotation.cross / length / variance;
    information += 1.0 / variance;
  };
  if (velocity_.weight > 0.0) add(velocity_, 1.0 / velocity_.weight);
  const double way_m = (newest_O_ - first_O_).norm();
  if (places_ > 2 && way_m >= kLeastWay_m) {
    // Correlated errors hardly average out; the two ends alone are worth this.
    const double ends = 2.0 * sigma_m_ * sigma_m_ / (way_m * way_m);
    add(way_, std::min(sigma_m_ * sigma_m_ * colour_ / way_.weight, ends));
  }
  if (information < 1.0 / (kStartSigma_rad * kStartSigma_rad)) return std::nullopt;
  // Two sources that point apart are no direction.
  if (std::hypot(c, s) < 0.9 * information) return std::nullopt;
  return AlignmentFilter(fix, std::atan2(s, c) - held_rad_, 1.0 / std::sqrt(information), antenna_B,
                         ego);
}

}  // namespace v2vouch
