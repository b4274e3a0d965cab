// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/security/p256.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/test_authority.h"

namespace v2vouch::obu {
namespace {

CurvePoint PointOf(const Octets& compressed) {
  CurvePoint point;
  point.form = compressed[0] == 2 ? CurvePoint::Form::kEven : CurvePoint::Form::kOdd;
  point.x = Bytes(compressed).subspan(1);
  return point;
}
Hash HashOf(const Octets& bytes) {
  Hash hash{};
  std::copy_n(bytes.begin(), 32, hash.begin());
  return hash;
}

// FIPS 180-4, example of one block.
TEST(Sha256Of, AgreesWithTheStandard) {
  const Octets a = {'a'}, bc = {'b', 'c'};
  EXPECT_EQ(HexText(Sha256Of({a, bc})),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

// Public numbers: with the hash halved it holds.
TEST(ReconstructedKey, PublishedImplicitCertificateGivesItsHoldersKey) {
  V2VOUCH_NEEDS_OBU_DATA();
  const Octets text = ObuFile("ieee1609/ecqv_vector.json");
  const auto json = nlohmann::json::parse(text.begin(), text.end());
  const Octets tbs = FromHex(json["tbsCert"]);
  const Octets p = FromHex(json["P"]);
  const Octets issuer = FromHex(json["QCA"]);
  Point issuer_point{};
  std::copy_n(issuer.begin(), 65, issuer_point.begin());
  const auto key = ReconstructedKey(Sha256Of({tbs, p}), PointOf(p), issuer_point);
  ASSERT_TRUE(key);
  // The holder's private key must sign what this key verifies.
  TestKey holder;
  holder.secret = FromHex(json["expected_private_key_dU"]);
  const Octets hash = Sha256({1, 2, 3});
  const TestSignature signature = Sign(holder, hash);
  const auto public_key = PublicKey::FromPoint(*key);
  ASSERT_TRUE(public_key);
  EXPECT_TRUE(public_key->Verifies(HashOf(hash), Bytes(signature.r_point).subspan(1), signature.s));
}

TEST(RecoveredKeys, GiveTheSignersKeyAndAnotherForAFlippedBit) {
  const TestKey key = KeyOf("a");
  const Point point = *Decompressed(PointOf(key.compressed));
  for (int i = 0; i < 20; ++i) {
    Octets hash = Sha256({static_cast<std::uint8_t>(i)});
    const TestSignature signature = Sign(key, hash);
    CurvePoint r = PointOf(signature.r_point);
    EXPECT_EQ(RecoveredKeys(HashOf(hash), r, signature.s), std::vector<Point>{point});
    r.form = CurvePoint::Form::kXOnly;
    const auto both = RecoveredKeys(HashOf(hash), r, signature.s);
    EXPECT_EQ(both.size(), 2u);
    EXPECT_NE(std::ranges::find(both, point), both.end());
    hash[7] ^= 1;
    r = PointOf(signature.r_point);
    EXPECT_NE(RecoveredKeys(HashOf(hash), r, signature.s), std::vector<Point>{point});
    const auto public_key = PublicKey::FromPoint(point);
    EXPECT_FALSE(public_key->Verifies(HashOf(hash), r.x, signature.s));
  }
}

TEST(P256, NumbersThatCannotBeAreRefusedNotUsed) {
  const Octets zero(32), full(32, 0xFF);
  const TestKey key = KeyOf("a");
  CurvePoint none;
  none.form = CurvePoint::Form::kOdd;
  none.x = full;  // Above the field's prime.
  EXPECT_FALSE(Decompressed(none));
  EXPECT_TRUE(RecoveredKeys(Hash{}, none, full).empty());
  EXPECT_TRUE(RecoveredKeys(Hash{}, PointOf(key.compressed), zero).empty());
  EXPECT_TRUE(RecoveredKeys(Hash{}, PointOf(key.compressed), full).empty());
  EXPECT_FALSE(PublicKey::FromPoint(Point{}));
  const auto good = PublicKey::FromPoint(*Decompressed(PointOf(key.compressed)));
  EXPECT_FALSE(good->Verifies(Hash{}, zero, zero));
  EXPECT_FALSE(good->Verifies(Hash{}, full, full));
  EXPECT_FALSE(good->Verifies(Hash{}, {}, {}));
}

}  // namespace
}  // namespace v2vouch::obu
