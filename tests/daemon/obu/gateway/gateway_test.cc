// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/gateway/gateway.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "daemon/obu/ieee1609/dot2_time.h"
#include "tests/support/obu_wrap.h"
#include "tests/support/test_authority.h"

namespace v2vouch::obu {
namespace {

constexpr std::int64_t kStart = 1700000000000000;
constexpr char kUnit[] = "192.168.88.40";

Octets Frame(int count, std::uint32_t id = 0x12345678) {
  Bsm bsm;
  bsm.core.id = id;
  bsm.core.msg_count = count % 128;
  bsm.core.lat = 480000000 + count;
  bsm.core.lon = 110000000;
  bsm.core.speed = 500;
  Octets bytes(64);
  std::size_t size = 0;
  EXPECT_FALSE(WriteBsmFrame(bsm, bytes, size));
  bytes.resize(size);
  return bytes;
}

std::int64_t CountOf(const std::vector<count_t>& counts, const std::string& name) {
  for (const count_t& each : counts) {
    if (each.name == name) return each.count;
  }
  return 0;
}

class Rig {
 public:
  explicit Rig(GatewayConfig config = {}, TrustAnchors anchors = {})
      : gateway(config, std::move(anchors), kStart) {}

  // What was published on account of it.
  std::vector<bsm_t> Hear(const Octets& bytes, std::int64_t offset_us,
                          std::string_view source = kUnit) {
    std::vector<bsm_t> out;
    gateway.OnDatagram({bytes, source, 0, kStart + offset_us, false}, out);
    return out;
  }
  std::vector<bsm_t> Flush(std::int64_t offset_us) {
    std::vector<bsm_t> out;
    gateway.Flush(kStart + offset_us, out);
    return out;
  }
  obu_status_t Status(std::int64_t offset_us) { return gateway.Status(kStart + offset_us); }

  Gateway gateway;
};

TEST(Gateway, PublishesWhatItUnderstandsWithTheTimeOfReception) {
  Rig rig;
  const auto out = rig.Hear(WrapUnsecured(Frame(1)), 5000);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ(out[0].rx_utime, kStart + 5000);
  EXPECT_EQ(out[0].seq, 1);
  EXPECT_EQ(out[0].id[0], 0x12);
  EXPECT_EQ(rig.Hear(Frame(2), 105000)[0].seq, 2);
  const obu_status_t status = rig.Status(1000000);
  EXPECT_EQ(status.datagrams, 2);
  EXPECT_EQ(status.published, 2);
  EXPECT_EQ(status.senders, 1);
  EXPECT_EQ(CountOf(status.framings, "dot2"), 1);
  EXPECT_EQ(CountOf(status.framings, "frame"), 1);
  EXPECT_EQ(CountOf(status.signatures, "unsigned"), 2);
  EXPECT_EQ(CountOf(status.sources, kUnit), 2);
}

// Failure mode 16.
TEST(Gateway, CopiesOfTwoAntennasAreOneMessageWithTheStrongerSignal) {
  Rig rig;
  const auto radio = [](int count, int rssi) {
    return WrapC2p(WrapWlan(WrapLlc(WrapWsmp(WrapSigned(Frame(count))))), 0x11, rssi);
  };
  EXPECT_TRUE(rig.Hear(radio(1, -90), 0).empty());  // Waits for the other antenna.
  EXPECT_EQ(*rig.gateway.due(), kStart + 5000);
  EXPECT_TRUE(rig.Hear(radio(1, -70), 3000).empty());
  EXPECT_TRUE(rig.Flush(4000).empty());
  const auto out = rig.Flush(5000);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ(out[0].rssi_dbm, -70.0F);
  EXPECT_EQ(out[0].rx_utime, kStart);
  // The same message forwarded without its radio layers: a copy all the same.
  EXPECT_TRUE(rig.Hear(WrapSigned(Frame(1)), 8000).empty());
  EXPECT_EQ(rig.Status(10000).duplicates, 2);
  EXPECT_EQ(rig.Hear(WrapSigned(Frame(2)), 100000).size(), 1u);
}

TEST(Gateway, CopiesOfACamAreOneMessage) {
  V2VOUCH_NEEDS_OBU_DATA();
  const Octets text = ObuFile("etsi/cam_long.uper.hex");
  const Octets cam = FromHex(std::string(text.begin(), text.end()));
  const Octets radio = WrapWlan(WrapLlc(WrapGeo(WrapBtp(cam)), 0x8947));
  Rig rig;
  rig.Hear(WrapC2p(radio, 0x11, -80), 0);
  rig.Hear(WrapC2p(radio, 0x11, -60), 2000);
  EXPECT_TRUE(rig.Hear(cam, 3000).empty());
  const auto out = rig.Flush(10000);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ(out[0].rssi_dbm, -60.0F);
  EXPECT_EQ(rig.Status(10000).duplicates, 2);
}

TEST(Gateway, ACopyWithoutTheSignatureDoesNotDisplaceTheSignedMessage) {
  Rig rig;
  EXPECT_EQ(rig.Hear(Frame(1), 0).size(), 1u);
  EXPECT_EQ(rig.Hear(WrapSigned(Frame(1)), 1000).size(), 1u);
}

TEST(Gateway, MemoryOfCopiesIsBoundedInTimeAndNumber) {
  Rig rig;
  for (int i = 0; i < 100000; ++i) {
    const Octets frame = Frame(i, static_cast<std::uint32_t>(i));
    EXPECT_EQ(rig.Hear(frame, i * 200).size(), 1u);
  }
  EXPECT_EQ(rig.Hear(Frame(0, 0), 100000 * 200).size(), 1u);  // Long forgotten.
  EXPECT_LE(rig.Status(100000 * 200).senders, 16384);
}

// Failure mode 17.
TEST(Gateway, OnlyAllowedAddressesAreHeardAndEachIsCounted) {
  GatewayConfig config;
  config.inputs[0].allow = {kUnit};
  Rig rig(config);
  EXPECT_TRUE(rig.Hear(Frame(1), 0, "10.0.0.9").empty());
  EXPECT_EQ(rig.Hear(Frame(1), 1000).size(), 1u);
  const obu_status_t status = rig.Status(2000);
  EXPECT_EQ(CountOf(status.refusals, "source_not_allowed"), 1);
  EXPECT_EQ(CountOf(status.sources, "10.0.0.9"), 1);
}

TEST(Gateway, AThousandAddressesTakeSixtyFourRows) {
  Rig rig;
  for (int i = 0; i < 1000; ++i) {
    rig.Hear(Octets{0xFF, 0xFF}, i,
             "10.0." + std::to_string(i / 256) + "." + std::to_string(i % 256));
  }
  const obu_status_t status = rig.Status(1000);
  EXPECT_LE(status.sources.size(), 65u);
  EXPECT_EQ(CountOf(status.sources, "(others)"), 1000 - 64);
}

// Failure mode 22.
TEST(Gateway, FloodOfOneAddressIsCutOffAndTheUnitIsHeard) {
  Rig rig;
  std::mt19937_64 rng(22);
  std::size_t published = 0;
  for (int i = 0; i < 30000; ++i) {
    Octets garbage(40 + rng() % 200);
    for (auto& byte : garbage) byte = static_cast<std::uint8_t>(rng());
    rig.Hear(garbage, i * 33, "10.6.6.6");
    if (i % 100 == 0) published += rig.Hear(Frame(i / 100), i * 33).size();
  }
  EXPECT_EQ(published, 300u);
  const obu_status_t status = rig.Status(1000000);
  EXPECT_GE(CountOf(status.refusals, "over_rate"), 19000);
  EXPECT_LE(rig.gateway.TakeLog().size(), 1u);
}

TEST(Gateway, UnknownFramingsAreLoggedWithTheirFirstBytesNowAndThen) {
  Rig rig;
  for (int i = 0; i < 250; ++i) rig.Hear(FromHex("ffeeddccbbaa"), i * 100000);
  const auto log = rig.gateway.TakeLog();
  EXPECT_EQ(log.size(), 3u);  // 25 s.
  EXPECT_EQ(log[0], "event=unknown_framing source=192.168.88.40 bytes=6 first=ffeeddccbbaa");
  EXPECT_EQ(CountOf(rig.Status(0).refusals, "unknown_framing"), 250);
}

// Failure mode 19.
TEST(Gateway, SilenceOfTheUnitIsAnotherThingThanNoCars) {
  Rig rig;
  EXPECT_EQ(rig.Status(1000000).obu_silent, 0);
  EXPECT_EQ(rig.Status(4000000).obu_silent, 1);
  rig.Hear(FromHex("001203aabbcc"), 5000000);  // A map: the unit talks, no car does.
  const obu_status_t status = rig.Status(6000000);
  EXPECT_EQ(status.obu_silent, 0);
  EXPECT_EQ(status.senders, 0);
  EXPECT_EQ(CountOf(status.refusals, "not_bsm"), 1);
}

// Failure mode 18.
TEST(Gateway, AClockThreeSecondsOffIsToldAndDropsNobody) {
  for (const std::int64_t off_us : {3000000, -3000000, 100000}) {
    Rig rig;
    for (int i = 0; i < 50; ++i) {
      const std::int64_t at_us = i * 100000;
      SignedOptions options;
      options.generation_us = Dot2MicrosOfUtc(kStart + at_us - off_us);
      EXPECT_EQ(rig.Hear(WrapSigned(Frame(i), options), at_us).size(), 1u);
    }
    const obu_status_t status = rig.Status(5000000);
    EXPECT_NEAR(status.clock_offset_s, static_cast<double>(off_us) * 1e-6, 1e-5);
    EXPECT_EQ(status.clock_suspect, std::abs(off_us) > 1500000 ? 1 : 0);
  }
  Rig rig;
  rig.Hear(Frame(1), 0);
  EXPECT_TRUE(std::isnan(rig.Status(0).clock_offset_s));
}

// Failure mode 9: secMark is the sender's, never the time of reception.
TEST(Gateway, SecMarkPassesAsItCame) {
  for (const int mark : {59990, 65535, 60500, 0}) {
    Rig rig;
    Bsm bsm;
    bsm.core.sec_mark = mark;
    Octets frame(64);
    std::size_t size = 0;
    ASSERT_FALSE(WriteBsmFrame(bsm, frame, size));
    frame.resize(size);
    EXPECT_EQ(rig.Hear(frame, 10000)[0].secMark, mark);
  }
}

TEST(Gateway, SignaturesUnderAConfiguredRootAreToldApart) {
  const TestCertificate root = RootCertificate({.name = "root", .may_issue = true});
  const TestCertificate car = ImplicitCertificate(root, {.name = "car"});
  TestCertificate forger = car;
  forger.key = KeyOf("forger");
  TrustAnchors anchors;
  ASSERT_EQ(anchors.AddAnchor(root.bytes), std::nullopt);
  Rig rig({}, std::move(anchors));
  const std::uint64_t now = Dot2MicrosOfUtc(kStart);
  EXPECT_EQ(rig.Hear(SignedBy(car, Frame(1), now, true), 0)[0].signature_state, 1);
  const auto known = rig.Hear(SignedBy(car, Frame(2), now, false), 1000);
  EXPECT_EQ(known[0].signature_state, 1);
  EXPECT_EQ(HexText(known[0].certificate_digest), HexText(TestDigest(car)));
  EXPECT_EQ(rig.Hear(SignedBy(forger, Frame(3), now, false), 2000)[0].signature_state, 2);
  EXPECT_EQ(CountOf(rig.Status(3000).signatures, "verified"), 2);
}

TEST(Gateway, StatusFitsItsMessageWhateverWasHeard) {
  Rig rig;
  std::mt19937_64 rng(5);
  for (int i = 0; i < 3000; ++i) {
    Octets bytes = WrapC2p(WrapWlan(WrapLlc(WrapWsmp(WrapSigned(Frame(i))))), 0x01);
    bytes[rng() % bytes.size()] ^= static_cast<std::uint8_t>(1 + rng() % 255);
    rig.Hear(bytes, i * 1000);
  }
  const obu_status_t status = rig.Status(3000000);
  EXPECT_LE(status.num_refusals, 64);
  EXPECT_LE(status.num_framings, 64);
  Octets bytes(static_cast<std::size_t>(status.getEncodedSize()));
  EXPECT_EQ(status.encode(bytes.data(), 0, static_cast<int>(bytes.size())),
            static_cast<int>(bytes.size()));
}

}  // namespace
}  // namespace v2vouch::obu
