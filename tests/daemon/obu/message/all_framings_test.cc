// SPDX-License-Identifier: Apache-2.0
// Every framing round every sample gives one and the same message.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "daemon/obu/message/bsm_message.h"
#include "tests/support/obu_wrap.h"

namespace v2vouch::obu {
namespace {

struct Framed {
  std::string name;
  Octets bytes;
  Layer outermost;
  bool is_text = false;
  std::uint16_t port = 0;
  float rssi_dbm = NAN;
};

// Everything that can lie round a WSMP message or be one.
void AddRadioFramings(const std::string& name, const Octets& wsmp, std::vector<Framed>& framings) {
  const auto add = [&](const char* how, Octets bytes, Layer outermost) -> Framed& {
    return framings.emplace_back(Framed{how + (" " + name), std::move(bytes), outermost});
  };
  const Octets wlan = WrapWlan(WrapLlc(wsmp));
  const Octets check_sequence = {0xDE, 0xAD, 0x00, 0x14};
  add("wsmp", wsmp, Layer::kWsmp);
  add("wsmp and check sequence", Joined(wsmp, check_sequence), Layer::kWsmp);
  add("cv2x", WrapCv2x(wsmp), Layer::kCv2x);
  add("ethernet", WrapEthernet(wsmp), Layer::kEthernet);
  add("ethernet, padded",
      Joined(WrapEthernet(wsmp), Octets(wsmp.size() < 46 ? 46 - wsmp.size() : 0)),
      Layer::kEthernet);
  add("ethernet cv2x", WrapEthernet(WrapCv2x(wsmp)), Layer::kEthernet);
  add("llc", WrapLlc(wsmp), Layer::kLlc);
  add("802.11 qos", wlan, Layer::kWlan);
  add("802.11 data", WrapWlan(WrapLlc(wsmp), false), Layer::kWlan);
  add("802.11 and check sequence", Joined(wlan, check_sequence), Layer::kWlan);
  add("radiotap", WrapRadiotap(wlan, -71), Layer::kRadiotap).rssi_dbm = -71.0F;
  add("c2p 0", WrapC2p(wlan, 0x01, -70, 127), Layer::kC2p).rssi_dbm = -70.0F;
  add("c2p 1", WrapC2p(wlan, 0x11, -90, -80), Layer::kC2p).rssi_dbm = -80.0F;
  add("c2p without signal", WrapC2p(wlan, 0x11, 127, 127), Layer::kC2p);
  Framed& cv2x = add("c2p cv2x", WrapC2pCv2x(wsmp, -65), Layer::kC2p);
  cv2x.rssi_dbm = -65.0F;
  cv2x.port = kPortC2p;
}

std::vector<Framed> AllFramings(const Octets& frame) {
  std::vector<Framed> framings = {
      {"frame", frame, Layer::kFrame},
      {"dot2 unsecured", WrapUnsecured(frame), Layer::kDot2},
      {"dot2 signed", WrapSigned(frame), Layer::kDot2},
      {"hex", HexText(frame, false), Layer::kHex, true},
      {"hex, upper case, lines", HexText(WrapUnsecured(frame), true, 60), Layer::kHex, true},
      {"rsu text", RsuText(frame), Layer::kRsuText, true},
      {"rsu text, envelope", RsuText(WrapSigned(frame)), Layer::kRsuText, true},
  };
  AddRadioFramings("of frame", WrapWsmp(frame), framings);
  AddRadioFramings("of unsecured", WrapWsmp(WrapUnsecured(frame)), framings);
  AddRadioFramings("of signed", WrapWsmp(WrapSigned(frame)), framings);
  AddRadioFramings("with options", WrapWsmpWithOptions(WrapSigned(frame)), framings);
  return framings;
}

// A message without what only some framings can tell.
std::string Essence(bsm_t message) {
  message.generation_utime = 0;
  message.rssi_dbm = 0.0F;
  std::string bytes(static_cast<std::size_t>(message.getEncodedSize()), '\0');
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

int CheckAll(const Octets& frame, const std::string& which) {
  Octets scratch(kLongestDatagram);
  Datagram datagram;
  std::string first;
  int checked = 0;
  for (const Framed& framed : AllFramings(frame)) {
    DatagramOptions options;
    options.allow_text = framed.is_text;
    options.port = framed.port;
    ReadDatagram(framed.bytes, options, scratch, datagram);
    EXPECT_FALSE(datagram.fault) << which << " " << framed.name << FaultText(datagram.fault);
    if (datagram.fault) continue;
    EXPECT_EQ(*datagram.layers.begin(), framed.outermost) << which << " " << framed.name;
    const bsm_t message = BsmMessage(datagram, {1700000000000000, 7, {}, 0});
    if (first.empty()) first = Essence(message);
    EXPECT_EQ(Essence(message), first) << which << " " << framed.name;
    EXPECT_EQ(std::isnan(message.rssi_dbm), std::isnan(framed.rssi_dbm)) << framed.name;
    if (!std::isnan(framed.rssi_dbm)) {
      EXPECT_EQ(message.rssi_dbm, framed.rssi_dbm);
    }
    ++checked;
    // Named instead of guessed: the same.
    if (!framed.is_text) {
      options.framing = framed.outermost;
      Datagram named;
      ReadDatagram(framed.bytes, options, scratch, named);
      EXPECT_FALSE(named.fault) << framed.name << FaultText(named.fault);
      if (named.bsm) {
        EXPECT_EQ(named.bsm->core, datagram.bsm->core);
      }
    }
  }
  return checked;
}

// Failure mode 4.
TEST(AllFramings, OfEverySampleGiveOneAndTheSameMessage) {
  V2VOUCH_NEEDS_OBU_DATA();
  int checked = 0, samples = 0;
  for (const BsmVector& vector : BsmVectors()) {
    if (vector.has_frame_extensions) continue;
    checked += CheckAll(vector.bytes, "vector " + std::to_string(samples++));
  }
  for (const UnitRecord& record : UnitRecords()) {
    if (!record.is_bsm) continue;
    Octets scratch(kLongestDatagram);
    Datagram datagram;
    ReadDatagram(record.bytes, {}, scratch, datagram);
    ASSERT_FALSE(datagram.fault);
    Octets frame(2304);
    std::size_t size = 0;
    ASSERT_FALSE(WriteBsmFrame(*datagram.bsm, frame, size));
    frame.resize(size);
    checked += CheckAll(frame, record.file);
    ++samples;
  }
  EXPECT_EQ(samples, 166 + 803);
  EXPECT_EQ(checked, samples * 67);
}

// The 803 as the units framed them.
TEST(AllFramings, RealUnitsMessagesHaveTheirValuesAsFramedByTheUnits) {
  V2VOUCH_NEEDS_OBU_DATA();
  int bsms = 0, others = 0;
  for (const UnitRecord& record : UnitRecords()) {
    Octets scratch(kLongestDatagram);
    Datagram datagram;
    ReadDatagram(record.bytes, {}, scratch, datagram);
    if (!record.is_bsm) {
      EXPECT_EQ(datagram.fault, (Fault{FaultKind::kNotBsm, "messageId", 31}));
      ++others;
      continue;
    }
    ++bsms;
    ASSERT_FALSE(datagram.fault) << FaultText(datagram.fault);
    ASSERT_TRUE(datagram.bsm);
    EXPECT_EQ(datagram.bsm->core, record.core);
    EXPECT_FALSE(datagram.bsm->tail_fault);
    EXPECT_EQ(datagram.bsm->unread_items, 0);
    const bsm_t message = BsmMessage(datagram, {record.log_utime, bsms, {}, 0});
    EXPECT_EQ(message.generation_utime, record.generation_utime);
    EXPECT_EQ(message.lat, record.core.lat);
    EXPECT_EQ(message.id[0], record.core.id >> 24);
    EXPECT_EQ(message.id[3], record.core.id & 0xFF);
  }
  EXPECT_EQ(bsms, 803);
  EXPECT_EQ(others, 150);
}

// Failure mode 1: a message that is full of 00 14 and 00 20.
TEST(AllFramings, BytesThatLookLikeHeadersInsideAreNotTakenForHeaders) {
  Bsm bsm;
  bsm.core.id = 0x00140014;
  bsm.core.lat = -900000000 + 0x00140014;
  bsm.core.sec_mark = 0x0014;
  const Octets content = FromHex("0014250014200300200300140381004003800014");
  bsm.part_two[0] = {1, {content, 0, content.size() * 8}};
  bsm.part_two_count = 1;
  Octets frame(200);
  std::size_t size = 0;
  ASSERT_FALSE(WriteBsmFrame(bsm, frame, size));
  frame.resize(size);
  EXPECT_EQ(CheckAll(frame, "00 14"), 67);
  SignedOptions options;
  options.digest = FromHex("0014002000140020");
  Octets scratch(kLongestDatagram);
  Datagram datagram;
  const Octets bytes = WrapWsmp(WrapSigned(frame, options));
  ReadDatagram(bytes, {}, scratch, datagram);
  ASSERT_FALSE(datagram.fault);
  EXPECT_EQ(datagram.bsm->core, bsm.core);
}

// CAMs likewise.
TEST(AllFramings, OfACamGiveOneAndTheSameMessage) {
  V2VOUCH_NEEDS_OBU_DATA();
  const Octets text = ObuFile("etsi/cam_long.uper.hex");
  const Octets cam = FromHex(std::string(text.begin(), text.end()));
  const Octets btp = WrapBtp(cam);
  const Octets geo = WrapGeo(btp);
  SignedOptions secured;
  secured.psid = kPsidCam;
  // Secured packets: basic header, then an envelope round common header and the rest.
  const Octets geo_secured =
      Joined({0x12, 0x00, 0x05, 0x01}, WrapSigned(Octets(geo.begin() + 4, geo.end()), secured));
  const std::vector<Octets> framings = {cam,
                                        btp,
                                        geo,
                                        geo_secured,
                                        WrapCohda(cam),
                                        WrapEthernet(geo, 0x8947),
                                        WrapEthernet(geo_secured, 0x8947),
                                        WrapWlan(WrapLlc(geo, 0x8947)),
                                        WrapRadiotap(WrapWlan(WrapLlc(geo, 0x8947)), -60),
                                        WrapC2p(WrapWlan(WrapLlc(geo, 0x8947)), 0x11)};
  std::string first;
  for (const Octets& bytes : framings) {
    Octets scratch(kLongestDatagram);
    Datagram datagram;
    ReadDatagram(bytes, {}, scratch, datagram);
    ASSERT_FALSE(datagram.fault) << FaultText(datagram.fault) << HexText(bytes);
    bsm_t message = BsmMessage(datagram, {});
    message.secMark = 0;  // Known where an envelope tells the time.
    if (first.empty()) first = Essence(message);
    EXPECT_EQ(Essence(message), first) << HexText(bytes);
  }
}

}  // namespace
}  // namespace v2vouch::obu
