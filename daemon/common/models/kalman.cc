// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/models/kalman.h"

#include "daemon/common/base/angle.h"

namespace v2vouch {

Linearized LinearizePosition(const StateVector& x, const Eigen::Vector2d& p_O,
                             const Eigen::Matrix2d& noise) {
  Linearized out;
  out.y = p_O - x.head<2>();
  out.H.setZero(2, kStateSize);
  out.H(0, kX) = 1.0;
  out.H(1, kY) = 1.0;
  out.R = noise;
  out.E.setZero(2, 2);
  return out;
}

bool UpdateWith(const Linearized& measurement, KinematicState& state) {
  if (!JosephUpdate<kStateSize>(measurement.y, measurement.H, measurement.R, state.mean,
                                state.covariance)) {
    return false;
  }
  state.mean[kYaw] = WrapAngle(state.mean[kYaw]);
  return true;
}

std::optional<Likelihood> Evaluate(const Linearized& measurement, const StateMatrix& covariance) {
  return EvaluateInnovation<kStateSize>(measurement.y, measurement.H, measurement.R, covariance);
}

}  // namespace v2vouch
