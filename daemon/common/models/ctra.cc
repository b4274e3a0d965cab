// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/models/ctra.h"

#include <array>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/check.h"

namespace v2vouch {
namespace {

constexpr double kMaxStep_s = 0.1;  // Of one Euler step of the covariance.
// Sub-steps end here: what follows is no motion any more but a guess of one, see Forget.
constexpr double kMostSteps = 100;
constexpr double kLongest_s = kMostSteps * kMaxStep_s;
// Nothing more is forgotten after eleven days.
constexpr double kForgotten_s = 1e6;
constexpr double kForgetting_s = 10.0;
// What is known of any vehicle, 1 sigma. Its direction: anywhere on the circle, evenly.
constexpr double kAnySpeed_mps = 20.0;
constexpr double kAnyYaw_rad = kPi / 1.7320508075688772;
constexpr double kAnyYawRate_radps = 0.2;
constexpr double kAnyAccel_mps2 = 1.5;
// Half of the yaw dynamics is left at this speed; at 1 m/s four fifths are.
constexpr double kStandstill_mps = 0.5;
// A vehicle that stands stops turning with this time constant.
constexpr double kStandstillDecay_s = 0.5;

// Share of the jerk noise that a standing vehicle keeps: most of them go on standing.
constexpr double kRestingJerk = 0.1;

// Abscissae and weights of three-point Gauss-Legendre quadrature on [0, 1].
constexpr std::array<double, 3> kNode = {0.11270166537925831, 0.5, 0.88729833462074169};
constexpr std::array<double, 3> kWeight = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};

// Share of the yaw dynamics that is alive at speed v: 0 at standstill, 1 when driving.
double Mobility(double speed_mps) {
  const double v2 = speed_mps * speed_mps;
  return v2 / (v2 + kStandstill_mps * kStandstill_mps);
}

// Adds the noise of one step. Jerk drives the chain (path, speed, acceleration) along the
// direction of travel, yaw acceleration the chain (lateral, yaw, yaw rate) across it, slip the
// chain (lateral, yaw).
void AddNoise(const StateVector& x, double dt, const MotionNoise& noise, StateMatrix& P) {
  const double v = x[kSpeed];
  const double yaw = x[kYaw];
  const double dt2 = dt * dt, dt3 = dt2 * dt, dt4 = dt3 * dt, dt5 = dt4 * dt;
  const double ratio = v / noise.lateral_speed_mps;
  const double mobility = Mobility(v);
  const double qj = noise.jerk_psd * (kRestingJerk + (1.0 - kRestingJerk) * mobility);
  const double qw = noise.yaw_accel_psd * mobility / (1.0 + ratio * ratio);
  // A car's centre moves at an angle of lever x curvature to its body; with bounded lateral
  // acceleration curvature falls as 1 / speed^2.
  const double qs = noise.slip_psd * mobility / ((1.0 + ratio * ratio) * (1.0 + ratio * ratio));

  const Eigen::Vector2d along(std::cos(yaw), std::sin(yaw));
  const Eigen::Vector2d across(-along.y(), along.x());
  const double path = qj * dt5 / 20.0;
  const double lateral = v * v * (qw * dt5 / 20.0 + qs * dt3 / 3.0);
  P.topLeftCorner<2, 2>() += path * along * along.transpose() +
                             lateral * across * across.transpose() +
                             noise.position_psd * dt * Eigen::Matrix2d::Identity();
  const auto couple = [&P](int column, const Eigen::Vector2d& covariance) {
    P.block<2, 1>(0, column) += covariance;
    P.block<1, 2>(column, 0) += covariance.transpose();
  };
  couple(kSpeed, qj * dt4 / 8.0 * along);
  couple(kAccel, qj * dt3 / 6.0 * along);
  couple(kYaw, v * (qw * dt4 / 8.0 + qs * dt2 / 2.0) * across);
  couple(kYawRate, v * qw * dt3 / 6.0 * across);
  P(kSpeed, kSpeed) += qj * dt3 / 3.0;
  P(kSpeed, kAccel) += qj * dt2 / 2.0;
  P(kAccel, kSpeed) += qj * dt2 / 2.0;
  P(kAccel, kAccel) += qj * dt;
  P(kYaw, kYaw) += qw * dt3 / 3.0 + qs * dt;
  P(kYaw, kYawRate) += qw * dt2 / 2.0;
  P(kYawRate, kYaw) += qw * dt2 / 2.0;
  P(kYawRate, kYawRate) += qw * dt;
}

// Past the sub-steps a vehicle may have gone anywhere that roads and speeds allow: all but the
// position returns to what is known of any vehicle (Ornstein-Uhlenbeck, one closed step), and the
// position grows uncertain at the speed of traffic.
void Forget(KinematicState& state, double rest_s, StateMatrix* transition) {
  const double t = std::min(rest_s, kForgotten_s);
  const double kept = std::exp(-t / kForgetting_s);
  StateVector phi = StateVector::Constant(kept);
  phi.head<2>().setOnes();
  // The direction has no mean to return to.
  phi[kYaw] = 1.0;
  StateVector any;
  any << kAnySpeed_mps * t, kAnySpeed_mps * t, kAnyYaw_rad, kAnySpeed_mps, kAnyYawRate_radps,
      kAnyAccel_mps2;
  StateVector grown = any.cwiseAbs2();
  grown.tail<4>() *= 1.0 - kept * kept;
  state.mean.head<2>() += state.velocity() * kForgetting_s * (1.0 - kept);
  state.mean = state.mean.cwiseProduct(phi).eval();
  state.covariance = (phi.asDiagonal() * state.covariance * phi.asDiagonal()).eval();
  state.covariance.diagonal() += grown;
  if (transition != nullptr) *transition = phi.asDiagonal() * *transition;
}

// How a vehicle turns: angle turned per unit of s w after time t, with s the mobility.
struct Turning {
  double s, ds;        // Mobility, and its derivative by speed.
  double rate, drate;  // Decay rate, likewise.

  Turning(double v, const MotionNoise& noise) {
    s = Mobility(v);
    const double floor = kStandstill_mps * kStandstill_mps;
    ds = 2.0 * v * floor / ((v * v + floor) * (v * v + floor));
    rate = 1.0 / noise.yaw_rate_decay_s + (1.0 - s) / kStandstillDecay_s;
    drate = -ds / kStandstillDecay_s;
  }
  [[nodiscard]] double Turned(double t) const { return -std::expm1(-rate * t) / rate; }
  /// Derivative by the decay rate.
  [[nodiscard]] double DTurned(double t) const {
    return (t * std::exp(-rate * t) - Turned(t)) / rate;
  }
};

}  // namespace

StateVector CtraStep(const StateVector& x, double dt_s, const MotionNoise& noise,
                     StateMatrix* jacobian) {
  const double v = x[kSpeed];
  const double w = x[kYawRate];
  const double a = x[kAccel];
  const Turning turning(v, noise);
  const double s = turning.s;
  // Speed gained per unit of acceleration after time t.
  const auto gained = [&noise](double t) {
    return -std::expm1(-t / noise.accel_decay_s) * noise.accel_decay_s;
  };

  StateVector next = x;
  if (jacobian != nullptr) jacobian->setIdentity();
  for (std::size_t i = 0; i < kNode.size(); ++i) {
    const double t = kNode[i] * dt_s;
    const double weight = kWeight[i] * dt_s;
    const double e = turning.Turned(t);
    const double g = gained(t);
    const double yaw = x[kYaw] + s * w * e;
    const double c = std::cos(yaw);
    const double n = std::sin(yaw);
    const double speed = v + a * g;
    next[kX] += weight * speed * c;
    next[kY] += weight * speed * n;
    if (jacobian == nullptr) continue;
    StateMatrix& F = *jacobian;
    const double dyaw_dv = w * (turning.ds * e + s * turning.DTurned(t) * turning.drate);
    const double dyaw_dw = s * e;
    F(kX, kYaw) -= weight * speed * n;
    F(kY, kYaw) += weight * speed * c;
    F(kX, kSpeed) += weight * (c - speed * n * dyaw_dv);
    F(kY, kSpeed) += weight * (n + speed * c * dyaw_dv);
    F(kX, kYawRate) -= weight * speed * n * dyaw_dw;
    F(kY, kYawRate) += weight * speed * c * dyaw_dw;
    F(kX, kAccel) += weight * g * c;
    F(kY, kAccel) += weight * g * n;
  }
  const double e = turning.Turned(dt_s);
  const double g = gained(dt_s);
  const double kept = std::exp(-turning.rate * dt_s);
  next[kYaw] = x[kYaw] + s * w * e;
  next[kSpeed] = v + a * g;
  next[kYawRate] = w * kept;
  next[kAccel] = a * std::exp(-dt_s / noise.accel_decay_s);
  if (jacobian != nullptr) {
    StateMatrix& F = *jacobian;
    F(kYaw, kSpeed) = w * (turning.ds * e + s * turning.DTurned(dt_s) * turning.drate);
    F(kYaw, kYawRate) = s * e;
    F(kSpeed, kAccel) = g;
    F(kYawRate, kYawRate) = kept;
    F(kYawRate, kSpeed) = -w * dt_s * turning.drate * kept;
    F(kAccel, kAccel) = std::exp(-dt_s / noise.accel_decay_s);
  }
  return next;
}

void PredictCtra(KinematicState& state, double dt_s, const MotionNoise& noise,
                 StateMatrix* transition) {
  V2VOUCH_CHECK(dt_s >= 0.0);
  if (transition != nullptr) transition->setIdentity();
  if (dt_s == 0.0) return;
  const double near_s = std::min(dt_s, kLongest_s);
  // A little above the limit does not buy a second step: 100 ms stamps jitter by a microsecond.
  const int steps = static_cast<int>(std::ceil(near_s / kMaxStep_s - 1e-3));
  const double dt = near_s / std::max(steps, 1);
  StateMatrix F;
  for (int i = 0; i < std::max(steps, 1); ++i) {
    const StateVector next = CtraStep(state.mean, dt, noise, &F);
    const StateMatrix FP = F.lazyProduct(state.covariance);
    StateMatrix P = FP.lazyProduct(F.transpose());
    AddNoise(state.mean, dt, noise, P);
    state.covariance = 0.5 * (P + P.transpose());
    state.mean = next;
    if (transition != nullptr) *transition = F * *transition;
  }
  if (dt_s > near_s) Forget(state, dt_s - near_s, transition);
  state.mean[kYaw] = WrapAngle(state.mean[kYaw]);
}

}  // namespace v2vouch
