// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/j2735/message_frame.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/obu_samples.h"

namespace v2vouch::obu {
namespace {

TEST(MessageFrame, OtherMessagesAreNamedNotTakenForBsms) {
  Bsm bsm;
  EXPECT_EQ(ReadBsmFrame(FromHex("00130100"), bsm), (Fault{FaultKind::kNotBsm, "messageId", 19}));
  // 32 is PSM, and looks like the PSID of BSMs.
  EXPECT_EQ(ReadBsmFrame(FromHex("00200100"), bsm), (Fault{FaultKind::kNotBsm, "messageId", 32}));
  EXPECT_EQ(MessageName(32), "PSM");
  EXPECT_EQ(MessageName(999), "");
}

// Failure mode 2: lengths of one and of two bytes, on both sides of each step.
TEST(MessageFrame, SizesAroundEveryStepOfTheLengthComeBack) {
  for (const std::size_t size : {37u, 127u, 128u, 255u, 256u, 400u, 1400u}) {
    Octets content(size, 0x14);
    Bsm bsm;
    // 37 octets of core; the item takes its header and what is left.
    if (size > 41) {
      const std::size_t rest = size * 8 - 293 - 3 - 6;
      const std::size_t octets = (rest - (rest > 8 + 127 * 8 ? 16 : 8)) / 8;
      bsm.part_two[0] = {5, {content, 0, octets * 8}};
      bsm.part_two_count = 1;
    }
    Octets bytes(2304);
    std::size_t written = 0;
    ASSERT_FALSE(WriteBsmFrame(bsm, bytes, written));
    bytes.resize(written);
    MessageFrame frame;
    ASSERT_FALSE(ReadMessageFrame(bytes, frame));
    EXPECT_EQ(frame.value.size(), size);
    EXPECT_EQ(frame.trailing, 0u);
    Bsm again;
    ASSERT_FALSE(ReadBsmFrame(bytes, again));
    EXPECT_EQ(again.core, bsm.core);
    EXPECT_EQ(again.part_two_count, bsm.part_two_count);
  }
}

TEST(MessageFrame, BufferTooSmallIsToldAndNothingWritten) {
  Bsm bsm;
  for (const std::size_t room : {0u, 3u, 20u, 39u}) {
    Octets bytes(room);
    std::size_t size = 99;
    EXPECT_EQ(WriteBsmFrame(bsm, bytes, size).kind, FaultKind::kTooLong) << room;
    EXPECT_EQ(size, 0u);
  }
}

// Property: decode(encode(x)) = x for any core inside the ranges.
TEST(MessageFrameProperty, AnyCoreComesBack) {
  std::mt19937_64 rng(2735);
  for (int trial = 0; trial < 2000; ++trial) {
    Bsm bsm;
    bsm.core.id = static_cast<std::uint32_t>(rng());
    for (const CoreField& field : CoreFields()) {
      const auto range = static_cast<std::uint64_t>(std::int64_t{field.high} - field.low + 1);
      bsm.core.*field.member =
          static_cast<std::int32_t>(field.low + static_cast<std::int64_t>(rng() % range));
    }
    Octets bytes(64);
    std::size_t size = 0;
    ASSERT_FALSE(WriteBsmFrame(bsm, bytes, size));
    bytes.resize(size);
    Bsm again;
    ASSERT_FALSE(ReadBsmFrame(bytes, again));
    ASSERT_EQ(again.core, bsm.core);
  }
}

// Failure mode 13: one figure too large must not stop a sender.
TEST(Saturate, AnythingBecomesAMessageThatCanBeSent) {
  std::mt19937_64 rng(13);
  for (int trial = 0; trial < 500; ++trial) {
    Bsm bsm;
    for (const CoreField& field : CoreFields()) {
      bsm.core.*field.member = static_cast<std::int32_t>(rng());
    }
    Saturate(bsm.core);
    Octets bytes(64);
    std::size_t size = 0;
    ASSERT_FALSE(WriteBsmFrame(bsm, bytes, size));
  }
  BsmCore core;
  EXPECT_EQ(Saturate(core), 0);
  core.speed = 20000;
  core.accel_long = -9999;
  EXPECT_EQ(Saturate(core), 2);
  EXPECT_EQ(core.speed, 8190);  // As fast as can be told, not "unavailable".
  EXPECT_EQ(core.accel_long, -2000);
}

}  // namespace
}  // namespace v2vouch::obu
