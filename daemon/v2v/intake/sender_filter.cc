// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/intake/sender_filter.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/data/kinematic_limits.h"
#include "daemon/common/data/motion_continuity.h"
#include "daemon/common/models/ctra.h"

namespace v2vouch {
namespace {

constexpr double kReanchor_m = 2000.0;   // From the plane's origin; 0.3 m of curvature.
constexpr double kMinSigma_m = 0.5;      // No claim is believed better.
constexpr double kPositionAge_s = 0.15;  // See sender_filter.h.
constexpr double kSpeedSigma_mps = 0.3;  // SAE J2945/1: 0.28 m/s.
constexpr double kCourseSigma_rad = FromDegrees(2.0);
constexpr double kCourseVelocitySigma_mps = 0.3;
constexpr double kNoCourseSigma_rad = 1e3;
constexpr double kLongestSilence_s = 2.0;
constexpr double kConsistent4 = 13.28;  // Chi-square, 99 %, 4 and 3 degrees of freedom.
constexpr double kConsistent3 = 11.34;
constexpr double kBroken = 100.0;
constexpr double kNisWindow = 10.0;

struct Measurement {
  Eigen::Vector4d z;  // x, y, yaw, speed in the sender's plane, at reception.
  Eigen::Matrix4d R;
  double up_m = 0.0;
};

Measurement Measure(const LocalPlane& plane, const Claim& claim) {
  const Eigen::Vector3d p_L = plane.ToLocal(EcefPoint{claim.p_E}).p_L;
  const Eigen::Vector3d course_L = plane.R_LE() * claim.course_E;
  const double yaw = claim.has_course ? std::atan2(course_L.y(), course_L.x()) : 0.0;
  const double age = claim.age_s;
  Measurement m;
  m.up_m = p_L.z();
  double way = claim.speed_mps * age + 0.5 * claim.accel_mps2 * age * age;
  if (way * claim.speed_mps <= 0.0) way = 0.0;  // Braking does not end in reverse.
  const double middle = yaw + 0.5 * claim.yaw_rate_radps * age;
  const Eigen::Vector2d u(std::cos(middle), std::sin(middle));
  const double speed = std::abs(claim.speed_mps);
  const double sigma = std::max(kMinSigma_m, claim.position_sigma_m);
  m.R = Eigen::Matrix4d::Zero();
  m.R.topLeftCorner<2, 2>() = sigma * sigma * Eigen::Matrix2d::Identity();
  if (claim.has_course) {
    const double along = kPositionAge_s * speed;
    m.z << p_L.x() + way * u.x(), p_L.y() + way * u.y(), yaw + claim.yaw_rate_radps * age,
        claim.speed_mps;
    m.R.topLeftCorner<2, 2>() += along * along * u * u.transpose();
    const double course_sigma =
        std::hypot(kCourseSigma_rad, kCourseVelocitySigma_mps / std::max(speed, 0.3));
    m.R(2, 2) = course_sigma * course_sigma;
  } else {
    const double any = speed * (age + kPositionAge_s);
    m.z << p_L.x(), p_L.y(), 0.0, claim.speed_mps;
    m.R.topLeftCorner<2, 2>() += any * any * Eigen::Matrix2d::Identity();
    m.R(2, 2) = kNoCourseSigma_rad * kNoCourseSigma_rad;
  }
  m.R(3, 3) = kSpeedSigma_mps * kSpeedSigma_mps;
  return m;
}

void StartMotion(SenderTrack& track, const Claim& claim) {
  track.plane = LocalPlane(ToWgs84({claim.p_E}));
  const Measurement m = Measure(track.plane, claim);
  track.state.mean << m.z(0), m.z(1), WrapAngle(m.z(2)), m.z(3), claim.yaw_rate_radps,
      claim.accel_mps2;
  track.state.covariance.setZero();
  track.state.covariance.topLeftCorner<4, 4>() = m.R;
  if (!claim.has_course) track.state.covariance(kYaw, kYaw) = kPi * kPi / 3.0;
  track.state.covariance(kYawRate, kYawRate) = 0.2 * 0.2;
  track.state.covariance(kAccel, kAccel) = 1.0;
}

// The same motion seen from a plane anchored at the newest claim. Axes turn by less than a
// thousandth of a radian per move, which the covariance does not notice.
void Reanchor(SenderTrack& track, const Claim& claim) {
  const LocalPlane next(ToWgs84({claim.p_E}));
  const double up = track.plane.ToLocal(EcefPoint{claim.p_E}).p_L.z();
  const StateVector& x = track.state.mean;
  const EcefPoint p = track.plane.ToEcefPoint(LocalPoint{{x(kX), x(kY), up}});
  const Eigen::Vector3d direction =
      next.R_LE() *
      (track.plane.R_LE().transpose() * Eigen::Vector3d(std::cos(x(kYaw)), std::sin(x(kYaw)), 0.0));
  const Eigen::Vector3d p_L = next.ToLocal(p).p_L;
  track.state.mean(kX) = p_L.x();
  track.state.mean(kY) = p_L.y();
  track.state.mean(kYaw) = std::atan2(direction.y(), direction.x());
  track.plane = next;
}

void Publish(SenderTrack& track, double up_m) {
  const StateVector& x = track.state.mean;
  track.p_E = track.plane.ToEcefPoint(LocalPoint{{x(kX), x(kY), up_m}}).p_E;
  track.course_E =
      track.plane.R_LE().transpose() * Eigen::Vector3d(std::cos(x(kYaw)), std::sin(x(kYaw)), 0.0);
}

}  // namespace

SenderTrack StartSender(const Bsm& bsm, const Claim& claim) {
  SenderTrack track;
  track.sender = bsm.sender;
  track.latest = claim;
  track.first_received = claim.received;
  track.messages = 1;
  track.msg_count = bsm.msg_count;
  track.clean_run = 1.0;
  StartMotion(track, claim);
  Publish(track, Measure(track.plane, claim).up_m);
  return track;
}

bool AdvanceSender(SenderTrack& track, const Bsm& bsm, const Claim& claim, bool is_reread) {
  const double dt = std::max(0.0, ToSeconds(claim.received - track.latest.received));
  // Half of the counter's circle: more cannot be told from a repeat or a restart of the sender.
  const int missing = ((bsm.msg_count - track.msg_count - 1) % 128 + 128) % 128;
  if (missing < 64) track.lost += static_cast<std::uint64_t>(missing);
  track.msg_count = bsm.msg_count;
  ++track.messages;

  const double displacement = HorizontalDistance(track.latest.p_E, claim.p_E);
  track.latest = claim;
  track.latest_nis.reset();
  bool is_broken =
      dt > kLongestSilence_s || displacement > std::max(kMostRoadSpeed_mps * dt, kRestart_m);
  if (is_reread && !is_broken) {
    StartMotion(track, claim);
  } else if (!is_broken) {
    if (track.state.mean.head<2>().norm() > kReanchor_m) Reanchor(track, claim);
    PredictCtra(track.state, dt, MotionNoise{});
    const Measurement m = Measure(track.plane, claim);
    StateMatrix& P = track.state.covariance;
    Eigen::Vector4d y = m.z - track.state.mean.head<4>();
    y(2) = claim.has_course ? WrapAngle(y(2)) : 0.0;
    const Eigen::Matrix4d S = P.topLeftCorner<4, 4>() + m.R;
    const Eigen::LLT<Eigen::Matrix4d> llt(S);
    if (llt.info() != Eigen::Success) return false;
    const double nis = y.dot(llt.solve(y));
    const double bounded = std::min(nis, kBroken);
    track.latest_nis = nis;
    track.nis_freedom = claim.has_course ? 4 : 3;
    track.nis_mean +=
        (bounded - track.nis_mean) / std::min(kNisWindow, static_cast<double>(track.messages - 1));
    track.clean_run =
        nis < (claim.has_course ? kConsistent4 : kConsistent3) ? track.clean_run + 1.0 : 0.0;
    is_broken = !(nis < kBroken);
    if (!is_broken) {
      const Eigen::Matrix<double, kStateSize, 4> K =
          llt.solve(P.topRows<4>()).transpose();  // P H^T S^-1 with H = [I 0].
      track.state.mean += K * y;
      track.state.mean(kYaw) = WrapAngle(track.state.mean(kYaw));
      StateMatrix I_KH = StateMatrix::Identity();
      I_KH.leftCols<4>() -= K;
      P = I_KH * P * I_KH.transpose() + K * m.R * K.transpose();
    }
  }
  if (is_broken) {
    StartMotion(track, claim);
    track.clean_run = 0.0;
    ++track.resets;
  }
  if (!track.state.mean.allFinite() || !track.state.covariance.allFinite()) return false;
  Publish(track, track.plane.ToLocal(EcefPoint{claim.p_E}).p_L.z());
  return true;
}

}  // namespace v2vouch
