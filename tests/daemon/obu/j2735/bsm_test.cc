// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/j2735/bsm.h"

#include <gtest/gtest.h>

#include "daemon/obu/j2735/message_frame.h"
#include "daemon/obu/octets/bit_writer.h"
#include "tests/support/obu_samples.h"
#include "tests/support/obu_wrap.h"

namespace v2vouch::obu {
namespace {

Octets Encoded(const Bsm& bsm) {
  Octets bytes(2304);
  std::size_t size = 0;
  EXPECT_FALSE(WriteBsmFrame(bsm, bytes, size));
  bytes.resize(size);
  return bytes;
}

// Every field of two cores, by name.
void ExpectSame(const BsmCore& ours, const BsmCore& theirs, const std::string& which) {
  for (const CoreField& field : CoreFields()) {
    EXPECT_EQ(ours.*field.member, theirs.*field.member) << which << " " << field.name;
  }
  EXPECT_EQ(ours.id, theirs.id) << which;
}

TEST(ReadBsm, PublishedPayloadsHaveTheirPublishedValuesInAll25Fields) {
  V2VOUCH_NEEDS_OBU_DATA();
  const auto vectors = BsmVectors();
  EXPECT_EQ(vectors.size(), 167u);
  int index = 0;
  for (const BsmVector& vector : vectors) {
    Bsm bsm;
    const Fault fault = ReadBsmFrame(vector.bytes, bsm);
    ASSERT_FALSE(fault) << index << FaultText(fault);
    ExpectSame(bsm.core, vector.core, std::to_string(index));
    EXPECT_EQ(bsm.has_frame_extensions, vector.has_frame_extensions);
    EXPECT_FALSE(bsm.tail_fault) << index << FaultText(bsm.tail_fault);
    ++index;
  }
}

TEST(ReadBsm, PublishedPayloadsAreWrittenAgainAsTheyWere) {
  V2VOUCH_NEEDS_OBU_DATA();
  int same = 0;
  for (const BsmVector& vector : BsmVectors()) {
    if (vector.has_frame_extensions) continue;  // Whose extensions are not kept.
    Bsm bsm;
    ASSERT_FALSE(ReadBsmFrame(vector.bytes, bsm));
    EXPECT_EQ(HexText(Encoded(bsm)), HexText(vector.bytes));
    ++same;
  }
  EXPECT_EQ(same, 166);
}

TEST(ReadBsm, WhatTheStandardDoesNotDefineIsRefusedWithAReason) {
  V2VOUCH_NEEDS_OBU_DATA();
  const auto rejects = BsmRejects();
  EXPECT_EQ(rejects.size(), 21u);
  for (const BsmReject& reject : rejects) {
    Bsm bsm;
    const Fault fault = ReadBsmFrame(reject.bytes, bsm);
    EXPECT_TRUE(fault) << reject.why;
    EXPECT_FALSE(fault.where.empty()) << reject.why;
  }
}

// Failure mode 7 and 8: each code for "unavailable" alone, and each limit, through writer and
// reader.
TEST(ReadBsm, EachLimitAndEachUnavailableCodeComesBackAlone) {
  for (const CoreField& field : CoreFields()) {
    for (const std::int32_t raw : {field.low, field.high, field.unavailable.value_or(field.low)}) {
      Bsm bsm;
      bsm.core.id = 0x12345678;
      bsm.core.*field.member = raw;
      const Octets bytes = Encoded(bsm);
      EXPECT_EQ(bytes.size(), 40u);  // 293 bits are 37 bytes, behind a header of 3.
      Bsm again;
      ASSERT_FALSE(ReadBsmFrame(bytes, again));
      ExpectSame(again.core, bsm.core, std::string(field.name));
    }
    Bsm beyond;
    beyond.core.*field.member = field.high + 1;
    Octets bytes(100);
    std::size_t size = 0;
    EXPECT_EQ(WriteBsmFrame(beyond, bytes, size),
              (Fault{FaultKind::kOutOfRange, field.name, field.high + 1}));
    EXPECT_EQ(size, 0u);
  }
}

TEST(ReadBsm, IdKeepsItsOctetsAndTheirOrder) {
  for (const std::uint32_t id : {0x00000001U, 0x0A000000U, 0xFF00FF00U, 0x00140020U}) {
    Bsm bsm;
    bsm.core.id = id;
    Bsm again;
    ASSERT_FALSE(ReadBsmFrame(Encoded(bsm), again));
    EXPECT_EQ(again.core.id, id);
  }
}

// Figures of the table against SI values worked out by hand from J2735's data elements.
TEST(CoreFields, UnitsAreThoseOfTheStandard) {
  const auto si = [](std::string_view name, double raw) {
    for (const CoreField& field : CoreFields()) {
      if (field.name == name) return raw * field.unit;
    }
    return -1.0;
  };
  EXPECT_DOUBLE_EQ(si("lat", 404740535), 40.4740535);
  EXPECT_DOUBLE_EQ(si("elev", 15058), 1505.8);
  EXPECT_DOUBLE_EQ(si("speed", 1137), 22.74);
  EXPECT_DOUBLE_EQ(si("heading", 16478), 205.975);
  EXPECT_DOUBLE_EQ(si("semiMajor", 186), 9.3);
  EXPECT_DOUBLE_EQ(si("accelSet_long", -14), -0.14);
  EXPECT_DOUBLE_EQ(si("accelSet_yaw", 100), 1.0);
  EXPECT_DOUBLE_EQ(si("angle", 10), 15.0);
  EXPECT_DOUBLE_EQ(si("length", 570), 5.7);
  EXPECT_NEAR(si("orientation", 8192), 45.0, 0.001);
  EXPECT_DOUBLE_EQ(si("secMark", 59299), 59.299);
}

// Failure mode 11: what nobody here knows costs nothing.
TEST(ReadBsm, UnknownItemsRegionsAndExtensionsDoNotCostTheCore) {
  Bsm bsm;
  bsm.core.speed = 1137;
  const Octets content(200, 0x5A);
  const BitView octets{content, 0, content.size() * 8};
  bsm.part_two[0] = {63, octets};
  bsm.part_two[1] = {0, {content, 3, 16}};  // Item 0 with content that cannot be read.
  bsm.part_two_count = 2;
  bsm.regional[0] = {128, octets};
  bsm.regional_count = 1;
  Octets bytes = Encoded(bsm);
  Bsm again;
  ASSERT_FALSE(ReadBsmFrame(bytes, again));
  EXPECT_EQ(again.core.speed, 1137);
  EXPECT_EQ(again.part_two_count, 2u);
  EXPECT_EQ(again.regional_count, 1u);
  EXPECT_EQ(again.regional[0].id, 128);
  EXPECT_EQ(again.unread_items, 1);
  EXPECT_FALSE(again.tail_fault);
  EXPECT_EQ(Encoded(again), bytes);

  // The same with the BSM's extension bit set and one addition of two octets.
  MessageFrame frame;
  ASSERT_FALSE(ReadMessageFrame(bytes, frame));
  Octets value(frame.value.begin(), frame.value.end());
  value.resize(value.size() + 8);
  // Where the additions go: 3 + 290 bits, the two lists, each octet string behind its length.
  const std::size_t end = 293 + 3 + (6 + 16 + 1600) + (6 + 8 + 16) + 2 + (8 + 16 + 1600);
  Octets extended(value.size());
  BitWriter writer(extended);
  writer.Flag(true);
  writer.Copy({value, 1, end - 1});
  writer.Bits(0, 7);  // One addition,
  writer.Flag(true);  // there,
  writer.Length(2);
  writer.Bits(0xBEEF, 16);
  Bsm with_additions;
  ASSERT_FALSE(ReadBsm(std::span(extended).first(writer.octets()), with_additions));
  EXPECT_EQ(with_additions.core.speed, 1137);
  EXPECT_TRUE(with_additions.has_bsm_extensions);
  EXPECT_FALSE(with_additions.tail_fault) << FaultText(with_additions.tail_fault);
}

TEST(ReadBsm, ListOfItemsThatEndsTooEarlyIsToldAndTheCoreDelivered) {
  Bsm bsm;
  const Octets content(100, 0x11);
  bsm.part_two[0] = {1, {content, 0, 800}};
  bsm.part_two_count = 1;
  const Octets bytes = Encoded(bsm);
  MessageFrame frame;
  ASSERT_FALSE(ReadMessageFrame(bytes, frame));
  Bsm again;
  ASSERT_FALSE(ReadBsm(frame.value.first(60), again));
  EXPECT_EQ(again.tail_fault, (Fault{FaultKind::kTruncated, "partII"}));
  EXPECT_EQ(again.part_two_count, 0u);
}

TEST(ReadBsm, EveryPrefixIsRefused) {
  V2VOUCH_NEEDS_OBU_DATA();
  for (const BsmVector& vector : BsmVectors()) {
    for (std::size_t size = 0; size < vector.bytes.size(); ++size) {
      const Octets prefix(vector.bytes.begin(),
                          vector.bytes.begin() + static_cast<std::ptrdiff_t>(size));
      Bsm bsm;
      EXPECT_TRUE(ReadBsmFrame(prefix, bsm)) << size;
    }
  }
}

}  // namespace
}  // namespace v2vouch::obu
