// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

namespace v2vouch {

inline constexpr double kPi = std::numbers::pi;

constexpr double FromDegrees(double degrees) { return degrees * (kPi / 180.0); }
constexpr double ToDegrees(double radians) { return radians * (180.0 / kPi); }

/// The same direction in (-pi, pi].
inline double WrapAngle(double radians) {
  // Most angles are wrapped already; std::remainder would give them back bit for bit, slowly.
  if (radians > -kPi && radians <= kPi) return radians;
  const double wrapped = std::remainder(radians, 2.0 * kPi);
  return wrapped <= -kPi ? kPi : wrapped;
}

/// The short way from `from` to `to`, in (-pi, pi].
inline double AngleDifference(double to, double from) { return WrapAngle(to - from); }

}  // namespace v2vouch
