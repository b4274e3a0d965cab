// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace v2vouch {

/// A value together with its derivatives by N variables (forward differentiation, exact to
/// rounding). A model written once for Dual gives h(x) and its analytic Jacobian; no second
/// formula can disagree with the first.
template <int N>
struct Dual {
  using Gradient = Eigen::Matrix<double, 1, N>;
  double value = 0.0;
  Gradient gradient = Gradient::Zero();

  Dual() = default;
  Dual(double constant) : value(constant) {}  // NOLINT(google-explicit-constructor): as a number.
  Dual(double v, const Gradient& g) : value(v), gradient(g) {}

  /// The variable of the given index.
  static Dual Variable(double v, int index) {
    Dual result(v);
    result.gradient[index] = 1.0;
    return result;
  }

  friend Dual operator+(const Dual& a, const Dual& b) {
    return {a.value + b.value, a.gradient + b.gradient};
  }
  friend Dual operator-(const Dual& a, const Dual& b) {
    return {a.value - b.value, a.gradient - b.gradient};
  }
  friend Dual operator-(const Dual& a) { return {-a.value, -a.gradient}; }
  friend Dual operator*(const Dual& a, const Dual& b) {
    return {a.value * b.value, b.value * a.gradient + a.value * b.gradient};
  }
  friend Dual operator*(double a, const Dual& b) { return {a * b.value, a * b.gradient}; }
  friend Dual operator/(const Dual& a, const Dual& b) {
    const double inverse = 1.0 / b.value;
    const double quotient = a.value * inverse;
    return {quotient, inverse * (a.gradient - quotient * b.gradient)};
  }
};

template <int N>
Dual<N> sqrt(const Dual<N>& a) {
  const double root = std::sqrt(a.value);
  return {root, (0.5 / root) * a.gradient};
}
template <int N>
Dual<N> cos(const Dual<N>& a) {
  return {std::cos(a.value), -std::sin(a.value) * a.gradient};
}
template <int N>
Dual<N> sin(const Dual<N>& a) {
  return {std::sin(a.value), std::cos(a.value) * a.gradient};
}
template <int N>
Dual<N> atan2(const Dual<N>& y, const Dual<N>& x) {
  const double inverse = 1.0 / (x.value * x.value + y.value * y.value);
  return {std::atan2(y.value, x.value),
          (x.value * inverse) * y.gradient - (y.value * inverse) * x.gradient};
}

}  // namespace v2vouch
