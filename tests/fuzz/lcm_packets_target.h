// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "daemon/rim/lcm_packets/assembler.h"

namespace v2vouch::testing {

/// One step of a fuzzed life: who sends what, how long after the step before.
struct PacketStep {
  std::uint8_t sender = 0;
  std::uint8_t pause = 0;  ///< Of 16 ms each.
  std::vector<std::uint8_t> datagram;
};

/// The steps as libFuzzer's input, and back: sender, pause, size (2, big endian), datagram. Any
/// bytes are some steps.
std::vector<std::uint8_t> PackSteps(const std::vector<PacketStep>& steps);
std::vector<PacketStep> UnpackSteps(std::span<const std::uint8_t> input);

/// Feeds each step to an assembler of small limits, the datagram in memory of exactly its size, and
/// stops the process where a promise is broken: limits kept, a message inside its own limits, or a
/// refusal counted, or neither. @return messages.
std::size_t RunSteps(const std::vector<PacketStep>& steps);

/// Good and hostile beginnings, for the corpus and for mutations.
std::vector<std::vector<PacketStep>> PacketSeeds();

/// Checks one step against what is promised. @return whether a message came.
bool CheckedTake(lcm_packets::Assembler& assembler, const lcm_packets::AssemblerLimits& limits,
                 std::span<const std::uint8_t> datagram, const lcm_packets::Sender& from,
                 std::int64_t now_us);

lcm_packets::AssemblerLimits SmallLimits();

}  // namespace v2vouch::testing
