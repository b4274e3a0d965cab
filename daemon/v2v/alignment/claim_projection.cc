// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/check.h"
#include "daemon/v2v/alignment/alignment.h"
#include "daemon/v2v/alignment/flat_earth.h"

namespace v2vouch {
namespace {

constexpr double kLongestAge_s = 3.0;  // Older claims are carried no farther.
constexpr double kStep_s = 0.05;       // Of the integration.
// What a driver may do in the meantime, 1 sigma: along and across.
constexpr double kAlong_mps2 = 1.0;
constexpr double kAcross_mps2 = 0.6;
// Positions are older than their stamps say by a jitter of this size (measured on real senders).
constexpr double kStampJitter_s = 0.03;
// Accuracy of a claim's speed and course (SAE J2945/1 asks for 0.28 m/s and 2 degrees above
// 12.5 m/s; below, the course of a receiver goes with velocity error over speed).
constexpr double kSpeedSigma_mps = 0.2;
constexpr double kCourseSigma_rad = FromDegrees(1.0);
constexpr double kCourseVelocitySigma_mps = 0.2;
constexpr double kWorstCourseSigma_rad = 0.5;

struct Motion {
  Eigen::Vector2d p = Eigen::Vector2d::Zero();
  double yaw_rad = 0.0;
  double speed_mps = 0.0;
};

// Constant turn rate and acceleration. Braking ends at standstill, and a stationary car does not
// turn: a claim's deceleration is no promise to drive backwards.
Motion Advance(Motion m, double accel_mps2, double yaw_rate_radps, double duration_s) {
  const int steps = std::max(1, static_cast<int>(std::ceil(duration_s / kStep_s)));
  const double dt = duration_s / steps;
  for (int i = 0; i < steps; ++i) {
    double next = m.speed_mps + accel_mps2 * dt;
    if (m.speed_mps != 0.0 && next * m.speed_mps < 0.0) next = 0.0;
    const double mean_speed = 0.5 * (m.speed_mps + next);
    const double turn = std::abs(mean_speed) < 0.1 ? 0.0 : yaw_rate_radps * dt;
    const double middle = m.yaw_rad + 0.5 * turn;
    m.p += mean_speed * dt * Eigen::Vector2d(std::cos(middle), std::sin(middle));
    m.yaw_rad += turn;
    m.speed_mps = next;
    if (next == 0.0) break;
  }
  return m;
}

}  // namespace

ClaimInOdometry Alignment::ToOdometry(const Claim& claim, Timestamp at) const {
  V2VOUCH_CHECK(is_ready_);
  const double age = std::clamp(claim.age_s + ToSeconds(at - claim.received), 0.0, kLongestAge_s);
  const Pose<Odometry, LocalEnu> X_OL = X_LO().Inverse();
  const Eigen::Vector2d p_L = Flat(plane_, ToWgs84({claim.p_E}));
  const Eigen::Vector3d course_L = plane_.R_LE() * claim.course_E;

  ClaimInOdometry out;
  out.sender = claim.sender;
  out.stamp = at;
  out.has_course = claim.has_course;
  out.accel_mps2 = claim.accel_mps2;
  out.yaw_rate_radps = claim.yaw_rate_radps;
  out.events = claim.events;

  Motion motion;
  motion.p = (X_OL * Point<LocalEnu>{p_L.x(), p_L.y()}).vector();
  motion.yaw_rad = std::atan2(course_L.y(), course_L.x()) + X_OL.yaw_rad();
  motion.speed_mps = claim.speed_mps;
  if (claim.has_course) {
    motion = Advance(motion, claim.accel_mps2, claim.yaw_rate_radps, age);
  }
  out.p_O = motion.p;
  out.yaw_rad = WrapAngle(motion.yaw_rad);
  out.speed_mps = motion.speed_mps;

  const double speed = std::abs(claim.speed_mps);
  const double course_sigma =
      std::min(kWorstCourseSigma_rad,
               std::hypot(kCourseSigma_rad, kCourseVelocitySigma_mps / std::max(speed, 0.1)));
  const double along =
      std::hypot(kSpeedSigma_mps * age, 0.5 * kAlong_mps2 * age * age, kStampJitter_s * speed);
  const double across =
      std::hypot(std::min(course_sigma, 0.1) * speed * age, 0.5 * kAcross_mps2 * age * age);
  const double white = claim.position_sigma_m * claim.position_sigma_m;
  if (claim.has_course) {
    const Eigen::Vector2d u(std::cos(out.yaw_rad), std::sin(out.yaw_rad));
    const Eigen::Vector2d n(-u.y(), u.x());
    out.noise = white * Eigen::Matrix2d::Identity() + along * along * u * u.transpose() +
                across * across * n * n.transpose();
  } else {
    // Nowhere to carry it to: it may have gone any way at its speed.
    const double any = std::hypot(speed * age, along);
    out.noise = (white + any * any) * Eigen::Matrix2d::Identity();
  }
  const Eigen::Matrix2d R_OL = X_OL.rotation();
  out.alignment = R_OL * CovarianceAt(out.p_O) * R_OL.transpose();
  const double yaw_variance =
      filter_.PoseCovariance()(2, 2) + config_.yaw_floor_rad * config_.yaw_floor_rad;
  out.yaw_sigma_rad = claim.has_course ? std::hypot(course_sigma, std::sqrt(yaw_variance),
                                                    kAcross_mps2 * age / std::max(speed, 1.0))
                                       : kPi;
  out.speed_sigma_mps = std::hypot(kSpeedSigma_mps, kAlong_mps2 * age);
  return out;
}

}  // namespace v2vouch
