// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/etsi/cam.h"

#include "daemon/obu/octets/bit_reader.h"

namespace v2vouch::obu {
namespace {

constexpr int kMessageIdCam = 2;

int Number(BitReader& reader, int bits, int low, int high, std::string_view where) {
  return static_cast<int>(reader.Whole(bits, low, high, where));
}

void ReadHighFrequency(BitReader& reader, Cam& cam) {
  const auto optional = static_cast<unsigned>(reader.Bits(7));
  cam.heading = Number(reader, 12, 0, 3601, "headingValue");
  reader.Skip(7, "headingConfidence");
  cam.speed = Number(reader, 14, 0, 16383, "speedValue");
  reader.Skip(7, "speedConfidence");
  cam.direction = Number(reader, 2, 0, 2, "driveDirection");
  cam.length = Number(reader, 10, 1, 1023, "vehicleLengthValue");
  reader.Skip(3, "vehicleLengthConfidence");
  cam.width = Number(reader, 6, 1, 62, "vehicleWidth");
  cam.accel_long = Number(reader, 9, -160, 161, "longitudinalAcceleration");
  reader.Skip(7, "longitudinalAcceleration");
  cam.curvature = Number(reader, 11, -1023, 1023, "curvatureValue");
  reader.Skip(3, "curvatureConfidence");
  reader.Skip(1 + 2, "curvatureCalculationMode");
  cam.yaw_rate = Number(reader, 16, -32766, 32767, "yawRateValue");
  reader.Skip(4, "yawRateConfidence");
  if (!reader.ok()) return;

  // What follows is optional, and none of it may cost what was read.
  BitReader rest = reader;
  const auto has = [optional](int index) { return ((optional >> (6 - index)) & 1U) != 0; };
  if (has(0)) rest.Skip(7, "accelerationControl");
  if (has(1)) rest.Skip(4, "lanePosition");
  if (has(2)) {
    const int angle = Number(rest, 10, -511, 512, "steeringWheelAngle");
    rest.Skip(7, "steeringWheelAngle");
    if (rest.ok()) cam.steering_angle = angle;
  }
  if (has(3)) {
    const int lateral = Number(rest, 9, -160, 161, "lateralAcceleration");
    rest.Skip(7, "lateralAcceleration");
    if (rest.ok()) cam.accel_lateral = lateral;
  }
  if (has(4)) {
    const int vertical = Number(rest, 9, -160, 161, "verticalAcceleration");
    rest.Skip(7, "verticalAcceleration");
    if (rest.ok()) cam.accel_vertical = vertical;
  }
}

}  // namespace

bool LooksLikeCam(Bytes bytes) {
  const ByteReader reader(bytes);
  return (reader.Peek() == 1 || reader.Peek() == 2) && reader.Peek(1) == kMessageIdCam;
}

Fault ReadCam(Bytes bytes, Cam& cam) {
  cam = Cam{};
  BitReader reader(bytes);
  cam.protocol_version = static_cast<int>(reader.Bits(8));
  const int message_id = static_cast<int>(reader.Bits(8));
  cam.station_id = static_cast<std::uint32_t>(reader.Bits(32));
  if (!reader.ok()) return {FaultKind::kTruncated, "CAM"};
  if (message_id != kMessageIdCam) return {FaultKind::kNotCam, "messageID", message_id};
  if (cam.protocol_version < 1 || cam.protocol_version > 2) {
    return {FaultKind::kUnsupported, "CAM version", cam.protocol_version};
  }
  cam.generation_delta_time = Number(reader, 16, 0, 65535, "generationDeltaTime");
  reader.Skip(3, "camParameters");  // Extension, low frequency, special vehicle.
  reader.Flag();                    // Extension bit of the basic container.
  cam.station_type = Number(reader, 8, 0, 255, "stationType");
  cam.latitude = static_cast<std::int32_t>(reader.Whole(31, -900000000, 900000001, "latitude"));
  cam.longitude = static_cast<std::int32_t>(reader.Whole(32, -1800000000, 1800000001, "longitude"));
  cam.semi_major = Number(reader, 12, 0, 4095, "semiMajorConfidence");
  cam.semi_minor = Number(reader, 12, 0, 4095, "semiMinorConfidence");
  cam.orientation = Number(reader, 12, 0, 3601, "semiMajorOrientation");
  cam.altitude = Number(reader, 20, -100000, 800001, "altitudeValue");
  reader.Skip(4, "altitudeConfidence");
  const bool is_other_container = reader.Flag();  // A choice added later.
  const bool is_road_side = reader.Flag();
  if (!reader.ok()) return reader.fault();
  if (is_other_container || is_road_side || cam.station_type == kStationRoadSide ||
      cam.station_type == kStationPedestrian || cam.station_type == kStationCyclist) {
    return {FaultKind::kNotVehicle, "stationType", cam.station_type};
  }
  ReadHighFrequency(reader, cam);
  return reader.fault();
}

}  // namespace v2vouch::obu
