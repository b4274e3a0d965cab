// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/base/random.h"
#include "sim/world/geometry.h"
#include "sim/world/scenario.h"

namespace v2vouch::sim {

/// First-order Gauss-Markov process, stationary from its first value:
///     x(t + dt) = x(t) exp(-dt / tau) + sigma sqrt(1 - exp(-2 dt / tau)) n
class GaussMarkov {
 public:
  GaussMarkov(double sigma, double time_constant_s, Random& random);
  double Step(double dt_s, Random& random);

 private:
  double sigma_;
  double time_constant_s_;
  double value_;
};

/// Error of one GNSS receiver along east, north and up [m].
class GnssError {
 public:
  /// @param scale multiplies every part.
  GnssError(const GnssErrorSpec& spec, double scale, const Random& random);

  struct Value {
    Vec2 horizontal = Vec2::Zero();
    double height_m = 0.0;
  };
  /// The error `dt_s` after the last call; white part included.
  Value Step(double dt_s);

 private:
  Random random_;
  double white_sigma_m_;
  Vec2 bias_;
  double height_bias_m_;
  GaussMarkov east_, north_;
};

}  // namespace v2vouch::sim
