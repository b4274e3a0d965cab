// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace v2vouch::warnings {

/// Six dimensions of a target's state, two of the ego's motion (speed, yaw rate).
inline constexpr std::size_t kDrawDimensions = 8;
inline constexpr std::size_t kDrawCount = 128;
using Draw = std::array<double, kDrawDimensions>;

/// A fixed quasi-random set from the standard normal distribution: the first 128 points of the
/// Sobol sequence (direction numbers of Joe and Kuo, 2008), each moved to the middle of its cell,
/// through the inverse of the normal distribution. The same on every machine and in every call.
const std::vector<Draw>& NormalDraws();

/// x with P(standard normal < x) = p, for 0 < p < 1 (Acklam's rational approximation, relative
/// error below 1.2e-9).
double InverseNormal(double p);

}  // namespace v2vouch::warnings
