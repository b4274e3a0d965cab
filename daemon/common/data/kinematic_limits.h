// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace v2vouch {

/// What no road vehicle exceeds: one answer for all checks and models. ETSI TS 103 759 names the
/// observations (speed and acceleration too large) and leaves the limits to the implementer.
///
/// 252 km/h: series cars are limited to 250.
inline constexpr double kMostRoadSpeed_mps = 70.0;
/// Along the vehicle, either way. Tyres on dry asphalt transmit 10 to 11 m/s^2; the rest is noise
/// and slope.
inline constexpr double kMostRoadAccel_mps2 = 12.0;
/// Across it: sports tyres reach 9 m/s^2 on level ground.
inline constexpr double kMostLateralAccel_mps2 = 9.0;

}  // namespace v2vouch
