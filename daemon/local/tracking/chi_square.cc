// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/chi_square.h"

#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/check.h"

namespace v2vouch {
namespace {

// Probability of exceeding x: closed form for each number of degrees, by the recurrence
// Q(x; k + 2) = Q(x; k) + (x / 2)^(k/2) exp(-x / 2) / Gamma(k / 2 + 1).
double Exceeds(double x, int degrees) {
  const bool is_odd = degrees % 2 == 1;
  double q = is_odd ? std::erfc(std::sqrt(0.5 * x)) : std::exp(-0.5 * x);
  for (int k = is_odd ? 1 : 2; k + 2 <= degrees; k += 2) {
    q += std::pow(0.5 * x, 0.5 * k) * std::exp(-0.5 * x) / std::tgamma(0.5 * k + 1.0);
  }
  return q;
}

}  // namespace

double ChiSquareQuantile(double probability, int degrees) {
  V2VOUCH_CHECK(probability > 0.0 && probability < 1.0 && degrees >= 1 && degrees <= 6);
  double low = 0.0;
  double high = 200.0;
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    (1.0 - Exceeds(middle, degrees) < probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace v2vouch
