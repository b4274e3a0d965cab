// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/etsi/cam.h"

#include <gtest/gtest.h>

#include "daemon/obu/framing/datagram.h"
#include "daemon/obu/octets/bit_writer.h"
#include "tests/support/obu_wrap.h"

namespace v2vouch::obu {
namespace {

Octets HexFile(const char* name) {
  const Octets text = ObuFile(name);
  return FromHex(std::string(text.begin(), text.end()));
}

// Expected: rasn (Rust) and tshark 4.0.17, cam_radiotap_frame.expected.json.
TEST(ReadCam, CapturedFrameHasTheValuesThatTwoOtherDecodersFind) {
  V2VOUCH_NEEDS_OBU_DATA();
  const Octets bytes = HexFile("etsi/cam_radiotap_frame.hex");
  Octets scratch(kLongestDatagram);
  Datagram datagram;
  ReadDatagram(bytes, {}, scratch, datagram);
  ASSERT_FALSE(datagram.fault) << FaultText(datagram.fault);
  EXPECT_EQ(datagram.trailing, 4u);  // Check sequence.
  EXPECT_EQ(*datagram.layers.begin(), Layer::kRadiotap);
  ASSERT_TRUE(datagram.geo);
  EXPECT_EQ(datagram.geo->timestamp_ms, 1151018751u);
  EXPECT_EQ(datagram.geo->timestamp_ms % 65536, 9983u);
  ASSERT_TRUE(datagram.cam);
  const Cam& cam = *datagram.cam;
  EXPECT_EQ(cam.station_id, 2624309139u);
  EXPECT_EQ(cam.generation_delta_time, 9983);
  EXPECT_EQ(cam.station_type, 5);
  EXPECT_EQ(cam.latitude, 535505166);
  EXPECT_EQ(cam.longitude, 99353789);
  EXPECT_EQ(cam.semi_major, 195);
  EXPECT_EQ(cam.semi_minor, 195);
  EXPECT_EQ(cam.orientation, 0);
  EXPECT_EQ(cam.altitude, 12230);
  EXPECT_EQ(cam.heading, 724);
  EXPECT_EQ(cam.speed, 11);
  EXPECT_EQ(cam.direction, 2);
  EXPECT_EQ(cam.length, 42);
  EXPECT_EQ(cam.width, 18);
  EXPECT_EQ(cam.accel_long, -1);
  EXPECT_EQ(cam.curvature, 0);
  EXPECT_EQ(cam.yaw_rate, 0);
  EXPECT_EQ(cam.accel_lateral, 0);
  EXPECT_EQ(cam.steering_angle, 512);
}

// Expected: pycrate, cam_long.expected.asn.
TEST(ReadCam, LongMessageHasTheValuesThatPycrateFinds) {
  V2VOUCH_NEEDS_OBU_DATA();
  const Octets bytes = HexFile("etsi/cam_long.uper.hex");
  Cam cam;
  ASSERT_FALSE(ReadCam(bytes, cam));
  EXPECT_EQ(cam.station_id, 3725855973u);
  EXPECT_EQ(cam.generation_delta_time, 51136);
  EXPECT_EQ(cam.latitude, 535626518);
  EXPECT_EQ(cam.longitude, 99761485);
  EXPECT_EQ(cam.semi_major, 316);
  EXPECT_EQ(cam.semi_minor, 314);
  EXPECT_EQ(cam.orientation, 1507);
  EXPECT_EQ(cam.altitude, 6450);
  EXPECT_EQ(cam.heading, 1994);
  EXPECT_EQ(cam.speed, 1277);
  EXPECT_EQ(cam.direction, 0);
  EXPECT_EQ(cam.length, 42);
  EXPECT_EQ(cam.width, 18);
  EXPECT_EQ(cam.accel_long, 5);
  EXPECT_EQ(cam.yaw_rate, 8);
  EXPECT_EQ(cam.steering_angle, 0);
  EXPECT_EQ(cam.accel_lateral, 1);
}

TEST(ReadCam, EveryPrefixThatEndsBeforeTheYawRateIsRefused) {
  V2VOUCH_NEEDS_OBU_DATA();
  const Octets bytes = HexFile("etsi/cam_long.uper.hex");
  for (std::size_t size = 0; size * 8 < 322; ++size) {
    Cam cam;
    EXPECT_TRUE(ReadCam(std::span(bytes).first(size), cam)) << size;
  }
}

TEST(ReadCam, RoadSideUnitsPeopleAndOtherMessagesAreToldApart) {
  V2VOUCH_NEEDS_OBU_DATA();
  Octets bytes = HexFile("etsi/cam_long.uper.hex");
  Cam cam;
  const auto with_type = [&](unsigned type) {
    // Station type: eight bits from bit 68.
    Octets changed = bytes;
    changed[8] = static_cast<std::uint8_t>((changed[8] & 0xF0) | (type >> 4));
    changed[9] = static_cast<std::uint8_t>((changed[9] & 0x0F) | (type << 4));
    return ReadCam(changed, cam);
  };
  EXPECT_FALSE(with_type(5));
  for (const unsigned type : {1u, 2u, 15u}) {
    EXPECT_EQ(with_type(type), (Fault{FaultKind::kNotVehicle, "stationType", type}));
  }
  bytes[1] = 1;  // DENM.
  EXPECT_EQ(ReadCam(bytes, cam), (Fault{FaultKind::kNotCam, "messageID", 1}));
}

}  // namespace
}  // namespace v2vouch::obu
