// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/message.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sim/sensors/bsm.h"

namespace v2vouch::sim {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// All that SAE J2735 lets be unavailable, is.
void MakeSparse(bsm_t& bsm) {
  bsm.elev = -4096;
  bsm.semiMajor = 255;
  bsm.semiMinor = 255;
  bsm.orientation = 65535;
  bsm.transmission = 7;
  bsm.angle = 127;
  bsm.accelSet_long = 2001;
  bsm.accelSet_lat = 2001;
  bsm.accelSet_vert = -127;
  bsm.accelSet_yaw = 0;
  bsm.wheelBrakes = 0b10000;
  bsm.traction = 0;
  bsm.abs = 0;
  bsm.scs = 0;
  bsm.brakeBoost = 0;
  bsm.auxBrakes = 0;
  bsm.width = 0;
  bsm.length = 0;
}

double Unless(bool is_unavailable, double value) { return is_unavailable ? kNan : value; }

}  // namespace

MessageWriter::MessageWriter(const Scenario& scenario)
    : plane_(PlaneOf(scenario.origin)),
      road_height_m_(scenario.origin.height_m),
      start_utime_(static_cast<std::int64_t>(scenario.start_utc_s) * 1000000),
      leap_second_at_s_(scenario.bsm.leap_second_at_s),
      is_sparse_(scenario.bsm.sparse) {}

std::int64_t MessageWriter::Utime(double time_s) const {
  return start_utime_ + std::llround(time_s * 1e6);
}

bsm_t MessageWriter::Encode(const Message& message) const {
  const Statement& said = message.said;
  const GeodeticPlace place = GeodeticOf(plane_, said.centre, said.height_m);
  SenderState state;
  state.position_utime = Utime(message.stamp_s);
  state.latitude_deg = place.latitude_deg;
  state.longitude_deg = place.longitude_deg;
  state.elevation_m = place.height_m;
  state.semi_major_m = said.semi_major_m;
  state.speed_mps = said.speed_mps;
  state.heading_rad = HeadingOf(said.yaw_rad + place.turn_rad);
  state.accel_long_mps2 = said.accel_mps2;
  state.accel_lat_mps2 = said.accel_lat_mps2;
  state.yaw_rate_radps = said.yaw_rate_radps;
  state.length_m = said.length_m;
  state.width_m = said.width_m;
  state.brakes = said.brakes;
  bsm_t bsm{};
  Quantise(state, bsm);
  if (is_sparse_) MakeSparse(bsm);
  // In a leap second J2735 counts on to 60999. The ego's clock has no such second: for its length
  // it runs ahead of the senders' count, then they agree again.
  const double into_leap_s = message.stamp_s - leap_second_at_s_;
  if (leap_second_at_s_ > 0.0 && into_leap_s >= 0.0 && into_leap_s < 1.0) {
    bsm.secMark = 60000 + static_cast<std::int32_t>(into_leap_s * 1000.0);
  }
  bsm.rx_utime = Utime(message.time_s) + std::llround(message.latency_s * 1e6);
  bsm.generation_utime = Utime(message.signed_s) + std::llround(message.signed_after_s * 1e6);
  bsm.msgCnt = static_cast<std::int16_t>(message.msg_count % 128);
  std::copy(message.identity.id.begin(), message.identity.id.end(), std::begin(bsm.id));
  std::copy(message.identity.certificate.begin(), message.identity.certificate.end(),
            std::begin(bsm.certificate_digest));
  bsm.signature_state = static_cast<std::int8_t>(message.signature_state);
  bsm.rssi_dbm = static_cast<float>(message.rssi_dbm);
  return bsm;
}

truth_bsm_t MessageWriter::Truth(const Message& message, const bsm_t& bsm) const {
  truth_bsm_t truth{};
  truth.utime = bsm.rx_utime;
  truth.seq = bsm.seq;
  std::copy(std::begin(bsm.id), std::end(bsm.id), std::begin(truth.sender_id));
  truth.vehicle_id = message.vehicle;
  truth.device_id = message.device;
  truth.is_attacker = message.is_attacker ? 1 : 0;
  truth.is_attack = message.is_attack ? 1 : 0;
  truth.attack = message.attack;
  truth.age_s = 1e-6 * static_cast<double>(bsm.rx_utime - Utime(message.said.time_s));

  const bool has_place = std::abs(bsm.lat) <= 900000000 && std::abs(bsm.long_) <= 1800000000;
  const double height_m = bsm.elev == -4096 ? road_height_m_ : 0.1 * bsm.elev;
  double up_m = 0.0;
  double turn_rad = 0.0;
  if (has_place) {
    std::vector<double> turn(9);
    plane_.Forward(1e-7 * bsm.lat, 1e-7 * bsm.long_, height_m, truth.claimed_x_m, truth.claimed_y_m,
                   up_m, turn);
    turn_rad = std::atan2(turn[1], turn[0]);  // As in GeodeticOf.
  } else {
    truth.claimed_x_m = kNan;
    truth.claimed_y_m = kNan;
  }
  truth.claimed_yaw_rad = Unless(bsm.heading >= 28800,
                                 WrapAngle(kPi / 2 - FromDegrees(0.0125 * bsm.heading) - turn_rad));
  truth.claimed_speed_mps =
      Unless(bsm.speed > 8190, (bsm.transmission == 3 ? -0.02 : 0.02) * bsm.speed);
  truth.claimed_accel_mps2 = Unless(bsm.accelSet_long > 2000, 0.01 * bsm.accelSet_long);
  truth.claimed_length_m = Unless(bsm.length == 0, 0.01 * bsm.length);
  truth.claimed_width_m = Unless(bsm.width == 0, 0.01 * bsm.width);

  const Statement nothing{kNan, {kNan, kNan}, kNan, kNan, kNan, kNan, kNan, kNan, kNan, kNan, kNan};
  const Statement& honest = message.honest ? *message.honest : nothing;
  truth.honest_x_m = honest.centre.x();
  truth.honest_y_m = honest.centre.y();
  truth.honest_yaw_rad = message.honest ? WrapAngle(honest.yaw_rad) : kNan;
  truth.honest_speed_mps = honest.speed_mps;
  truth.honest_accel_mps2 = honest.accel_mps2;
  truth.honest_length_m = honest.length_m;
  truth.honest_width_m = honest.width_m;
  return truth;
}

}  // namespace v2vouch::sim
