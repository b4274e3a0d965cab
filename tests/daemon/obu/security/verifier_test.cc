// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/security/verifier.h"

#include <gtest/gtest.h>

#include <map>

#include "daemon/obu/framing/datagram.h"
#include "daemon/obu/ieee1609/dot2_time.h"
#include "tests/support/obu_wrap.h"
#include "tests/support/test_authority.h"

namespace v2vouch::obu {
namespace {

constexpr std::uint64_t kNow_us = 700000000000000;  // Since 2004.

Octets Payload(std::uint8_t mark) { return {0x00, 0x14, 0x01, mark}; }

struct Authority {
  TestCertificate root = RootCertificate({.name = "root", .may_issue = true});
  TestCertificate issuer = ExplicitCertificate(root, {.name = "pca", .may_issue = true});
  TestCertificate car = ImplicitCertificate(issuer, {.name = "car"});

  [[nodiscard]] TrustAnchors Anchors() const {
    TrustAnchors anchors;
    EXPECT_EQ(anchors.AddAnchor(root.bytes), std::nullopt);
    EXPECT_EQ(anchors.AddIntermediate(issuer.bytes), std::nullopt);
    return anchors;
  }
};

// Judges one message, 100 ms after the one before.
class Ear {
 public:
  explicit Ear(TrustAnchors anchors = {}, VerifierConfig config = {})
      : verifier_(config, std::move(anchors)) {}
  Judgement Hear(const Octets& bytes) {
    Dot2Data data;
    EXPECT_FALSE(ReadDot2(bytes, data));
    utime_ += 100000;
    return verifier_.Judge(data, utime_);
  }
  Verifier& verifier() { return verifier_; }

 private:
  Verifier verifier_;
  std::int64_t utime_ = 1700000000000000;
};

TEST(Verifier, ImplicitCertificateUnderAConfiguredRootIsValid) {
  const Authority authority;
  Ear ear(authority.Anchors());
  const Judgement heard = ear.Hear(SignedBy(authority.car, Payload(1), kNow_us, true));
  EXPECT_EQ(heard.finding, SignatureFinding::kVerified);
  EXPECT_EQ(heard.signature_state(), 1);
  EXPECT_EQ(HexText(heard.digest), HexText(TestDigest(authority.car)));
  // By digest now, and in the form that tells only x.
  EXPECT_EQ(ear.Hear(SignedBy(authority.car, Payload(2), kNow_us, false)).signature_state(), 1);
  EXPECT_EQ(
      ear.Hear(SignedBy(authority.car, Payload(3), kNow_us, false, 0x20, true)).signature_state(),
      1);
}

TEST(Verifier, ExplicitCertificateUnderAConfiguredRootIsValid) {
  const Authority authority;
  Ear ear(authority.Anchors());
  const TestCertificate car = ExplicitCertificate(authority.issuer, {.name = "explicit car"});
  EXPECT_EQ(ear.Hear(SignedBy(car, Payload(1), kNow_us, true)).signature_state(), 1);
}

TEST(Verifier, EveryFlippedBitUnderAChainIsInvalidOrUnread) {
  const Authority authority;
  const Octets good = SignedBy(authority.car, Payload(1), kNow_us, false);
  Ear ear(authority.Anchors());
  EXPECT_EQ(ear.Hear(SignedBy(authority.car, Payload(0), kNow_us, true)).signature_state(), 1);
  int invalid = 0;
  for (std::size_t bit = 0; bit < good.size() * 8; ++bit) {
    Octets bad = good;
    bad[bit / 8] = static_cast<std::uint8_t>(bad[bit / 8] ^ (1U << bit % 8));
    Dot2Data data;
    if (ReadDot2(bad, data)) continue;
    // How the signature's point is told (even, odd, x only) is no part of the signature.
    if (bit / 8 == good.size() - 65) continue;
    const Judgement judgement =
        ear.verifier().Judge(data, 1800000000000000 + static_cast<std::int64_t>(bit) * 100000);
    EXPECT_NE(judgement.signature_state(), 1) << bit;
    invalid += judgement.signature_state() == 2 ? 1 : 0;
  }
  // Payload, time and signature: all but structure and signer.
  EXPECT_GT(invalid, 500);
}

TEST(Verifier, WithoutAChainNothingIsValidAndNothingYoungIsInvalid) {
  const Authority authority;
  Ear ear;
  EXPECT_EQ(ear.Hear(SignedBy(authority.car, Payload(1), kNow_us, false)).finding,
            SignatureFinding::kCertificateUnknown);
  EXPECT_EQ(ear.Hear(SignedBy(authority.car, Payload(1), kNow_us, true)).finding,
            SignatureFinding::kFirst);
  for (int i = 2; i < 10; ++i) {
    const Judgement heard =
        ear.Hear(SignedBy(authority.car, Payload(static_cast<std::uint8_t>(i)), kNow_us, false));
    EXPECT_EQ(heard.finding, SignatureFinding::kConsistent);
    EXPECT_EQ(heard.signature_state(), 0);
  }
  // Somebody else under the same certificate.
  TestCertificate forger = authority.car;
  forger.key = KeyOf("forger");
  const Judgement forged = ear.Hear(SignedBy(forger, Payload(1), kNow_us, false));
  EXPECT_EQ(forged.finding, SignatureFinding::kConflict);
  EXPECT_EQ(forged.signature_state(), 0);
}

TEST(Verifier, AnotherKeyThanTheEstablishedOneIsInvalid) {
  const Authority authority;
  Ear ear;
  for (int i = 0; i < 60; ++i) {
    ear.Hear(SignedBy(authority.car, Payload(static_cast<std::uint8_t>(i)), kNow_us, i % 5 == 0));
  }
  TestCertificate forger = authority.car;
  forger.key = KeyOf("forger");
  const Judgement forged = ear.Hear(SignedBy(forger, Payload(1), kNow_us, true));
  EXPECT_EQ(forged.finding, SignatureFinding::kConflictEstablished);
  EXPECT_EQ(forged.signature_state(), 2);
  const Judgement honest = ear.Hear(SignedBy(authority.car, Payload(99), kNow_us, true));
  EXPECT_EQ(honest.signature_state(), 0);
}

// A forger who is heard first, then as often as the car: the car must never be called invalid.
TEST(Verifier, AForgerWhoIsFirstDoesNotGetTheRealCarRefused) {
  const Authority authority;
  TestCertificate forger = authority.car;
  forger.key = KeyOf("forger");
  Ear ear;
  for (int i = 0; i < 10; ++i) {
    ear.Hear(SignedBy(forger, Payload(static_cast<std::uint8_t>(i)), kNow_us, true));
  }
  for (int i = 0; i < 300; ++i) {
    const auto mark = static_cast<std::uint8_t>(i);
    ear.Hear(SignedBy(forger, Payload(mark), kNow_us, i % 5 == 0));
    EXPECT_EQ(
        ear.Hear(SignedBy(authority.car, Payload(mark), kNow_us, i % 5 == 0)).signature_state(), 0)
        << i;
  }
}

TEST(Verifier, CertificateThatAKnownIssuerDidNotMakeIsNotValid) {
  const Authority authority;
  Ear ear(authority.Anchors());
  // Names the issuer, signed by somebody else.
  TestCertificate false_issuer = authority.issuer;
  false_issuer.key = KeyOf("somebody else");
  const TestCertificate explicit_car = ExplicitCertificate(false_issuer, {.name = "false car"});
  const Judgement heard = ear.Hear(SignedBy(explicit_car, Payload(1), kNow_us, true));
  EXPECT_EQ(heard.finding, SignatureFinding::kBrokenChain);
  EXPECT_EQ(heard.signature_state(), 0);
  // Implicit: the key that follows is not the forger's.
  const TestCertificate implicit_car = ImplicitCertificate(false_issuer, {.name = "false car"});
  EXPECT_EQ(ear.Hear(SignedBy(implicit_car, Payload(1), kNow_us, true)).signature_state(), 2);
  // A car's certificate may not issue others.
  TestCertificate car_as_issuer = ExplicitCertificate(authority.issuer, {.name = "car b"});
  TrustAnchors anchors = authority.Anchors();
  EXPECT_EQ(anchors.AddIntermediate(car_as_issuer.bytes), std::nullopt);
  Ear strict(std::move(anchors));
  const TestCertificate child = ExplicitCertificate(car_as_issuer, {.name = "child"});
  EXPECT_EQ(strict.Hear(SignedBy(child, Payload(1), kNow_us, true)).finding,
            SignatureFinding::kBrokenChain);
}

TEST(Verifier, ExpiredOrUnpermittedCertificatesAreUnknownNotInvalid) {
  const Authority authority;
  Ear ear(authority.Anchors());
  const TestCertificate expired = ImplicitCertificate(
      authority.issuer, {.name = "expired", .valid_from_s = 690000000, .valid_hours = 1});
  EXPECT_EQ(ear.Hear(SignedBy(expired, Payload(1), kNow_us, true)).finding,
            SignatureFinding::kNotInTime);
  const TestCertificate other =
      ImplicitCertificate(authority.issuer, {.name = "other", .psid = 0x26});
  const Judgement heard = ear.Hear(SignedBy(other, Payload(1), kNow_us, true));
  EXPECT_EQ(heard.finding, SignatureFinding::kNotPermitted);
  EXPECT_EQ(heard.signature_state(), 0);
}

TEST(Verifier, BudgetAndTableAreBounded) {
  const Authority authority;
  Ear ear({}, {.most_certificates = 8, .checks_per_s = 5});
  int over = 0;
  for (int i = 0; i < 40; ++i) {
    const TestCertificate car =
        ImplicitCertificate(authority.issuer, {.name = "car " + std::to_string(i)});
    over +=
        ear.Hear(SignedBy(car, Payload(1), kNow_us, true)).finding == SignatureFinding::kOverBudget
            ? 1
            : 0;
    EXPECT_LE(ear.verifier().certificates(), 8u);
  }
  EXPECT_GE(over, 18);
}

// 787 real signatures of three certificates: one key each, and none with a bit flipped.
TEST(Verifier, RealUnitsAreConsistentThroughoutAndFlippedBitsAreNot) {
  V2VOUCH_NEEDS_OBU_DATA();
  std::map<std::string, int> findings;
  Verifier verifier({}, {});
  for (const UnitRecord& record : UnitRecords()) {
    if (!record.is_bsm || record.digest.empty()) continue;
    Octets scratch(kLongestDatagram);
    Datagram datagram;
    ReadDatagram(record.bytes, {}, scratch, datagram);
    ASSERT_TRUE(datagram.dot2);
    const Judgement judgement = verifier.Judge(*datagram.dot2, record.log_utime);
    ++findings[std::string(FindingName(judgement.finding))];
    EXPECT_EQ(HexText(judgement.digest), record.digest);
    EXPECT_EQ(judgement.signature_state(), 0);
  }
  int flipped_heard = 0, flipped_consistent = 0;
  for (const UnitRecord& record : UnitRecords()) {
    if (!record.is_bsm || record.digest.empty()) continue;
    Octets flipped = record.bytes;
    flipped[flipped.size() / 3] ^= 0x10;
    Octets scratch(kLongestDatagram);
    Datagram datagram;
    ReadDatagram(flipped, {}, scratch, datagram);
    if (!datagram.dot2) continue;
    ++flipped_heard;
    const Judgement judgement = verifier.Judge(*datagram.dot2, record.log_utime);
    flipped_consistent += judgement.finding == SignatureFinding::kConsistent ? 1 : 0;
  }
  EXPECT_EQ(findings["first"] + findings["consistent"] + findings["certificate_unknown"], 787);
  EXPECT_EQ(findings["first"], 3);
  EXPECT_GT(flipped_heard, 700);
  EXPECT_EQ(flipped_consistent, 0);
}

TEST(TrustAnchors, WhatCannotBeAnAnchorIsToldApart) {
  const Authority authority;
  TrustAnchors anchors;
  EXPECT_NE(anchors.AddAnchor(FromHex("8003")), std::nullopt);
  EXPECT_NE(anchors.AddAnchor(Joined(authority.root.bytes, Octets(1))), std::nullopt);
  EXPECT_NE(anchors.AddAnchor(authority.car.bytes), std::nullopt);
  EXPECT_EQ(anchors.size(), 0u);
}

}  // namespace
}  // namespace v2vouch::obu
