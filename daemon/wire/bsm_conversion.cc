// SPDX-License-Identifier: Apache-2.0
#include "daemon/wire/bsm_conversion.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "daemon/base/angle.h"
#include "daemon/wire/sensor_conversion.h"

namespace v2vouch::wire {
namespace {

bool IsIn(std::int64_t value, std::int64_t low, std::int64_t high) {
  return value >= low && value <= high;
}

// Every field J2735 gives a range, with its "unavailable" code inside.
bool IsDefined(const bsm_t& m) {
  return IsIn(m.msgCnt, 0, 127) && (IsIn(m.secMark, 0, 60999) || m.secMark == 65535) &&
         IsIn(m.lat, -900000000, 900000001) && IsIn(m.long_, -1799999999, 1800000001) &&
         IsIn(m.elev, -4096, 61439) && IsIn(m.semiMajor, 0, 255) && IsIn(m.semiMinor, 0, 255) &&
         IsIn(m.orientation, 0, 65535) && IsIn(m.transmission, 0, 7) && IsIn(m.speed, 0, 8191) &&
         IsIn(m.heading, 0, 28800) && IsIn(m.angle, -126, 127) &&
         IsIn(m.accelSet_long, -2000, 2001) && IsIn(m.accelSet_lat, -2000, 2001) &&
         IsIn(m.accelSet_vert, -127, 127) && IsIn(m.accelSet_yaw, -32767, 32767) &&
         IsIn(m.wheelBrakes, 0, 31) && IsIn(m.traction, 0, 3) && IsIn(m.abs, 0, 3) &&
         IsIn(m.scs, 0, 3) && IsIn(m.brakeBoost, 0, 2) && IsIn(m.auxBrakes, 0, 3) &&
         IsIn(m.width, 0, 1023) && IsIn(m.length, 0, 4095);
}

std::optional<double> Scaled(std::int64_t raw, std::int64_t unavailable, double unit) {
  if (raw == unavailable) return std::nullopt;
  return static_cast<double>(raw) * unit;
}

std::optional<double> YawOfHeading(std::optional<double> degrees_from_north) {
  if (!degrees_from_north) return std::nullopt;
  return WrapAngle(kPi / 2.0 - FromDegrees(*degrees_from_north));
}

std::optional<double> Radians(std::optional<double> degrees) {
  if (!degrees) return std::nullopt;
  return FromDegrees(*degrees);
}

Transmission TransmissionOf(int raw) {
  // 4 to 6 are reserved by J2735: allowed on the wire, and nothing is known.
  return raw <= 3 ? static_cast<Transmission>(raw) : Transmission::kUnavailable;
}

}  // namespace

Result<Bsm> FromWire(const bsm_t& message, Timestamp received) {
  if (!IsPlausibleTime(message.rx_utime) || message.seq < 0) return Reason::kOutOfRange;
  if (message.generation_utime != 0 && !IsPlausibleTime(message.generation_utime)) {
    return Reason::kBsmRange;
  }
  if (!IsIn(message.signature_state, 0, 2)) return Reason::kOutOfRange;
  if (std::isinf(message.rssi_dbm)) return Reason::kNotFinite;
  if (!IsDefined(message)) return Reason::kBsmRange;

  Bsm bsm;
  bsm.stamp = FromMicros(message.rx_utime);
  bsm.received = received;
  bsm.seq = message.seq;
  for (const std::uint8_t octet : message.id) bsm.sender = (bsm.sender << 8) | octet;
  std::copy(std::begin(message.certificate_digest), std::end(message.certificate_digest),
            bsm.certificate.begin());
  bsm.signature = static_cast<SignatureState>(message.signature_state);
  if (message.generation_utime != 0) bsm.generation = FromMicros(message.generation_utime);
  bsm.msg_count = message.msgCnt;
  if (message.secMark != 65535) bsm.sec_mark_ms = message.secMark;
  bsm.latitude_rad = Radians(Scaled(message.lat, 900000001, 1e-7));
  bsm.longitude_rad = Radians(Scaled(message.long_, 1800000001, 1e-7));
  bsm.elevation_m = Scaled(message.elev, -4096, 0.1);
  bsm.semi_major_m = Scaled(message.semiMajor, 255, 0.05);
  bsm.semi_minor_m = Scaled(message.semiMinor, 255, 0.05);
  bsm.semi_major_yaw_rad = YawOfHeading(Scaled(message.orientation, 65535, 360.0 / 65535.0));
  bsm.transmission = TransmissionOf(message.transmission);
  bsm.speed_mps = Scaled(message.speed, 8191, 0.02);
  bsm.course_rad = YawOfHeading(Scaled(message.heading, 28800, 0.0125));
  bsm.accel_long_mps2 = Scaled(message.accelSet_long, 2001, 0.01);
  bsm.accel_lat_mps2 = Scaled(message.accelSet_lat, 2001, 0.01);
  // J2735 has no code for "unavailable" here; senders without a gyro report 0.
  bsm.yaw_rate_radps = Radians(Scaled(message.accelSet_yaw, 0, -0.01));
  bsm.length_m = Scaled(message.length, 0, 0.01);
  bsm.width_m = Scaled(message.width, 0, 0.01);
  bsm.rssi_dbm = static_cast<double>(message.rssi_dbm);
  return bsm;
}

}  // namespace v2vouch::wire
