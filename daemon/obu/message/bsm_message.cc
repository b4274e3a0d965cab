// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/message/bsm_message.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "daemon/obu/etsi/cam_to_bsm.h"
#include "daemon/obu/ieee1609/dot2_time.h"

namespace v2vouch::obu {
namespace {

void SetCore(const BsmCore& core, bsm_t& message) {
  message.msgCnt = static_cast<std::int16_t>(core.msg_count);
  for (int i = 0; i < 4; ++i) message.id[i] = static_cast<std::uint8_t>(core.id >> (24 - 8 * i));
  message.secMark = core.sec_mark;
  message.lat = core.lat;
  message.long_ = core.lon;
  message.elev = core.elev;
  message.semiMajor = static_cast<std::int16_t>(core.semi_major);
  message.semiMinor = static_cast<std::int16_t>(core.semi_minor);
  message.orientation = core.orientation;
  message.transmission = static_cast<std::int8_t>(core.transmission);
  message.speed = static_cast<std::int16_t>(core.speed);
  message.heading = core.heading;
  message.angle = static_cast<std::int16_t>(core.angle);
  message.accelSet_long = static_cast<std::int16_t>(core.accel_long);
  message.accelSet_lat = static_cast<std::int16_t>(core.accel_lat);
  message.accelSet_vert = static_cast<std::int16_t>(core.accel_vert);
  message.accelSet_yaw = core.accel_yaw;
  message.wheelBrakes = static_cast<std::int8_t>(core.wheel_brakes);
  message.traction = static_cast<std::int8_t>(core.traction);
  message.abs = static_cast<std::int8_t>(core.abs);
  message.scs = static_cast<std::int8_t>(core.scs);
  message.brakeBoost = static_cast<std::int8_t>(core.brake_boost);
  message.auxBrakes = static_cast<std::int8_t>(core.aux_brakes);
  message.width = static_cast<std::int16_t>(core.width);
  message.length = static_cast<std::int16_t>(core.length);
}

}  // namespace

int CamCounts::CountOf(const Cam& cam) {
  auto [found, is_new] = stations_.try_emplace(cam.station_id);
  Station& station = found->second;
  if (!is_new) by_age_.erase(station.heard);
  station.heard = ++heard_;
  by_age_[station.heard] = cam.station_id;
  if (station.delta_time != cam.generation_delta_time) {
    if (!is_new) station.count = (station.count + 1) % 128;
    station.delta_time = cam.generation_delta_time;
  }
  const int count = station.count;
  if (stations_.size() > kMostStations) {
    stations_.erase(by_age_.begin()->second);
    by_age_.erase(by_age_.begin());
  }
  return count;
}

bsm_t BsmMessage(const Datagram& datagram, const Reception& reception) {
  bsm_t message{};
  message.rx_utime = reception.rx_utime;
  message.seq = reception.seq;
  std::optional<std::int64_t> time;  // Near the time of the message, best known first.
  if (reception.rx_utime != 0) time = reception.rx_utime;
  if (datagram.dot2 && datagram.dot2->generation_us) {
    message.generation_utime = UtcOfDot2Micros(*datagram.dot2->generation_us);
    if (message.generation_utime != 0) time = message.generation_utime;
  }
  if (datagram.bsm) SetCore(datagram.bsm->core, message);
  if (!datagram.bsm && datagram.cam) {
    SetCore(CoreOfCam(*datagram.cam, time), message);
    message.msgCnt = static_cast<std::int16_t>(reception.cam_count);
  }
  message.signature_state = reception.signature_state;
  std::copy(reception.digest.begin(), reception.digest.end(), message.certificate_digest);
  const auto rssi = datagram.rssi_dbm();
  message.rssi_dbm = rssi ? static_cast<float>(*rssi) : std::numeric_limits<float>::quiet_NaN();
  return message;
}

}  // namespace v2vouch::obu
