// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/data/input.h"
#include "daemon/common/geodesy/ecef.h"
#include "daemon/v2v/intake/intake.h"

namespace v2vouch {

inline const Wgs84 kCrossroads{FromDegrees(42.3), FromDegrees(-83.7), 250.0};
inline constexpr std::int64_t kNoon_us = 1'700'000'040'000'000;  // A whole UTC minute.

/// The ego stands at the crossroads, looking east.
inline EgoPlace EgoAtCrossroads() {
  EgoPlace ego;
  ego.p_E = ToEcef(kCrossroads).p_E;
  ego.course_E = EastNorthUp(kCrossroads).col(0);
  ego.is_known = true;
  return ego;
}

/// A vehicle that drives straight on and sends BSMs as an honest one does.
struct TalkingCar {
  SenderId id = 0x11223344;
  double east_m = 60.0;
  double north_m = -20.0;
  double yaw_rad = 0.0;  ///< Of its x axis, from east.
  double speed_mps = 10.0;
  double latency_s = 0.1;
  double time_s = 0.0;  ///< Since kNoon_us.
  int msg_count = 0;

  void Drive(double dt_s) {
    east_m += speed_mps * dt_s * std::cos(yaw_rad);
    north_m += speed_mps * dt_s * std::sin(yaw_rad);
    time_s += dt_s;
    msg_count = (msg_count + 1) % 128;
  }

  /// What is received `latency_s` after now.
  [[nodiscard]] Bsm Say() const {
    const Wgs84 place = LocalPlane(kCrossroads).ToGeodetic(LocalPoint{{east_m, north_m, 0.0}});
    Bsm bsm;
    bsm.stamp = FromMicros(kNoon_us) + FromSeconds(time_s + latency_s);
    bsm.sender = id;
    bsm.msg_count = msg_count;
    bsm.sec_mark_ms = static_cast<int>(std::lround(time_s * 1000.0)) % 60000;
    bsm.latitude_rad = place.latitude_rad;
    bsm.longitude_rad = place.longitude_rad;
    bsm.elevation_m = place.height_m;
    bsm.semi_major_m = 1.0;
    bsm.transmission = Transmission::kForward;
    bsm.speed_mps = std::abs(speed_mps);
    bsm.course_rad = yaw_rad;
    bsm.length_m = 4.6;
    bsm.width_m = 1.8;
    return bsm;
  }
};

/// The reason of a refusal, or kCount where the message was taken.
inline Reason WhyNot(const Result<Claim>& result) {
  return result ? Reason::kCount : result.reason();
}
inline constexpr Reason kTaken = Reason::kCount;

}  // namespace v2vouch
