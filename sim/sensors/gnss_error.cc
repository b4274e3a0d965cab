// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/gnss_error.h"

#include <cmath>

namespace v2vouch::sim {
namespace {

Vec2 DrawPair(double sigma, Random& random) {
  const double east = random.Normal(0.0, sigma);  // One statement each: arguments have no order.
  const double north = random.Normal(0.0, sigma);
  return {east, north};
}

}  // namespace

GaussMarkov::GaussMarkov(double sigma, double time_constant_s, Random& random)
    : sigma_(sigma), time_constant_s_(time_constant_s), value_(random.Normal(0.0, sigma)) {}

double GaussMarkov::Step(double dt_s, Random& random) {
  const double kept = std::exp(-dt_s / time_constant_s_);
  value_ = value_ * kept + sigma_ * std::sqrt(1.0 - kept * kept) * random.Normal();
  return value_;
}

GnssError::GnssError(const GnssErrorSpec& spec, double scale, const Random& random)
    : random_(random),
      white_sigma_m_(scale * spec.white_sigma_m),
      bias_(DrawPair(scale * spec.bias_sigma_m, random_)),
      height_bias_m_(scale * spec.height_sigma_m * random_.Normal()),
      east_(scale * spec.markov_sigma_m, spec.markov_time_s, random_),
      north_(scale * spec.markov_sigma_m, spec.markov_time_s, random_) {}

GnssError::Value GnssError::Step(double dt_s) {
  Value value;
  const double east = east_.Step(dt_s, random_) + random_.Normal(0.0, white_sigma_m_);
  const double north = north_.Step(dt_s, random_) + random_.Normal(0.0, white_sigma_m_);
  value.horizontal = bias_ + Vec2(east, north);
  value.height_m = height_bias_m_ + random_.Normal(0.0, 2.0 * white_sigma_m_);
  return value;
}

}  // namespace v2vouch::sim
