// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/wire/bsm_conversion.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/big_endian.h"
#include "daemon/rim/wire/field_judge.h"

namespace v2vouch::wire {
namespace {

// Turns the raw integers of one message into optional values. A value that J2735 does not define is
// no better than its "unavailable" code, except where nothing is left without it.
class RawFields {
 public:
  explicit RawFields(RefusalTally& unused) : judge_(unused) {}

  std::optional<std::int64_t> Get(std::int64_t raw, std::int64_t low, std::int64_t high,
                                  std::int64_t unavailable, std::string_view field) {
    if (raw == unavailable) return std::nullopt;
    if (raw >= low && raw <= high) return raw;
    judge_.Unused(field);
    return std::nullopt;
  }
  std::optional<double> Scaled(std::int64_t raw, std::int64_t low, std::int64_t high,
                               std::int64_t unavailable, double unit, std::string_view field) {
    const auto value = Get(raw, low, high, unavailable, field);
    if (!value) return std::nullopt;
    return static_cast<double>(*value) * unit;
  }
  void Need(std::int64_t raw, std::int64_t low, std::int64_t high, std::string_view field) {
    judge_.Need(raw >= low && raw <= high, {Reason::kBsmRange, field});
  }
  FieldJudge& judge() { return judge_; }

 private:
  FieldJudge judge_;
};

std::optional<double> YawOfHeading(std::optional<double> degrees_from_north) {
  if (!degrees_from_north) return std::nullopt;
  return WrapAngle(kPi / 2.0 - FromDegrees(*degrees_from_north));
}

std::optional<double> Radians(std::optional<double> degrees) {
  if (!degrees) return std::nullopt;
  return FromDegrees(*degrees);
}

Transmission TransmissionOf(int raw, FieldJudge& judge) {
  if (raw < 0 || raw > 7) judge.Unused("transmission");
  // 4 to 6 are reserved by J2735: allowed on the wire, and nothing is known.
  return raw >= 0 && raw <= 3 ? static_cast<Transmission>(raw) : Transmission::kUnavailable;
}

SignatureState SignatureOf(int raw, FieldJudge& judge) {
  if (raw >= 0 && raw <= 2) return static_cast<SignatureState>(raw);
  judge.Unused("signature_state");
  return SignatureState::kUnknown;
}

// What Part I says beside the motion. J2735 calls more than 0.4 g hard braking
// (VehicleEventFlags); wheelBrakes has a bit for each wheel, and the highest of five for
// "unavailable".
TrackEvents EventsOf(int wheel_brakes, const std::optional<double>& accel_long_mps2) {
  constexpr double kHardBraking_mps2 = 0.4 * 9.80665;
  constexpr int kWheels = 0x0F;
  constexpr int kUnavailable = 0x10;
  TrackEvents events = 0;
  if (accel_long_mps2 && *accel_long_mps2 < -kHardBraking_mps2) events |= kHardBraking;
  const bool is_known = wheel_brakes > 0 && (wheel_brakes & kUnavailable) == 0;
  if (is_known && (wheel_brakes & kWheels) != 0) events |= kBrakeLamps;
  return events;
}

// The same text about this type's own field.
std::string_view RxText(std::string_view fault) {
  if (fault == "utime looks like milliseconds") return "rx_utime looks like milliseconds";
  if (fault == "utime looks like seconds") return "rx_utime looks like seconds";
  if (fault == "utime looks like nanoseconds") return "rx_utime looks like nanoseconds";
  return "rx_utime";
}

}  // namespace

Result<Bsm> FromWire(const bsm_t& message, Timestamp received, RefusalTally& unused) {
  RawFields raw(unused);
  FieldJudge& judge = raw.judge();
  if (const auto fault = TimeFault(message.rx_utime, received); !fault.empty()) {
    judge.Fail({Reason::kOutOfRange, RxText(fault)});
  }
  // Without place and speed there is no claim. 0 N 0 E is what a unit sends that has no place yet.
  raw.Need(message.lat, -900000000, 900000001, "lat");
  raw.Need(message.long_, -1799999999, 1800000001, "long_");
  raw.Need(message.speed, 0, 8191, "speed");
  judge.Need(message.lat != 0 || message.long_ != 0,
             {Reason::kBsmUnavailable, "lat and long_ are 0"});
  if (judge.refusal()) return *judge.refusal();

  Bsm bsm;
  bsm.stamp = FromMicros(message.rx_utime);
  bsm.received = received;
  bsm.seq = SafeSeq(message.seq);
  bsm.sender = BigEndian32(message.id);
  std::copy(std::begin(message.certificate_digest), std::end(message.certificate_digest),
            bsm.certificate.begin());
  bsm.signature = SignatureOf(message.signature_state, judge);
  if (message.generation_utime != 0) {
    // Judged against this message's own reception: both are microseconds UTC of today.
    if (IsTime(message.generation_utime, bsm.stamp)) {
      bsm.generation = FromMicros(message.generation_utime);
    } else {
      judge.Unused("generation_utime");
    }
  }
  if (message.msgCnt < 0 || message.msgCnt > 127) judge.Unused("msgCnt");
  bsm.msg_count = message.msgCnt & 127;
  if (const auto mark = raw.Get(message.secMark, 0, 60999, 65535, "secMark")) {
    bsm.sec_mark_ms = static_cast<int>(*mark);
  }
  bsm.latitude_rad =
      Radians(raw.Scaled(message.lat, -900000000, 900000000, 900000001, 1e-7, "lat"));
  bsm.longitude_rad =
      Radians(raw.Scaled(message.long_, -1799999999, 1800000000, 1800000001, 1e-7, "long_"));
  bsm.elevation_m = raw.Scaled(message.elev, -4095, 61439, -4096, 0.1, "elev");
  bsm.semi_major_m = raw.Scaled(message.semiMajor, 0, 254, 255, 0.05, "semiMajor");
  bsm.semi_minor_m = raw.Scaled(message.semiMinor, 0, 254, 255, 0.05, "semiMinor");
  bsm.semi_major_yaw_rad = YawOfHeading(
      raw.Scaled(message.orientation, 0, 65534, 65535, 360.0 / 65535.0, "orientation"));
  bsm.transmission = TransmissionOf(message.transmission, judge);
  bsm.speed_mps = raw.Scaled(message.speed, 0, 8190, 8191, 0.02, "speed");
  bsm.course_rad = YawOfHeading(raw.Scaled(message.heading, 0, 28799, 28800, 0.0125, "heading"));
  bsm.accel_long_mps2 = raw.Scaled(message.accelSet_long, -2000, 2000, 2001, 0.01, "accelSet_long");
  bsm.accel_lat_mps2 = raw.Scaled(message.accelSet_lat, -2000, 2000, 2001, 0.01, "accelSet_lat");
  // J2735 has no code for "unavailable" here; senders without a gyro report 0.
  bsm.yaw_rate_radps =
      Radians(raw.Scaled(message.accelSet_yaw, -32767, 32767, 0, -0.01, "accelSet_yaw"));
  bsm.length_m = raw.Scaled(message.length, 1, 4095, 0, 0.01, "length");
  bsm.width_m = raw.Scaled(message.width, 1, 1023, 0, 0.01, "width");
  bsm.events = EventsOf(message.wheelBrakes, bsm.accel_long_mps2);
  if (std::isinf(message.rssi_dbm)) judge.Unused("rssi_dbm");
  bsm.rssi_dbm = std::isfinite(message.rssi_dbm) ? static_cast<double>(message.rssi_dbm) : kNaN;
  return bsm;
}

}  // namespace v2vouch::wire
