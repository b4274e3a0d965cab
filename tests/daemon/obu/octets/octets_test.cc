// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "daemon/obu/octets/bit_reader.h"
#include "daemon/obu/octets/bit_writer.h"
#include "daemon/obu/octets/byte_reader.h"

namespace v2vouch::obu {
namespace {

using Octets = std::vector<std::uint8_t>;

TEST(BitReader, ReadsAcrossBytesMostSignificantBitFirst) {
  const Octets bytes = {0b10110011, 0b01010101};
  BitReader reader(bytes);
  EXPECT_EQ(reader.Bits(3), 0b101u);
  EXPECT_EQ(reader.Bits(9), 0b100110101u);
  EXPECT_EQ(reader.left(), 4u);
  EXPECT_EQ(reader.position(), 12u);
}

TEST(BitReader, FirstFaultSticksAndNothingMovesAnyMore) {
  const Octets bytes = {0xFF};
  BitReader reader(bytes);
  EXPECT_EQ(reader.Bits(9), 0u);
  EXPECT_EQ(reader.fault().kind, FaultKind::kTruncated);
  EXPECT_EQ(reader.Bits(1), 0u);
  EXPECT_EQ(reader.left(), 8u);
  reader.Whole(3, 0, 1, "later");
  EXPECT_EQ(reader.fault().where, "bits");
}

TEST(BitReader, SpareCodesOfARangeAreAFaultWithFieldAndValue) {
  const Octets bytes = {0xFF};
  BitReader reader(bytes);
  reader.Whole(2, 0, 2, "brakeBoost");
  EXPECT_EQ(reader.fault(), (Fault{FaultKind::kOutOfRange, "brakeBoost", 3}));
}

TEST(BitReader, LengthsOfOneAndTwoBytesAndNoPieces) {
  EXPECT_EQ(BitReader(Octets{0x7F}).Length("x"), 127u);
  EXPECT_EQ(BitReader(Octets{0x80, 0xAD}).Length("x"), 173u);
  EXPECT_EQ(BitReader(Octets{0xBF, 0xFF}).Length("x"), 16383u);
  const Octets bytes = {0xC1, 0x00};
  BitReader pieces(bytes);
  pieces.Length("x");
  EXPECT_EQ(pieces.fault().kind, FaultKind::kFragmented);
}

TEST(BitReader, UnknownExtensionsArePassedOverByTheirLengths) {
  // Three announced (count 2 + 1), first and third there with one and two octets; then 0xAB.
  Octets bytes(16);
  BitWriter writer(bytes);
  writer.Bits(2, 7);
  writer.Bits(0b101, 3);
  writer.Length(1);
  writer.Bits(0x55, 8);
  writer.Length(2);
  writer.Bits(0x1234, 16);
  writer.Bits(0xAB, 8);
  BitReader reader(bytes);
  reader.SkipExtensions("x");
  EXPECT_EQ(reader.Bits(8), 0xABu);
}

TEST(BitReader, AHundredExtensionsAreRefusedNotWalked) {
  Octets bytes(64, 0xFF);
  BitWriter writer(bytes);
  writer.Flag(true);
  writer.Length(100);
  BitReader reader(bytes);
  reader.SkipExtensions("x");
  EXPECT_EQ(reader.fault().kind, FaultKind::kBadLength);
}

// Property: what a writer wrote, a reader reads, at any offset.
TEST(BitWriterProperty, ReaderGetsBackWhatWasWritten) {
  std::mt19937_64 rng(19);
  for (int trial = 0; trial < 300; ++trial) {
    Octets bytes(512, 0xA5);
    BitWriter writer(bytes);
    std::vector<std::pair<std::uint64_t, int>> written;
    for (int i = 0; i < 40; ++i) {
      const int count = 1 + static_cast<int>(rng() % 64);
      const std::uint64_t value = count == 64 ? rng() : rng() & ((std::uint64_t{1} << count) - 1);
      writer.Bits(value, count);
      written.emplace_back(value, count);
    }
    ASSERT_TRUE(writer.ok());
    BitReader reader(bytes);
    for (const auto& [value, count] : written) ASSERT_EQ(reader.Bits(count), value);
  }
}

TEST(BitWriter, BufferTooSmallSticks) {
  Octets bytes(1);
  BitWriter writer(bytes);
  writer.Bits(0, 9);
  EXPECT_FALSE(writer.ok());
  writer.Bits(0, 1);
  EXPECT_FALSE(writer.ok());
}

TEST(ByteReader, OerLengthsDifferFromUperLengths) {
  EXPECT_EQ(ByteReader(Octets{0x7F}).Length("x"), 127u);
  EXPECT_EQ(ByteReader(Octets{0x81, 0xAD}).Length("x"), 173u);
  EXPECT_EQ(ByteReader(Octets{0x82, 0x01, 0x00}).Length("x"), 256u);
  const Octets bytes = {0x88, 1, 2, 3, 4, 5, 6, 7, 8};
  ByteReader endless(bytes);
  endless.Length("x");
  EXPECT_EQ(endless.fault().kind, FaultKind::kBadLength);
}

TEST(ByteReader, LengthBeyondTheEndIsAFault) {
  const Octets bytes = {0x84, 0xFF, 0xFF, 0xFF, 0xFF, 0x00};
  ByteReader reader(bytes);
  EXPECT_TRUE(reader.Block("x").empty());
  EXPECT_EQ(reader.fault().kind, FaultKind::kTruncated);
}

TEST(ByteReader, QuantityAboveItsCapIsAFault) {
  const Octets bytes = {0x02, 0xFF, 0xFF};
  ByteReader reader(bytes);
  EXPECT_EQ(reader.Quantity(64, "x"), 0u);
  EXPECT_EQ(reader.fault(), (Fault{FaultKind::kBadLength, "x", 65535}));
}

TEST(Fault, TextNamesKindPlaceAndFigure) {
  EXPECT_EQ(FaultText({FaultKind::kOutOfRange, "heading", 28801}), "out_of_range: heading (28801)");
  EXPECT_EQ(FaultText({FaultKind::kTruncated, "WSMP"}), "truncated: WSMP");
  EXPECT_EQ(FaultText({}), "");
  for (int kind = 0; kind < static_cast<int>(FaultKind::kCount); ++kind) {
    EXPECT_FALSE(FaultName(static_cast<FaultKind>(kind)).empty()) << kind;
  }
}

}  // namespace
}  // namespace v2vouch::obu
