// SPDX-License-Identifier: Apache-2.0
// Damaged datagrams through LCM's packet reader and assembler. V2VOUCH_FUZZ_MUTATIONS sets how many
// (default 1000000); V2VOUCH_WRITE_CORPUS names a folder for libFuzzer's first corpus.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>

#include "tests/fuzz/lcm_packets_target.h"
#include "tests/support/lcm_datagrams.h"

namespace v2vouch::testing {
namespace {

using lcm_packets::Assembler;
using lcm_packets::Sender;

std::vector<Octets> SeedDatagrams() {
  std::vector<Octets> datagrams;
  for (const auto& seed : PacketSeeds()) {
    for (const PacketStep& step : seed) datagrams.push_back(step.datagram);
  }
  return datagrams;
}

// Mostly in the header, where the lies are told.
void Mutate(Octets& bytes, std::mt19937_64& rng) {
  static constexpr std::uint8_t kOdd[] = {0x00, 0x01, 0x02, 0x7F, 0x80, 0xFE, 0xFF, 0x10};
  for (std::uint64_t times = rng() % 4; times > 0 && !bytes.empty(); --times) {
    const std::size_t reach =
        rng() % 4 != 0 ? std::min<std::size_t>(bytes.size(), 28) : bytes.size();
    const std::size_t at = rng() % reach;
    switch (rng() % 7) {
      case 0:
        bytes[at] ^= static_cast<std::uint8_t>(1U << rng() % 8);
        break;
      case 1:
        bytes[at] = kOdd[rng() % 8];
        break;
      case 2:
        bytes[at] = static_cast<std::uint8_t>(rng());
        break;
      case 3:  // A whole field.
        for (std::size_t i = at & ~std::size_t{3};
             i < bytes.size() && i < (at & ~std::size_t{3}) + 4; ++i) {
          bytes[i] = rng() % 2 == 0 ? 0xFF : 0x00;
        }
        break;
      case 4:
        bytes.resize(rng() % (bytes.size() + 1));
        break;
      case 5:
        bytes.insert(bytes.end(), rng() % 60, static_cast<std::uint8_t>(rng()));
        break;
      default:
        bytes[at] = static_cast<std::uint8_t>(bytes[at] + (rng() % 2 == 0 ? 1 : -1));
    }
  }
}

// One assembler lives through them all: half messages meet each other's fragments.
TEST(LcmPacketsFuzz, MutatedDatagramsEndAsAMessageOrACountedRefusal) {
  const std::vector<Octets> seeds = SeedDatagrams();
  const char* const wanted = std::getenv("V2VOUCH_FUZZ_MUTATIONS");
  const std::int64_t mutations = wanted != nullptr ? std::atoll(wanted) : 1'000'000;
  std::mt19937_64 rng(2203);
  const auto limits = SmallLimits();
  Assembler assembler([](std::string_view channel) { return channel.front() != 'U'; }, limits);
  std::int64_t now_us = 0;
  std::int64_t messages = 0;
  std::size_t next = 0;
  for (std::int64_t i = 0; i < mutations; ++i) {
    // Mostly one after the other, so that messages get complete.
    next = rng() % 8 == 0 ? rng() % seeds.size() : (next + 1) % seeds.size();
    Octets bytes = seeds[next];
    Mutate(bytes, rng);
    // Another number from time to time: else what was complete would be a copy.
    if (bytes.size() > 8) bytes[6] = static_cast<std::uint8_t>(i / 500);
    now_us += static_cast<std::int64_t>(rng() % 3000);
    const Sender from{0x7F000001, static_cast<std::uint16_t>(rng() % 16 == 0 ? rng() % 6 : 0)};
    messages += CheckedTake(assembler, limits, bytes, from, now_us) ? 1 : 0;
  }
  RecordProperty("messages", std::to_string(messages));
  EXPECT_GT(messages, mutations / 200);
  std::uint64_t kinds = 0;
  for (const std::uint64_t count : assembler.counts()) kinds += count > 0 ? 1 : 0;
  EXPECT_GE(kinds, mutations >= 100'000 ? 15u : 1u);  // Else the test tests little.
}

TEST(LcmPacketsFuzz, EveryPrefixOfEverySeedEndsAsAMessageOrACountedRefusal) {
  const auto limits = SmallLimits();
  Assembler assembler([](std::string_view) { return true; }, limits);
  std::int64_t now_us = 0;
  for (const Octets& datagram : SeedDatagrams()) {
    for (std::size_t size = 0; size <= datagram.size(); ++size) {
      CheckedTake(assembler, limits, std::span(datagram).first(size), {1, 1}, ++now_us);
    }
  }
}

TEST(LcmPacketsFuzz, TheCorpusRunsAndIsWrittenWhereAsked) {
  const char* const folder = std::getenv("V2VOUCH_WRITE_CORPUS");
  if (folder != nullptr) std::filesystem::create_directories(folder);
  std::size_t messages = 0;
  int number = 0;
  for (const auto& seed : PacketSeeds()) {
    const Octets input = PackSteps(seed);
    messages += RunSteps(UnpackSteps(input));
    if (folder == nullptr) continue;
    std::ofstream file(std::filesystem::path(folder) / ("seed_" + std::to_string(number++)),
                       std::ios::binary);
    file.write(reinterpret_cast<const char*>(input.data()),
               static_cast<std::streamsize>(input.size()));
    EXPECT_TRUE(file.good());
  }
  EXPECT_GT(messages, 8u);
}

}  // namespace
}  // namespace v2vouch::testing
