// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/random.h"
#include "daemon/common/data/track.h"
#include "daemon/common/data/vehicle.h"

namespace v2vouch {

/// A vehicle 8 to 80 m from the origin, any direction, forwards and backwards.
inline StateVector RandomState(Random& random) {
  const double bearing = random.Uniform(-kPi, kPi);
  const double range = random.Uniform(8.0, 80.0);
  StateVector x;
  x << range * std::cos(bearing), range * std::sin(bearing), random.Uniform(-kPi, kPi),
      random.Uniform(-5.0, 30.0), random.Uniform(-0.6, 0.6), random.Uniform(-4.0, 4.0);
  return x;
}

/// An ego near the origin that drives and turns.
inline EgoState RandomEgo(Random& random) {
  EgoState ego;
  ego.X_OB = {random.Uniform(-2.0, 2.0), random.Uniform(-2.0, 2.0), random.Uniform(-kPi, kPi)};
  ego.speed_mps = random.Uniform(-2.0, 25.0);
  ego.yaw_rate_radps = random.Uniform(-0.5, 0.5);
  return ego;
}

/// A symmetric positive definite matrix with standard deviations of about `sigma`.
template <int N>
Eigen::Matrix<double, N, N> RandomCovariance(Random& random, double sigma) {
  Eigen::Matrix<double, N, N> root;
  for (Eigen::Index i = 0; i < N * N; ++i) root(i) = random.Normal(0.0, sigma / std::sqrt(N));
  const Eigen::Matrix<double, N, N> P = root * root.transpose();
  return P + 1e-6 * Eigen::Matrix<double, N, N>::Identity();
}

}  // namespace v2vouch
