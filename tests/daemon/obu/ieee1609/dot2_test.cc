// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/ieee1609/dot2.h"

#include <gtest/gtest.h>

#include "daemon/obu/ieee1609/dot2_time.h"
#include "daemon/obu/ieee1609/wsmp.h"
#include "tests/support/obu_wrap.h"

namespace v2vouch::obu {
namespace {

// The envelope of a record; WSMP taken off.
Bytes Envelope(const UnitRecord& record) {
  if (!LooksLikeWsmp(record.bytes)) return record.bytes;
  Wsmp wsmp;
  EXPECT_FALSE(ReadWsmp(record.bytes, wsmp));
  return wsmp.payload;
}

TEST(ReadDot2, RealEnvelopesHaveTheTimesAndSignersThatTsharkFinds) {
  V2VOUCH_NEEDS_OBU_DATA();
  int bsms = 0, is_signed = 0, certificates = 0;
  for (const UnitRecord& record : UnitRecords()) {
    Dot2Data data;
    const Bytes envelope = Envelope(record);
    if (!LooksLikeDot2(envelope)) continue;
    ASSERT_FALSE(ReadDot2(envelope, data));
    EXPECT_EQ(data.trailing, 0u);
    if (!record.is_bsm) {
      EXPECT_NE(data.psid, 0x20u);  // TIMs.
      continue;
    }
    ++bsms;
    if (record.signer == "none") {
      EXPECT_EQ(data.content, Dot2Data::Content::kUnsecured);
      continue;
    }
    ++is_signed;
    EXPECT_FALSE(data.security_fault) << FaultText(data.security_fault);
    EXPECT_EQ(data.psid, 0x20u);
    ASSERT_TRUE(data.generation_us);
    EXPECT_EQ(UtcOfDot2Micros(*data.generation_us), record.generation_utime);
    EXPECT_TRUE(data.signature.is_p256);
    if (record.signer == "digest") {
      EXPECT_EQ(HexText(data.signer_digest), record.digest);
    } else {
      ++certificates;
      ASSERT_TRUE(data.certificate);
      EXPECT_TRUE(data.certificate->is_implicit);
      EXPECT_TRUE(data.certificate->has_canonical_form);
      EXPECT_TRUE(data.certificate->psids.Has(0x20));
    }
  }
  EXPECT_EQ(bsms, 803);
  EXPECT_EQ(is_signed, 787);
  EXPECT_EQ(certificates, 152);
}

// Expected: the decode of another program in the data set (udp.dot2.expected.json).
TEST(ReadDot2, RealCertificateOfARoadSideUnitIsReadToItsEnd) {
  V2VOUCH_NEEDS_OBU_DATA();
  const Octets text = ObuFile("ieee1609/udp.hex");
  const Octets bytes = FromHex(std::string(text.begin(), text.end()));
  Wsmp wsmp;
  ASSERT_FALSE(ReadWsmp(bytes, wsmp));
  Dot2Data data;
  ASSERT_FALSE(ReadDot2(wsmp.payload, data));
  EXPECT_FALSE(data.security_fault) << FaultText(data.security_fault);
  EXPECT_EQ(data.psid, 130u);
  EXPECT_EQ(data.generation_us, 637434485748149u);
  ASSERT_TRUE(data.certificate);
  const Certificate& certificate = *data.certificate;
  EXPECT_EQ(HexText(certificate.issuer_digest), "c620fb90caad3b9c");
  EXPECT_EQ(certificate.valid_from_s, 637007767u);
  EXPECT_EQ(certificate.valid_for_us, 10140ULL * 60 * 1000000);
  ASSERT_EQ(certificate.psids.all().size(), 7u);
  EXPECT_EQ(certificate.psids.all()[0], 2113685u);
  EXPECT_EQ(certificate.psids.all()[6], 128u);
  EXPECT_EQ(certificate.key.form, CurvePoint::Form::kOdd);
  EXPECT_EQ(HexText(data.signature.r.x).substr(0, 8), "ffd5d7d4");
  EXPECT_EQ(HexText(data.signature.s).substr(0, 8), "f10d76bf");
}

TEST(ReadDot2, SignatureWithXOnlyIsRead) {
  V2VOUCH_NEEDS_OBU_DATA();
  const Octets text = ObuFile("ieee1609/udp2.hex");
  const Octets bytes = FromHex(std::string(text.begin(), text.end()));
  Wsmp wsmp;
  ASSERT_FALSE(ReadWsmp(bytes, wsmp));
  Dot2Data data;
  ASSERT_FALSE(ReadDot2(wsmp.payload, data));
  EXPECT_EQ(data.signature.r.form, CurvePoint::Form::kXOnly);
  EXPECT_EQ(HexText(data.signer_digest), "b2efb1bb38328c83");
}

TEST(ReadDot2, UnknownHeaderExtensionIsPassedOver) {
  SignedOptions options;
  options.header_extension = FromHex(
      "0205a0"
      "02beef"
      "0112");  // Two additions of three bits.
  const Octets payload = FromHex("0014");
  Dot2Data data;
  const Octets bytes = WrapSigned(payload, options);
  ASSERT_FALSE(ReadDot2(bytes, data));
  EXPECT_FALSE(data.security_fault) << FaultText(data.security_fault);
  EXPECT_EQ(HexText(data.payload), "0014");
  EXPECT_EQ(HexText(data.signer_digest), "0102030405060708");
}

TEST(ReadDot2, HeaderThatCannotBeReadLeavesThePayload) {
  SignedOptions options;
  options.header_extension = FromHex("09");  // A bitmap with nine unused bits.
  const Octets payload = FromHex("0014");
  Dot2Data data;
  const Octets bytes = WrapSigned(payload, options);
  ASSERT_FALSE(ReadDot2(bytes, data));
  EXPECT_TRUE(data.security_fault);
  EXPECT_EQ(HexText(data.payload), "0014");
}

TEST(ReadDot2, EncryptedRequestedAndNestedDataAreNamed) {
  Dot2Data data;
  EXPECT_EQ(ReadDot2(FromHex("038200"), data).kind, FaultKind::kEncrypted);
  EXPECT_EQ(ReadDot2(FromHex("038300"), data).kind, FaultKind::kUnsupported);
  const Octets inner = WrapSigned(FromHex("0014"));
  const Octets nested = Joined(FromHex("03810040"), inner);
  EXPECT_EQ(ReadDot2(nested, data).kind, FaultKind::kNestedTooDeep);
  EXPECT_EQ(ReadDot2(FromHex("02800100"), data).kind, FaultKind::kUnsupported);
}

}  // namespace
}  // namespace v2vouch::obu
