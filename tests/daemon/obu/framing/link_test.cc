// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/framing/link.h"

#include <gtest/gtest.h>

#include "daemon/obu/framing/text.h"
#include "daemon/obu/octets/hex_text.h"
#include "tests/support/obu_wrap.h"

namespace v2vouch::obu {
namespace {

TEST(Radiotap, SignalIsFoundBehindAlignedFields) {
  const Octets bytes = WrapRadiotap(Octets(30, 0x08), -83);
  Radiotap radiotap;
  Bytes rest;
  ASSERT_FALSE(ReadRadiotap(bytes, radiotap, rest));
  EXPECT_EQ(radiotap.signal_dbm, -83);
  EXPECT_EQ(rest.size(), 30u);
}

TEST(Radiotap, EndlessChainOfPresenceWordsEnds) {
  Octets bytes = FromHex("00001000");
  bytes.resize(16, 0xFF);
  Radiotap radiotap;
  Bytes rest;
  EXPECT_FALSE(ReadRadiotap(bytes, radiotap, rest));
  EXPECT_FALSE(radiotap.signal_dbm);
}

TEST(Wlan, ManagementAndProtectedFramesAreNotRead) {
  Bytes rest;
  EXPECT_EQ(ReadWlan(FromHex("8000000000"), rest).kind, FaultKind::kNotV2x);
  EXPECT_EQ(ReadWlan(FromHex("0840000000"), rest).kind, FaultKind::kEncrypted);
}

// Failure mode 15.
TEST(ReadHex, UpperLowerMixedBlanksAndLineBreaks) {
  Octets scratch(kLongestDatagram);
  Bytes bytes;
  for (const char* text : {"00142aFf", "0x00142AFF", " 00 14\t2a\r\nff\n", "0014\n2aff\n\n"}) {
    ASSERT_FALSE(ReadHex(text, scratch, bytes)) << text;
    EXPECT_EQ(HexText(bytes), "00142aff");
  }
  EXPECT_EQ(ReadHex("0014 2", scratch, bytes).kind, FaultKind::kBadText);
  EXPECT_EQ(ReadHex("001g", scratch, bytes).kind, FaultKind::kBadText);
  EXPECT_EQ(ReadHex("0 0", scratch, bytes).kind, FaultKind::kBadText);
  EXPECT_EQ(ReadHex("  ", scratch, bytes).kind, FaultKind::kEmpty);
  EXPECT_EQ(ReadHex(std::string(5000, '0'), scratch, bytes).kind, FaultKind::kTooLong);
}

TEST(RsuText, PayloadIsFoundWhateverTheOrderAndCaseOfKeys) {
  EXPECT_EQ(PayloadOfRsuText("PAYLOAD = 0014\r\nversion=0.7\r\n"), "0014");
  EXPECT_FALSE(PayloadOfRsuText("Payload=0014\n"));
  EXPECT_FALSE(PayloadOfRsuText("Version=0.7\n"));
}

}  // namespace
}  // namespace v2vouch::obu
