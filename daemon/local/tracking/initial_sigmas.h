// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace v2vouch {

/// What is open about a vehicle when its filter starts, 1 sigma, whichever measurement starts it.

/// No measurement tells a turn or an acceleration: those of ordinary driving.
inline constexpr double kInitialYawRateSigma_radps = 0.1;
inline constexpr double kInitialAccelSigma_mps2 = 1.5;
/// A reflection lies anywhere on a vehicle: this far from its centre, along each axis.
inline constexpr double kReflectionSigma_m = 1.3;

}  // namespace v2vouch
