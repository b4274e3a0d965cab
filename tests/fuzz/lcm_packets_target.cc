// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/lcm_packets_target.h"

#include <algorithm>
#include <memory>
#include <numeric>

#include "daemon/common/base/check.h"
#include "tests/support/lcm_datagrams.h"

namespace v2vouch::testing {

using lcm_packets::Assembler;
using lcm_packets::AssemblerLimits;
using lcm_packets::PacketCounts;
using lcm_packets::PacketFault;
using lcm_packets::Sender;

AssemblerLimits SmallLimits() {
  AssemblerLimits limits;
  limits.message_bytes = 1U << 20U;
  limits.sender_bytes = 3U << 20U;
  limits.all_bytes = 5U << 20U;
  limits.sender_messages = 4;
  limits.all_messages = 10;
  return limits;
}

std::vector<std::uint8_t> PackSteps(const std::vector<PacketStep>& steps) {
  std::vector<std::uint8_t> input;
  for (const PacketStep& step : steps) {
    input.push_back(step.sender);
    input.push_back(step.pause);
    input.push_back(static_cast<std::uint8_t>(step.datagram.size() >> 8U));
    input.push_back(static_cast<std::uint8_t>(step.datagram.size()));
    input.insert(input.end(), step.datagram.begin(), step.datagram.end());
  }
  return input;
}

std::vector<PacketStep> UnpackSteps(std::span<const std::uint8_t> input) {
  std::vector<PacketStep> steps;
  while (input.size() >= 4) {
    const std::size_t wanted = static_cast<std::size_t>(input[2]) << 8U | input[3];
    const std::size_t size = std::min(wanted, input.size() - 4);
    const auto datagram = input.subspan(4, size);
    steps.push_back({input[0], input[1], {datagram.begin(), datagram.end()}});
    input = input.subspan(4 + size);
  }
  return steps;
}

bool CheckedTake(Assembler& assembler, const AssemblerLimits& limits,
                 std::span<const std::uint8_t> datagram, const Sender& from, std::int64_t now_us) {
  const std::unique_ptr<std::uint8_t[]> exact(new std::uint8_t[datagram.size()]);
  std::ranges::copy(datagram, exact.get());
  const auto sum = [](const PacketCounts& counts) {
    return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
  };
  const std::uint64_t before = sum(assembler.counts());
  const auto message = assembler.Take({exact.get(), datagram.size()}, from, now_us);
  V2VOUCH_CHECK(assembler.half_messages() <= limits.all_messages);
  V2VOUCH_CHECK(assembler.reserved_bytes() <= limits.all_bytes);
  V2VOUCH_CHECK(!message || assembler.fault() == PacketFault::kNone);
  V2VOUCH_CHECK(assembler.fault() == PacketFault::kNone || sum(assembler.counts()) > before);
  if (!message) return false;
  V2VOUCH_CHECK(!message->channel.empty() &&
                message->channel.size() <= lcm_packets::kLongestChannel);
  V2VOUCH_CHECK(message->bytes.size() <= limits.message_bytes);
  // Every byte is there: the sanitizers see one that is not.
  volatile std::uint8_t all = 0;
  for (const std::uint8_t byte : message->bytes) all = static_cast<std::uint8_t>(all ^ byte);
  return true;
}

std::size_t RunSteps(const std::vector<PacketStep>& steps) {
  const AssemblerLimits limits = SmallLimits();
  Assembler assembler([](std::string_view channel) { return channel.front() != 'U'; }, limits);
  std::int64_t now_us = 0;
  std::size_t messages = 0;
  for (const PacketStep& step : steps) {
    now_us += step.pause * 16'000;
    const Sender from{0x7F000001, static_cast<std::uint16_t>(step.sender % 8)};
    messages += CheckedTake(assembler, limits, step.datagram, from, now_us) ? 1 : 0;
  }
  return messages;
}

std::vector<std::vector<PacketStep>> PacketSeeds() {
  std::vector<std::vector<PacketStep>> seeds;
  const auto add = [&](const std::vector<Octets>& datagrams, bool has_two_senders = false) {
    std::vector<PacketStep> steps;
    for (const Octets& datagram : datagrams) {
      const auto sender = static_cast<std::uint8_t>(has_two_senders ? steps.size() % 2 : 0);
      steps.push_back({sender, 0, datagram});
    }
    seeds.push_back(std::move(steps));
  };
  add({ShortDatagram(1, "RADAR_FRONT", Pattern(80, 1)), ShortDatagram(2, "A", {})});
  add({ShortDatagram(1, std::string(63, 'C'), Pattern(10, 1))});
  for (const std::size_t payload : {20u, 60u, 400u}) {
    auto fragments = Fragments(7, "IMAGE", Pattern(700, 2), payload);
    add(fragments);
    std::reverse(fragments.begin(), fragments.end());
    add(fragments);
    fragments.insert(fragments.end(), fragments.begin(), fragments.end());
    add(fragments, true);
  }
  add(Fragments(8, "UNWANTED", Pattern(300, 3), 90));
  add(Fragments(9, "IMAGE", Pattern(1, 3), 60));
  const Octets first = WithChannel("A", Octets(20, 1));
  add({FragmentDatagram({1, 100, 0, 0, 2}, first),
       FragmentDatagram({1, 100, 0xFFFFFFF0, 1, 2}, Octets(80, 2)),
       FragmentDatagram({1, 100, 10, 1, 2}, Octets(80, 2)),
       FragmentDatagram({1, 200, 20, 1, 2}, Octets(80, 2)),
       FragmentDatagram({1, 100, 20, 1, 3}, Octets(80, 2)),
       FragmentDatagram({1, 100, 20, 2, 2}, Octets(80, 2)),
       FragmentDatagram({1, 100, 20, 1, 2}, Octets(80, 2))});
  add({FragmentDatagram({1, 0xFFFFFFFF, 0, 0, 0xFFFF}, first),
       FragmentDatagram({2, 1U << 20U, 0, 0, 0xFFFF}, first),
       FragmentDatagram({3, 1U << 20U, 0, 0, 20}, first),
       FragmentDatagram({4, 0, 0, 0, 0}, first)});
  return seeds;
}

}  // namespace v2vouch::testing
