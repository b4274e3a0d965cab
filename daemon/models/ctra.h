// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "daemon/data/track.h"

namespace v2vouch {

/// How much a vehicle's motion may surprise us. Spectral densities of white noise that drives the
/// highest derivative of each chain.
struct MotionNoise {
  double jerk_psd = 1.0;         ///< [m^2/s^5], drives acceleration.
  double yaw_accel_psd = 0.05;   ///< [rad^2/s^3], drives yaw rate.
  double slip_psd = 0.01;        ///< [rad^2/s], direction itself (slip, unmodelled path).
  double accel_decay_s = 3.0;    ///< Acceleration returns to 0 with this time constant (Singer).
  double yaw_rate_decay_s = 3.0; ///< So does the yaw rate.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("jerk_psd", jerk_psd, {.above = 0.0, .at_most = 1e3});
    a.Field("yaw_accel_psd", yaw_accel_psd, {.above = 0.0, .at_most = 1e2});
    a.Field("slip_psd", slip_psd, {.at_least = 0.0, .at_most = 1.0});
    a.Field("accel_decay_s", accel_decay_s, {.above = 0.1, .at_most = 100.0});
    a.Field("yaw_rate_decay_s", yaw_rate_decay_s, {.above = 0.1, .at_most = 100.0});
  }
};

/// Constant turn rate and acceleration with both decaying, over `dt_s` seconds (negative: refused by
/// V2VOUCH_CHECK). Long steps are cut into sub-steps of at most 0.1 s. Direction does not wander at
/// standstill: yaw and yaw-rate noise fade out below 1 m/s, and yaw rate decays there.
/// Source: Schubert, Richter, Wanielik (FUSION 2008), CTRA; decay after Singer (1970).
void PredictCtra(KinematicState& state, double dt_s, const MotionNoise& noise);

/// The mean alone, and the Jacobian where wanted, over one step of at most 0.1 s.
StateVector CtraStep(const StateVector& x, double dt_s, const MotionNoise& noise,
                     StateMatrix* jacobian = nullptr);

}  // namespace v2vouch
