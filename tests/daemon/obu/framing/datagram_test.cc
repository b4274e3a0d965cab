// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/framing/datagram.h"

#include <gtest/gtest.h>

#include "tests/support/obu_wrap.h"

namespace v2vouch::obu {
namespace {

// A BSM of 37 octets, 40 with its header.
Octets Frame() {
  Bsm bsm;
  bsm.core.id = 0x12345678;
  bsm.core.speed = 500;
  Octets bytes(64);
  std::size_t size = 0;
  EXPECT_FALSE(WriteBsmFrame(bsm, bytes, size));
  bytes.resize(size);
  return bytes;
}

// Points into `bytes`, which the caller keeps.
Datagram Read(const Octets& bytes, const DatagramOptions& options = {}) {
  static Octets scratch(kLongestDatagram);
  Datagram datagram;
  ReadDatagram(bytes, options, scratch, datagram);
  return datagram;
}

std::string Layers(const Datagram& datagram) {
  std::string names;
  for (const Layer layer : datagram.layers) {
    names += (names.empty() ? "" : " ") + std::string(LayerName(layer));
  }
  return names;
}

TEST(ReadDatagram, NamesItsLayersOutermostFirst) {
  const Octets wsmp = WrapWsmp(WrapSigned(Frame()));
  EXPECT_EQ(Layers(Read(WrapC2p(WrapWlan(WrapLlc(wsmp)), 1))), "c2p wlan llc wsmp dot2 frame");
  EXPECT_EQ(Layers(Read(WrapRadiotap(WrapWlan(WrapLlc(wsmp)), -50))),
            "radiotap wlan llc wsmp dot2 frame");
}

TEST(ReadDatagram, UnknownBytesAreUnknownNotSearched) {
  const Octets frame = Frame();
  for (const Octets& prefix : {FromHex("ff"), FromHex("10162002"), FromHex("55aa55aa"),
                               FromHex("0015"), FromHex("0b80")}) {
    const Octets bytes = Joined(prefix, frame);
    EXPECT_TRUE(Read(bytes).fault) << HexText(prefix);
    EXPECT_FALSE(Read(bytes).bsm) << HexText(prefix);
  }
  EXPECT_EQ(Read(FromHex("ffeeddcc")).fault.kind, FaultKind::kUnknownFraming);
}

// Failure mode 3: nothing, one byte, two bytes, every prefix of every framing.
TEST(ReadDatagram, EveryPrefixIsRefused) {
  const Octets wsmp = WrapWsmp(WrapSigned(Frame()));
  const Octets wlan = WrapWlan(WrapLlc(wsmp));
  for (const Octets& whole : {Frame(), WrapUnsecured(Frame()), WrapSigned(Frame()), wsmp,
                              WrapCv2x(wsmp), WrapEthernet(wsmp), WrapLlc(wsmp), wlan,
                              WrapRadiotap(wlan, -50), WrapC2p(wlan, 0x11), WrapC2p(wlan, 0x01)}) {
    ASSERT_FALSE(Read(whole).fault);
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const Octets prefix(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
      const Datagram datagram = Read(prefix);
      EXPECT_TRUE(datagram.fault) << size << " of " << HexText(whole);
    }
  }
}

TEST(ReadDatagram, FourBytesMayFollowTheOutermostLayerFiveMayNot) {
  const Octets wsmp = WrapWsmp(WrapSigned(Frame()));
  for (const Octets& whole : {Frame(), WrapSigned(Frame()), wsmp, WrapWlan(WrapLlc(wsmp))}) {
    EXPECT_EQ(Read(Joined(whole, Octets(4))).trailing, 4u);
    EXPECT_FALSE(Read(Joined(whole, Octets(4))).fault);
    EXPECT_TRUE(Read(Joined(whole, Octets(5))).fault);
  }
}

TEST(ReadDatagram, NothingMayLieBehindAnInnerLayer) {
  const Octets loose = Joined(Frame(), Octets(1));
  for (const Octets& whole : {WrapUnsecured(loose), WrapSigned(loose), WrapWsmp(loose),
                              WrapWsmp(Joined(WrapSigned(Frame()), Octets(1)))}) {
    EXPECT_EQ(Read(whole).fault.kind, FaultKind::kTrailingBytes);
  }
}

// Failure mode 5.
TEST(ReadDatagram, SixHundredBytesAreReadAndTooManyRefused) {
  Bsm bsm;
  const Octets content(560, 0x77);
  bsm.part_two[0] = {1, {content, 0, content.size() * 8}};
  bsm.part_two_count = 1;
  Octets frame(2304);
  std::size_t size = 0;
  ASSERT_FALSE(WriteBsmFrame(bsm, frame, size));
  frame.resize(size);
  EXPECT_GT(frame.size(), 600u);
  EXPECT_FALSE(Read(WrapSigned(frame)).fault);
  EXPECT_EQ(Read(Octets(kLongestDatagram + 1)).fault.kind, FaultKind::kTooLong);
}

TEST(ReadDatagram, OtherMessagesArePassedOverByName) {
  const Octets map = FromHex("001203aabbcc");
  EXPECT_EQ(Read(map).fault, (Fault{FaultKind::kNotBsm, "messageId", 18}));
  EXPECT_EQ(Read(WrapWsmp(map, 0x82)).fault, (Fault{FaultKind::kNotBsm, "messageId", 18}));
  EXPECT_EQ(Read(WrapWsmp(WrapSigned(FromHex("002001ff")))).fault,
            (Fault{FaultKind::kNotBsm, "messageId", 32}));
}

TEST(ReadDatagram, EnvelopesOfOtherApplicationsCarryNoBsm) {
  EXPECT_EQ(Read(WrapWsmp(Frame(), 0x82)).fault, (Fault{FaultKind::kWrongPsid, "WSMP PSID", 0x82}));
  SignedOptions options;
  options.psid = 0x83;
  EXPECT_EQ(Read(WrapWsmp(WrapSigned(Frame(), options))).fault,
            (Fault{FaultKind::kWrongPsid, "1609.2 PSID", 0x83}));
}

TEST(ReadDatagram, WhatTheUnitSentItselfIsToldApart) {
  const Octets wlan = WrapWlan(WrapLlc(WrapWsmp(WrapSigned(Frame()))));
  for (const int kind : {0x02, 0x12}) {
    const Octets bytes = WrapC2p(wlan, kind);
    const Datagram datagram = Read(bytes);
    EXPECT_EQ(datagram.fault.kind, FaultKind::kOwnTransmission);
    EXPECT_TRUE(datagram.bsm);
  }
}

TEST(ReadDatagram, NamedFramingTakesNoOther) {
  DatagramOptions options;
  options.framing = Layer::kDot2;
  EXPECT_TRUE(Read(Frame(), options).fault);
  EXPECT_FALSE(Read(WrapUnsecured(Frame()), options).fault);
}

TEST(ReadDatagram, TextOnlyWhereAllowed) {
  const Octets text = HexText(Frame(), true);
  EXPECT_TRUE(Read(text).fault);
  DatagramOptions options;
  options.allow_text = true;
  EXPECT_FALSE(Read(text, options).fault);
  EXPECT_FALSE(Read(Frame(), options).fault);  // Binary as ever.
  const Octets bad = RsuText(FromHex("0014"));
  EXPECT_EQ(Read(bad, options).fault.kind, FaultKind::kTruncated);
}

// The odd ones of the data set, as its README says.
TEST(ReadDatagram, OddSamplesAreDeliveredOrRefusedAsTheyShould) {
  V2VOUCH_NEEDS_OBU_DATA();
  const Octets bad_item = ObuFile("dot2_odd/ieee1609dot2.badpayload.unsigned.coer");
  const Datagram delivered = Read(bad_item);
  ASSERT_FALSE(delivered.fault) << FaultText(delivered.fault);
  EXPECT_EQ(delivered.bsm->core.msg_count, 76);
  EXPECT_EQ(delivered.bsm->core.sec_mark, 34200);
  EXPECT_EQ(delivered.bsm->core.lat, 404740355);
  EXPECT_EQ(delivered.bsm->core.lon, -1049691765);
  EXPECT_EQ(delivered.bsm->core.elev, 15023);
  EXPECT_EQ(delivered.bsm->core.speed, 4);
  EXPECT_EQ(delivered.bsm->core.heading, 16232);
  EXPECT_EQ(Read(ObuFile("dot2_odd/Ieee1609Dot2Data.per")).fault.kind, FaultKind::kUnknownFraming);

  const auto hex = [](const char* name) {
    const Octets text = ObuFile(name);
    return FromHex(std::string(text.begin(), text.end()));
  };
  Octets map = hex("ieee1609/gdot.hex");
  map.resize(192);
  EXPECT_EQ(Read(map).fault, (Fault{FaultKind::kNotBsm, "messageId", 19}));
  const Octets signed_map = hex("ieee1609/udp.hex");
  EXPECT_EQ(Read(signed_map).fault.kind, FaultKind::kNotBsm);
  for (const char* name : {"ieee1609/udp2.hex", "ieee1609/unsecured_bsm.coer.hex",
                           "ieee1609/unsecured_bsm_with_leading_header.hex"}) {
    const Octets bytes = hex(name);
    EXPECT_FALSE(Read(bytes).fault) << name << FaultText(Read(bytes).fault);
    // And as the text that it is.
    DatagramOptions options;
    options.allow_text = true;
    const Octets text = ObuFile(name);
    const Datagram datagram = Read(text, options);
    ASSERT_FALSE(datagram.fault) << name;
    EXPECT_EQ(datagram.bsm->core, Read(bytes).bsm->core);
  }
}

TEST(ReadPacket, UdpOverEveryLinkTypeAndBothIps) {
  const Octets wsmp = WrapWsmp(WrapSigned(Frame()));
  Octets scratch(kLongestDatagram);
  Datagram datagram;
  for (const bool is_ipv6 : {false, true}) {
    const Octets ip = WrapUdp(wsmp, 5398, is_ipv6);
    const int type = is_ipv6 ? 0x86DD : 0x0800;
    Octets cooked(14, 0x00);
    Append(cooked, static_cast<std::uint64_t>(type), 2);
    Octets cooked2;
    Append(cooked2, static_cast<std::uint64_t>(type), 2);
    cooked2.resize(20);
    Octets vlan = WrapEthernet({}, 0x8100);
    Append(vlan, 7, 2);
    Append(vlan, static_cast<std::uint64_t>(type), 2);
    const std::pair<int, Octets> packets[] = {
        {1, WrapEthernet(ip, type)},
        {1, Joined(vlan, ip)},
        {101, ip},
        {0, Joined(Octets(4), ip)},
        {113, Joined(cooked, ip)},
        {276, Joined(cooked2, ip)},
        {1, Joined(WrapEthernet(ip, type), Octets(9))}};  // Padding behind the IP packet.
    for (const auto& [link_type, bytes] : packets) {
      ReadPacket(link_type, bytes, {}, scratch, datagram);
      ASSERT_FALSE(datagram.fault) << link_type << FaultText(datagram.fault);
      ASSERT_TRUE(datagram.udp);
      EXPECT_EQ(datagram.udp->destination_port, 5398);
      EXPECT_EQ(datagram.bsm->core.id, 0x12345678u);
    }
  }
}

TEST(ReadPacket, WhatIsNotV2xIsNamed) {
  Octets scratch(kLongestDatagram);
  Datagram datagram;
  ReadPacket(1, WrapEthernet(Octets(28), 0x0806), {}, scratch, datagram);
  EXPECT_EQ(datagram.fault, (Fault{FaultKind::kNotV2x, "Ethernet type", 0x0806}));
  Octets tcp = WrapUdp(Octets(40), 80);
  tcp[9] = 6;
  ReadPacket(101, tcp, {}, scratch, datagram);
  EXPECT_EQ(datagram.fault, (Fault{FaultKind::kNotV2x, "IP protocol", 6}));
  Octets fragment = WrapUdp(Octets(40), 80);
  fragment[6] = 0x20;
  ReadPacket(101, fragment, {}, scratch, datagram);
  EXPECT_EQ(datagram.fault.kind, FaultKind::kIpFragment);
  ReadPacket(147, fragment, {}, scratch, datagram);
  EXPECT_EQ(datagram.fault.kind, FaultKind::kUnsupported);
}

}  // namespace
}  // namespace v2vouch::obu
