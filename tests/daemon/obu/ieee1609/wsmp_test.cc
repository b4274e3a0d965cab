// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/ieee1609/wsmp.h"

#include <gtest/gtest.h>

#include "tests/support/obu_wrap.h"

namespace v2vouch::obu {
namespace {

// Failure mode 20. Expected values: IEEE 1609.12 p-encoding, first and last of each length.
TEST(ReadPsid, EachLengthBeginsWhereTheOneBelowEnds) {
  const struct {
    const char* hex;
    std::uint32_t psid;
  } kCases[] = {{"20", 0x20},         {"7f", 0x7F},           {"8000", 0x80},
                {"8002", 0x82},       {"bfff", 0x407F},       {"c00000", 0x4080},
                {"dfffff", 0x20407F}, {"e0000000", 0x204080}, {"e0000015", 0x204095}};
  for (const auto& [hex, psid] : kCases) {
    const Octets bytes = FromHex(hex);
    ByteReader reader(bytes);
    EXPECT_EQ(ReadPsid(reader), psid) << hex;
    EXPECT_EQ(reader.left(), 0u);
  }
  const Octets reserved = {0xF0};
  ByteReader reader(reserved);
  ReadPsid(reader);
  EXPECT_FALSE(reader.ok());
}

TEST(ReadWsmp, OptionsAreReadAndUnknownOnesPassedOver) {
  const Octets payload(150, 0x14);
  const Octets bytes = WrapWsmpWithOptions(payload);
  Wsmp wsmp;
  ASSERT_FALSE(ReadWsmp(bytes, wsmp));
  EXPECT_EQ(wsmp.psid, 0x20u);
  EXPECT_EQ(wsmp.channel, 180);
  EXPECT_EQ(wsmp.rate_500kbps, 12);
  EXPECT_EQ(wsmp.tx_power_raw, 0x93);
  EXPECT_EQ(HexText(wsmp.payload), HexText(payload));
  EXPECT_EQ(wsmp.trailing, 0u);
}

// Expected: tshark 4.0.17 and the decode in the data set.
TEST(ReadWsmp, RealMessageWithHeaderExtension) {
  V2VOUCH_NEEDS_OBU_DATA();
  const Octets text = ObuFile("ieee1609/gdot.hex");
  Octets bytes = FromHex(std::string(text.begin(), text.end()));
  bytes.resize(192);
  Wsmp wsmp;
  ASSERT_FALSE(ReadWsmp(bytes, wsmp));
  EXPECT_EQ(wsmp.psid, 0x82u);
  EXPECT_EQ(wsmp.channel, 180);
  EXPECT_EQ(wsmp.rate_500kbps, 12);
  EXPECT_EQ(wsmp.payload.size(), 176u);
  EXPECT_EQ(wsmp.trailing, 0u);
}

TEST(ReadWsmp, OtherAddressingAndVersionsAreNamed) {
  Wsmp wsmp;
  EXPECT_EQ(ReadWsmp(FromHex("03022000"), wsmp), (Fault{FaultKind::kUnsupported, "WSMP TPID", 2}));
  EXPECT_EQ(ReadWsmp(FromHex("02002000"), wsmp),
            (Fault{FaultKind::kUnsupported, "WSMP version", 2}));
  EXPECT_EQ(ReadWsmp(FromHex("0300200511"), wsmp).kind, FaultKind::kTruncated);
}

}  // namespace
}  // namespace v2vouch::obu
