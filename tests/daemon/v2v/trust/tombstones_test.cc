// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/trust/tombstones.h"

#include <gtest/gtest.h>

namespace v2vouch {
namespace {

const TombstoneConfig kConfig;
constexpr CertificateDigest kNone{};

Timestamp At(double time_s) { return FromMicros(1'000'000'000) + FromSeconds(time_s); }

Tombstones::Stone Liar(SenderId sender, double last_s) {
  return {.sender = sender,
          .certificate = {1, 2, 3, 4, 5, 6, 7, 8},
          .last = At(last_s),
          .p_O = {100.0, 0.0},
          .v_O = {10.0, 0.0},
          .penalty = {.state = TrustState::kSuspect, .suspicions = 2},
          .place = {}};
}

TEST(Tombstones, ANewIdThatGoesOnInTheLiarsPlaceInherits) {
  Tombstones stones;
  stones.Set(Liar(7, 0.0));
  const auto stone = stones.TakeFor(8, kNone, At(1.0), At(1.0), {111.0, 1.0}, {10.5, 0.0}, kConfig);
  ASSERT_TRUE(stone.has_value());
  EXPECT_EQ(stone->sender, 7u);
  EXPECT_EQ(stone->penalty.suspicions, 2);
  EXPECT_FALSE(stones.TakeFor(9, kNone, At(1.0), At(1.0), {111.0, 1.0}, {10.5, 0.0}, kConfig))
      << "it is taken once";
}

TEST(Tombstones, OtherCarsInheritNothing) {
  Tombstones stones;
  stones.Set(Liar(7, 0.0));
  EXPECT_FALSE(stones.TakeFor(8, kNone, At(-0.5), At(1.0), {110.0, 0.0}, {10.0, 0.0}, kConfig))
      << "was heard beside the liar";
  EXPECT_FALSE(stones.TakeFor(8, kNone, At(1.0), At(1.0), {125.0, 0.0}, {10.0, 0.0}, kConfig))
      << "too far";
  EXPECT_FALSE(stones.TakeFor(8, kNone, At(1.0), At(1.0), {110.0, 0.0}, {-10.0, 0.0}, kConfig))
      << "drives elsewhere";
  EXPECT_FALSE(stones.TakeFor(8, kNone, At(11.0), At(11.0), {210.0, 0.0}, {10.0, 0.0}, kConfig))
      << "too late";
}

TEST(Tombstones, ACertificateIsRecognisedAnywhere) {
  Tombstones stones;
  stones.Set(Liar(7, 0.0));
  EXPECT_TRUE(stones.TakeFor(8, {1, 2, 3, 4, 5, 6, 7, 8}, At(-5.0), At(1.0), {500.0, 0.0},
                             {0.0, 0.0}, kConfig));
}

TEST(Tombstones, TheOldestGivesWayAndACleanSenderIsForgotten) {
  Tombstones stones;
  for (SenderId sender = 1; sender <= 33; ++sender) {
    stones.Set(Liar(sender, static_cast<double>(sender)));
  }
  EXPECT_EQ(stones.Find(1), nullptr);
  EXPECT_NE(stones.Find(2), nullptr);
  EXPECT_NE(stones.Find(33), nullptr);
  stones.Remove(33);
  EXPECT_EQ(stones.Find(33), nullptr);
}

}  // namespace
}  // namespace v2vouch
