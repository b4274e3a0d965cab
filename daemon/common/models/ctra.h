// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "daemon/common/base/visit.h"
#include "daemon/common/data/track.h"

namespace v2vouch {

/// How much a vehicle's motion may surprise us. Spectral densities of white noise that drives the
/// highest derivative of each chain.
struct MotionNoise {
  double jerk_psd = 2.0;          ///< [m^2/s^5], drives acceleration; a tenth of it at standstill.
  double yaw_accel_psd = 0.05;    ///< [rad^2/s^3], drives yaw rate; see lateral_speed_mps.
  double slip_psd = 0.001;        ///< [rad^2/s], direction itself (slip, unmodelled path).
  double position_psd = 0.002;    ///< [m^2/s], both axes: drift of O, even of standing vehicles.
  double accel_decay_s = 2.0;     ///< Acceleration returns to 0 with this time constant (Singer).
  double yaw_rate_decay_s = 3.0;  ///< So does the yaw rate.
  /// Above this speed the density of yaw noise shrinks as 1 / speed^2: tyres bound the lateral
  /// acceleration speed x yaw rate, not the yaw rate. That of slip shrinks as 1 / speed^4: the
  /// centre's direction differs from the body's by lever x curvature, and curvature is lateral
  /// acceleration / speed^2.
  double lateral_speed_mps = 8.0;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("jerk_psd", jerk_psd, {.above = 0.0, .at_most = 1e3});
    a.Field("yaw_accel_psd", yaw_accel_psd, {.above = 0.0, .at_most = 1e2});
    a.Field("slip_psd", slip_psd, {.at_least = 0.0, .at_most = 1.0});
    a.Field("position_psd", position_psd, {.at_least = 0.0, .at_most = 10.0});
    a.Field("accel_decay_s", accel_decay_s, {.above = 0.1, .at_most = 100.0});
    a.Field("yaw_rate_decay_s", yaw_rate_decay_s, {.above = 0.1, .at_most = 100.0});
    a.Field("lateral_speed_mps", lateral_speed_mps, {.above = 0.5, .at_most = 1e3});
  }
};

/// Constant turn rate and acceleration with both decaying, over `dt_s` seconds (negative: refused
/// by V2VOUCH_CHECK). Long steps are cut into equal sub-steps of at most 0.1 s. Direction does not
/// wander at standstill: yaw and yaw-rate noise fade out below 1 m/s, and yaw rate decays there.
/// Source: Schubert, Richter, Wanielik (FUSION 2008), CTRA; decay after Singer (1970).
/// @param transition product of the sub-steps' Jacobians, where wanted: carries cross-covariances
///   with states that do not move (extent, bias).
void PredictCtra(KinematicState& state, double dt_s, const MotionNoise& noise,
                 StateMatrix* transition = nullptr);

/// The mean alone, and the Jacobian where wanted, over one step of at most 0.1 s. With
/// s(v) = v^2 / (v^2 + (0.5 m/s)^2) taken at the start of the step:
///
///     a' = -a / Ta,   w' = -w (1/Tw + (1 - s) / 0.5 s),   v' = a,   yaw' = s w,
///     x' = v cos yaw, y' = v sin yaw
///
/// All but the position in closed form; the position by three-point Gauss-Legendre quadrature,
/// whose error over 0.1 s is below 1e-9 m for any road vehicle. Yaw is not wrapped.
StateVector CtraStep(const StateVector& x, double dt_s, const MotionNoise& noise,
                     StateMatrix* jacobian = nullptr);

}  // namespace v2vouch
