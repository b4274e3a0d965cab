// SPDX-License-Identifier: Apache-2.0
#include "daemon/warnings/draws.h"

#include <cmath>
#include <cstdint>

namespace v2vouch::warnings {
namespace {

constexpr int kBits = 32;

struct Polynomial {
  unsigned degree;
  unsigned coefficients;
  std::array<std::uint32_t, 5> first;
};

// Joe and Kuo (2008), new-joe-kuo-6.21201, dimensions 2 to 8.
constexpr std::array<Polynomial, kDrawDimensions - 1> kPolynomials = {{{1, 0, {1}},
                                                                       {2, 1, {1, 3}},
                                                                       {3, 1, {1, 3, 1}},
                                                                       {3, 2, {1, 1, 1}},
                                                                       {4, 1, {1, 1, 3, 3}},
                                                                       {4, 4, {1, 3, 5, 13}},
                                                                       {5, 2, {1, 1, 5, 5, 17}}}};

std::array<std::uint32_t, kBits> Directions(std::size_t dimension) {
  std::array<std::uint32_t, kBits> v{};
  if (dimension == 0) {
    for (int i = 0; i < kBits; ++i) v[static_cast<std::size_t>(i)] = 1u << (kBits - 1 - i);
    return v;
  }
  const Polynomial& p = kPolynomials[dimension - 1];
  for (unsigned i = 0; i < kBits; ++i) {
    if (i < p.degree) {
      v[i] = p.first[i] << (kBits - 1 - i);
      continue;
    }
    v[i] = v[i - p.degree] ^ (v[i - p.degree] >> p.degree);
    for (unsigned k = 1; k < p.degree; ++k) {
      if (((p.coefficients >> (p.degree - 1 - k)) & 1u) != 0) v[i] ^= v[i - k];
    }
  }
  return v;
}

std::vector<Draw> MakeDraws() {
  std::vector<Draw> draws(kDrawCount);
  for (std::size_t d = 0; d < kDrawDimensions; ++d) {
    const auto directions = Directions(d);
    std::uint32_t x = 0;
    for (std::size_t n = 0; n < kDrawCount; ++n) {
      const double uniform =
          std::ldexp(static_cast<double>(x), -kBits) + 0.5 / static_cast<double>(kDrawCount);
      draws[n][d] = InverseNormal(uniform);
      std::size_t lowest_zero = 0;
      while (((n >> lowest_zero) & 1u) != 0) ++lowest_zero;
      x ^= directions[lowest_zero];  // Gray code order.
    }
  }
  return draws;
}

}  // namespace

double InverseNormal(double p) {
  constexpr double kTail = 0.02425;  // Where Acklam's approximation changes its form.
  if (p > 1.0 - kTail) return -InverseNormal(1.0 - p);
  if (p < kTail) {
    const double q = std::sqrt(-2.0 * std::log(p));
    return (((((-7.784894002430293e-03 * q - 3.223964580411365e-01) * q - 2.400758277161838) * q -
              2.549732539343734) *
                 q +
             4.374664141464968) *
                q +
            2.938163982698783) /
           ((((7.784695709041462e-03 * q + 3.224671290700398e-01) * q + 2.445134137142996) * q +
             3.754408661907416) *
                q +
            1.0);
  }
  const double q = p - 0.5;
  const double r = q * q;
  return (((((-3.969683028665376e+01 * r + 2.209460984245205e+02) * r - 2.759285104469687e+02) * r +
            1.383577518672690e+02) *
               r -
           3.066479806614716e+01) *
              r +
          2.506628277459239) *
         q /
         (((((-5.447609879822406e+01 * r + 1.615858368580409e+02) * r - 1.556989798598866e+02) * r +
            6.680131188771972e+01) *
               r -
           1.328068155288572e+01) *
              r +
          1.0);
}

const std::vector<Draw>& NormalDraws() {
  static const std::vector<Draw> draws = MakeDraws();
  return draws;
}

}  // namespace v2vouch::warnings
