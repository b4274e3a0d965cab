// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "daemon/v2v/gps_bias/gps_bias_config.h"

/// Least-squares terms that a sender's bias has in every fit of this room, for Ceres.
namespace v2vouch {

/// N unknowns about 0, each with a sigma of its own.
template <int N>
struct PriorTerm {
  std::array<double, static_cast<std::size_t>(N)> sigma;
  template <class T>
  bool operator()(const T* x, T* out) const {
    for (std::size_t i = 0; i < sigma.size(); ++i) out[i] = x[i] / T(sigma[i]);
    return true;
  }
};

/// The same sigma east and north.
inline PriorTerm<2> EastNorth(double sigma_m) { return {{sigma_m, sigma_m}}; }

/// Gauss-Markov wandering, east and north, from one knot to the next.
struct WanderTerm {
  explicit WanderTerm(const GpsBiasConfig& config)
      : keep(std::exp(-config.knot_s / config.wander_decay_s)),
        sigma(config.wander_sigma_m * std::sqrt(1.0 - keep * keep)) {}

  double keep;
  double sigma;
  template <class T>
  bool operator()(const T* from, const T* to, T* out) const {
    for (int i = 0; i < 2; ++i) out[i] = (to[i] - T(keep) * from[i]) / T(sigma);
    return true;
  }
};

}  // namespace v2vouch
