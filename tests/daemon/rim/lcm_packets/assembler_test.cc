// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/lcm_packets/assembler.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "tests/support/lcm_datagrams.h"

namespace v2vouch::lcm_packets {
namespace {

using testing::FragmentDatagram;
using testing::Fragments;
using testing::Octets;
using testing::Pattern;
using testing::ShortDatagram;
using testing::WithChannel;

constexpr Sender kCar{0x0A000001, 40000};
constexpr Sender kOther{0x0A000001, 40001};

// Feeds it, 1 ms a datagram, and keeps what came out.
class Bench {
 public:
  Bench() : assembler_([](std::string_view channel) { return channel != "UNWANTED"; }) {}
  explicit Bench(const AssemblerLimits& limits)
      : assembler_([](std::string_view channel) { return channel != "UNWANTED"; }, limits) {}

  // Each datagram lies in memory of exactly its size.
  bool Feed(const Octets& datagram, const Sender& from = kCar) {
    now_us_ += 1000;
    const auto message = assembler_.Take(datagram, from, now_us_);
    if (!message) return false;
    channel_ = message->channel;
    bytes_.assign(message->bytes.begin(), message->bytes.end());
    return true;
  }
  void Wait(std::int64_t us) { now_us_ += us; }
  Assembler& assembler() { return assembler_; }
  [[nodiscard]] const std::string& channel() const { return channel_; }
  [[nodiscard]] const Octets& bytes() const { return bytes_; }
  [[nodiscard]] std::uint64_t CountOf(PacketFault fault) const {
    return assembler_.counts()[static_cast<std::size_t>(fault)];
  }
  [[nodiscard]] std::uint64_t AllCounts() const {
    std::uint64_t sum = 0;
    for (const std::uint64_t each : assembler_.counts()) sum += each;
    return sum;
  }

 private:
  Assembler assembler_;
  std::int64_t now_us_ = 1'000'000;
  std::string channel_;
  Octets bytes_;
};

TEST(Assembler, AShortMessageComesOutAtOnce) {
  Bench bench;
  ASSERT_TRUE(bench.Feed(ShortDatagram(1, "POSE", {1, 2, 3})));
  EXPECT_EQ(bench.channel(), "POSE");
  EXPECT_EQ(bench.bytes(), (Octets{1, 2, 3}));
  EXPECT_TRUE(bench.Feed(ShortDatagram(2, "POSE", {})));
  EXPECT_TRUE(bench.bytes().empty());
  EXPECT_FALSE(bench.Feed(ShortDatagram(3, "UNWANTED", {1})));
  EXPECT_EQ(bench.AllCounts(), 0u);
}

TEST(Assembler, FragmentsInAnyOrderGiveTheMessage) {
  std::mt19937_64 rng(20240611);
  for (int trial = 0; trial < 300; ++trial) {
    const std::size_t size = 1 + rng() % 5000;
    const Octets data = Pattern(size, static_cast<std::uint32_t>(trial));
    auto fragments = Fragments(9, "IMAGE", data, 20 + rng() % 600);
    std::shuffle(fragments.begin(), fragments.end(), rng);
    Bench bench;
    for (std::size_t i = 0; i + 1 < fragments.size(); ++i) {
      ASSERT_FALSE(bench.Feed(fragments[i]));
      ASSERT_EQ(bench.assembler().fault(), PacketFault::kNone);
    }
    ASSERT_TRUE(bench.Feed(fragments.back()));
    EXPECT_EQ(bench.channel(), "IMAGE");
    EXPECT_EQ(bench.bytes(), data);
    EXPECT_EQ(bench.assembler().half_messages(), 0u);
    EXPECT_EQ(bench.assembler().reserved_bytes(), 0u);
  }
}

TEST(Assembler, SendersPortsAndSequenceNumbersAreToldApart) {
  std::mt19937_64 rng(7);
  struct Part {
    Octets datagram;
    Sender from;
  };
  std::vector<Part> parts;
  std::map<std::string, Octets> sent;
  std::uint32_t seed = 0;
  for (const Sender& from : {kCar, kOther, Sender{0x0A000002, 40000}}) {
    for (const std::uint32_t sequence : {1u, 2u, 3u}) {
      // All of one size: nothing but their origin tells them apart.
      const std::string channel = "C" + std::to_string(++seed);
      sent[channel] = Pattern(3000, seed);
      for (Octets& datagram : Fragments(sequence, channel, sent[channel], 500)) {
        parts.push_back({datagram, from});
        if (rng() % 3 == 0) parts.push_back({std::move(datagram), from});
      }
    }
  }
  std::shuffle(parts.begin(), parts.end(), rng);
  Bench bench;
  std::map<std::string, Octets> got;
  int messages = 0;
  for (const Part& part : parts) {
    if (!bench.Feed(part.datagram, part.from)) continue;
    ++messages;
    got[bench.channel()] = bench.bytes();
  }
  EXPECT_EQ(messages, 9);
  EXPECT_EQ(got, sent);
  EXPECT_EQ(bench.AllCounts(),
            bench.CountOf(PacketFault::kDuplicate) + bench.CountOf(PacketFault::kAfterTheMessage));
  EXPECT_EQ(bench.assembler().half_messages(), 0u);
}

// liblcm 1.3.1 counts fragments, not which: it hands up a message with a hole.
TEST(Assembler, ADuplicatedFirstFragmentIsNoSecondFragment) {
  const Octets data = Pattern(900, 1);
  const auto fragments = Fragments(4, "IMAGE", data, 400);
  ASSERT_EQ(fragments.size(), 3u);
  Bench bench;
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(bench.Feed(fragments[0]));
  EXPECT_FALSE(bench.Feed(fragments[1]));
  ASSERT_TRUE(bench.Feed(fragments[2]));
  EXPECT_EQ(bench.bytes(), data);
  EXPECT_EQ(bench.CountOf(PacketFault::kDuplicate), 2u);
}

TEST(Assembler, WhatIsSentTwiceIsGivenOnceAndLeavesNothingBehind) {
  const auto fragments = Fragments(4, "IMAGE", Pattern(900, 1), 400);
  Bench bench;
  int messages = 0;
  for (int round = 0; round < 2; ++round) {
    for (const Octets& fragment : fragments) {
      messages += bench.Feed(fragment) ? 1 : 0;
      messages += bench.Feed(fragment) ? 1 : 0;
    }
  }
  EXPECT_EQ(messages, 1);
  EXPECT_EQ(bench.CountOf(PacketFault::kAfterTheMessage), 7u);
  EXPECT_EQ(bench.assembler().half_messages(), 0u);
  // The numbers wrap some day: much later the same number is another message.
  bench.Wait(3'000'000);
  for (const Octets& fragment : fragments) messages += bench.Feed(fragment) ? 1 : 0;
  EXPECT_EQ(messages, 2);
}

TEST(Assembler, AFragmentThatDisagreesIsRefusedAndTheMessageGoesOn) {
  const Octets data = Pattern(900, 1);
  const auto fragments = Fragments(4, "IMAGE", data, 400);
  Bench bench;
  EXPECT_FALSE(bench.Feed(fragments[0]));
  const auto refused = [&](const testing::FragmentHeader& header, std::size_t size) {
    EXPECT_FALSE(bench.Feed(FragmentDatagram(header, Octets(size, 0xEE))));
    return bench.assembler().fault();
  };
  EXPECT_EQ(refused({4, 901, 500, 1, 3}, 10), PacketFault::kOtherSize);
  EXPECT_EQ(refused({4, 900, 500, 1, 4}, 10), PacketFault::kOtherCount);
  EXPECT_EQ(refused({4, 900, 100, 1, 3}, 10), PacketFault::kOverlap);
  EXPECT_EQ(refused({4, 900, 390, 1, 3}, 100), PacketFault::kOverlap);
  EXPECT_EQ(refused({4, 900, 393, 1, 3}, 10), PacketFault::kOverlap);
  EXPECT_FALSE(bench.Feed(fragments[2]));
  EXPECT_EQ(refused({4, 900, 394, 1, 3}, 401), PacketFault::kOverlap);
  ASSERT_TRUE(bench.Feed(fragments[1]));
  EXPECT_EQ(bench.bytes(), data);
}

TEST(Assembler, FragmentsThatLeaveAGapAreNoMessage) {
  Bench bench;
  EXPECT_FALSE(bench.Feed(FragmentDatagram({4, 100, 0, 0, 2}, WithChannel("A", Octets(40, 1)))));
  EXPECT_FALSE(bench.Feed(FragmentDatagram({4, 100, 60, 1, 2}, Octets(40, 1))));
  EXPECT_EQ(bench.assembler().fault(), PacketFault::kGap);
  EXPECT_EQ(bench.assembler().half_messages(), 0u);
}

TEST(Assembler, AMessageOfOneFragmentIsAMessage) {
  Bench bench;
  ASSERT_TRUE(bench.Feed(FragmentDatagram({4, 3, 0, 0, 1}, WithChannel("A", {1, 2, 3}))));
  EXPECT_EQ(bench.bytes(), (Octets{1, 2, 3}));
}

// A channel that nobody listens to costs no memory, in whatever order it comes.
TEST(Assembler, UnwantedMessagesTakeNoRoomAndCountAsNothing) {
  for (const bool is_backward : {false, true}) {
    auto fragments = Fragments(4, "UNWANTED", Pattern(100'000, 1), 10'000);
    if (is_backward) std::reverse(fragments.begin(), fragments.end());
    Bench bench;
    for (const Octets& fragment : fragments) {
      EXPECT_FALSE(bench.Feed(fragment));
      if (!is_backward) {
        EXPECT_LT(bench.assembler().reserved_bytes(), 2000u);
      }
    }
    EXPECT_EQ(bench.assembler().half_messages(), 0u);
    EXPECT_EQ(bench.assembler().reserved_bytes(), 0u);
    EXPECT_EQ(bench.AllCounts(), 0u);
    // Nor where a fragment of it was lost.
    bench.Feed(Fragments(5, "UNWANTED", Pattern(100'000, 1), 10'000)[0]);
    bench.Wait(5'000'000);
    bench.Feed(ShortDatagram(1, "A", {}));
    EXPECT_EQ(bench.AllCounts(), 0u);
  }
}

TEST(Assembler, HalfAMessageIsGivenUpAfterASecondOfSilence) {
  const auto fragments = Fragments(4, "IMAGE", Pattern(900, 1), 400);
  Bench bench;
  bench.Feed(fragments[0]);
  bench.Wait(900'000);
  bench.Feed(fragments[1]);
  bench.Wait(900'000);
  EXPECT_TRUE(bench.Feed(fragments[2]));  // Slow, but never silent.
  bench.Wait(5'000'000);
  bench.Feed(fragments[0]);
  bench.Wait(1'100'000);
  EXPECT_FALSE(bench.Feed(fragments[1]));
  EXPECT_EQ(bench.CountOf(PacketFault::kSilent), 1u);
  EXPECT_FALSE(bench.Feed(fragments[2]));
}

TEST(Assembler, HalfAMessageIsGivenUpAfterTenSecondsWhateverComes) {
  const auto fragments = Fragments(4, "IMAGE", Pattern(9000, 1), 400);
  Bench bench;
  for (const Octets& fragment : fragments) {
    bench.Wait(800'000);
    EXPECT_FALSE(bench.Feed(fragment));
  }
  EXPECT_EQ(bench.CountOf(PacketFault::kAge), 1u);
}

}  // namespace
}  // namespace v2vouch::lcm_packets
