// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/j2735/part_two.h"

#include <gtest/gtest.h>

#include "daemon/obu/j2735/message_frame.h"
#include "daemon/obu/octets/bit_writer.h"
#include "tests/support/obu_samples.h"

namespace v2vouch::obu {
namespace {

BitView Written(const BitWriter& writer, const Octets& bytes) { return {bytes, 0, writer.bits()}; }

TEST(SafetyExtensions, HardBrakingIsEventSeven) {
  Octets bytes(16);
  BitWriter writer(bytes);
  writer.Flag(false);
  writer.Bits(0b1000, 4);  // Events only.
  writer.Flag(false);
  writer.Bits(0b0000000100000, 13);
  SafetyExtensions safety;
  ASSERT_FALSE(ReadSafetyExtensions(Written(writer, bytes), safety));
  EXPECT_EQ(safety.events, 1U << 7);
  EXPECT_FALSE(safety.radius_of_curve);
}

TEST(SafetyExtensions, JackknifeOf2024IsReadWithoutASwitch) {
  Octets bytes(16);
  BitWriter writer(bytes);
  writer.Flag(false);
  writer.Bits(0b1000, 4);
  writer.Flag(true);  // Longer than 13 bits.
  writer.Length(14);
  writer.Bits(1, 14);
  SafetyExtensions safety;
  ASSERT_FALSE(ReadSafetyExtensions(Written(writer, bytes), safety));
  EXPECT_EQ(safety.events, 1U << 13);
}

TEST(SafetyExtensions, WhatCameBeforeTheFaultStays) {
  Octets bytes(16);
  BitWriter writer(bytes);
  writer.Flag(false);
  writer.Bits(0b1100, 4);
  writer.Flag(false);
  writer.Bits(1, 13);
  writer.Flag(false);
  writer.Bits(0, 2);
  writer.Bits(22, 5);  // 23 points, none there.
  SafetyExtensions safety;
  EXPECT_TRUE(ReadSafetyExtensions(Written(writer, bytes), safety));
  EXPECT_EQ(safety.events, 1U << 12);
  EXPECT_FALSE(safety.path_points);
}

TEST(SafetyExtensions, RealUnitsDriveStraightAndHavePaths) {
  V2VOUCH_NEEDS_OBU_DATA();
  int with_safety = 0, straight = 0, unread = 0, jackknife = 0, with_height = 0;
  for (const BsmVector& vector : BsmVectors()) {
    Bsm bsm;
    ASSERT_FALSE(ReadBsmFrame(vector.bytes, bsm));
    unread += bsm.unread_items;
    if (bsm.safety) {
      ++with_safety;
      straight += bsm.safety->radius_of_curve == 32767 ? 1 : 0;
      jackknife += bsm.safety->events.value_or(0) >> 13 & 1;
    }
    if (bsm.supplemental && bsm.supplemental->height == 38) ++with_height;
  }
  // As two other decoders found (notes of the data set).
  EXPECT_EQ(with_safety, 158);
  EXPECT_EQ(straight, 148);
  EXPECT_EQ(jackknife, 1);
  EXPECT_EQ(with_height, 76);
  EXPECT_EQ(unread, 1);  // Classes of ITIS, which nobody here needs: the item is left there.
}

TEST(SupplementalExtensions, ClassRoleAndHeightAreRead) {
  Octets bytes(32);
  BitWriter writer(bytes);
  writer.Flag(false);
  writer.Bits(0b1110000000, 10);
  writer.Bits(25, 8);  // Class.
  writer.Flag(false);
  writer.Bits(0b010000000, 9);  // Role only.
  writer.Flag(false);
  writer.Bits(9, 5);
  writer.Flag(false);
  writer.Bits(0b1000, 4);  // Height only.
  writer.Bits(60, 7);
  SupplementalExtensions supplemental;
  ASSERT_FALSE(ReadSupplementalExtensions(Written(writer, bytes), supplemental));
  EXPECT_EQ(supplemental.vehicle_class, 25);
  EXPECT_EQ(supplemental.role, 9);
  EXPECT_EQ(supplemental.height, 60);
}

}  // namespace
}  // namespace v2vouch::obu
