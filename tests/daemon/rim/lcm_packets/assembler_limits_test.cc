// SPDX-License-Identifier: Apache-2.0
// Memory and work, whatever comes.
#include <gtest/gtest.h>

#include <random>

#include "daemon/rim/lcm_packets/assembler.h"
#include "tests/support/lcm_datagrams.h"

namespace v2vouch::lcm_packets {
namespace {

using testing::FragmentDatagram;
using testing::Fragments;
using testing::Octets;
using testing::Pattern;
using testing::WithChannel;

constexpr Sender kCar{0x0A000001, 40000};

Sender Stranger(std::size_t number) {
  return {0x0A000100 + static_cast<std::uint32_t>(number / 60000),
          static_cast<std::uint16_t>(number % 60000 + 1)};
}

bool All(std::string_view) { return true; }

std::uint64_t CountOf(const Assembler& assembler, PacketFault fault) {
  return assembler.counts()[static_cast<std::size_t>(fault)];
}

// The first fragment of a message of which no more will come.
Octets Announcement(std::uint32_t sequence, std::uint32_t size, std::uint16_t count) {
  return FragmentDatagram({sequence, size, 0, 0, count}, WithChannel("RADAR_FRONT", Octets(20, 1)));
}

TEST(AssemblerLimits, TwoThousandAnnouncementsOf256MegabytesReserveNothing) {
  Assembler assembler(All);
  for (std::uint32_t i = 0; i < 2000; ++i) {
    assembler.Take(Announcement(i, 256U << 20U, 5000), Stranger(i), i);
  }
  EXPECT_EQ(CountOf(assembler, PacketFault::kTooLarge), 2000u);
  EXPECT_EQ(assembler.reserved_bytes(), 0u);
}

TEST(AssemblerLimits, OneSenderGetsItsShareAndTheNewestMessagesWin) {
  const AssemblerLimits limits;
  Assembler assembler(All, limits);
  for (std::uint32_t i = 0; i < 1000; ++i) {
    assembler.Take(Announcement(i, 100, 2), kCar, i);
    ASSERT_LE(assembler.half_messages(), limits.sender_messages);
  }
  EXPECT_EQ(CountOf(assembler, PacketFault::kRoom), 1000 - limits.sender_messages);
  // The newest is among those left.
  EXPECT_TRUE(assembler.Take(FragmentDatagram({999, 100, 20, 1, 2}, Octets(80, 2)), kCar, 1000));
}

// What was announced takes nothing: only what came does, in whatever order.
TEST(AssemblerLimits, MemoryIsTakenForWhatCame) {
  Assembler assembler(All);
  assembler.Take(Announcement(1, 60U << 20U, 2000), kCar, 1);
  assembler.Take(FragmentDatagram({1, 60U << 20U, 50U << 20U, 1900, 2000}, Octets(1000, 1)), kCar,
                 2);
  EXPECT_EQ(assembler.half_messages(), 1u);
  EXPECT_LT(assembler.reserved_bytes(), 3000u);
  // Fragments of one byte each, which take most beside their bytes: that is counted, too.
  for (std::uint16_t i = 1; i < 1000; ++i) {
    assembler.Take(FragmentDatagram({2, 65535, i * 2U, i, 65535}, {1}), kCar, 3);
  }
  EXPECT_GT(assembler.reserved_bytes(), 999u * 100);
}

TEST(AssemblerLimits, BytesAreBoundedPerSenderAndInAll) {
  AssemblerLimits limits;
  limits.sender_bytes = 1U << 20U;
  limits.all_bytes = 3U << 20U;
  Assembler assembler(All, limits);
  std::mt19937_64 rng(5);
  for (std::uint32_t i = 0; i < 3000; ++i) {
    const auto number = static_cast<std::uint16_t>(rng() % 300);
    const auto sequence = static_cast<std::uint32_t>(rng() % 4);
    assembler.Take(
        FragmentDatagram({sequence, 300 * 8000, number * 8000U, number, 300},
                         number == 0 ? WithChannel("A", Octets(8000, 1)) : Octets(8000, 1)),
        Stranger(rng() % 6), i * 10);
    ASSERT_LE(assembler.reserved_bytes(), limits.all_bytes);
  }
  EXPECT_GT(CountOf(assembler, PacketFault::kRoom), 0u);
}

TEST(AssemblerLimits, ManySendersStayWithinTheLimitsOfAll) {
  const AssemblerLimits limits;
  Assembler assembler(All, limits);
  std::mt19937_64 rng(1);
  for (std::uint32_t i = 0; i < 30'000; ++i) {
    const auto size = static_cast<std::uint32_t>(1000 + rng() % (1U << rng() % 26));
    const auto count = static_cast<std::uint16_t>(2 + size / 60'000 + rng() % 20);
    assembler.Take(Announcement(i, size, count), Stranger(i), i * 5);
    ASSERT_LE(assembler.half_messages(), limits.all_messages);
    ASSERT_LE(assembler.reserved_bytes(), limits.all_bytes);
  }
}

// A message on its way comes through whatever others announce: enormous ones, or as many as they
// like, 20 of them between two of its fragments.
TEST(AssemblerLimits, AMessageOnItsWaySurvivesAFloodOfAnnouncements) {
  struct Flood {
    std::uint32_t size;
    std::uint16_t count;
  };
  for (const Flood& flood : {Flood{60U << 20U, 2000}, Flood{600'000, 20}, Flood{100, 2}}) {
    Assembler assembler(All);
    const Octets data = Pattern(8'000'000, 3);
    const auto fragments = Fragments(77, "IMAGE", data);
    std::int64_t now_us = 0;
    std::size_t stranger = 0;
    const auto strangers = [&](int count) {
      for (int i = 0; i < count; ++i) {
        now_us += 3;
        assembler.Take(Announcement(1, flood.size, flood.count), Stranger(stranger++), now_us);
      }
    };
    strangers(1000);
    bool is_complete = false;
    for (const Octets& fragment : fragments) {
      now_us += 3;
      const auto message = assembler.Take(fragment, kCar, now_us);
      if (message) {
        is_complete = true;
        EXPECT_EQ(Octets(message->bytes.begin(), message->bytes.end()), data);
      }
      strangers(20);
    }
    EXPECT_TRUE(is_complete) << flood.size;
  }
}

}  // namespace
}  // namespace v2vouch::lcm_packets
