// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace v2vouch::testing {

using Octets = std::vector<std::uint8_t>;

/// A fragment's header, each field free to lie.
struct FragmentHeader {
  std::uint32_t sequence = 0;
  std::uint32_t message_size = 0;
  std::uint32_t offset = 0;
  std::uint16_t number = 0;
  std::uint16_t count = 0;
};

/// "LC02" | sequence | channel, 0 | data.
Octets ShortDatagram(std::uint32_t sequence, const std::string& channel, const Octets& data);

/// "LC03" | header | what follows, a channel with its 0 included.
Octets FragmentDatagram(const FragmentHeader& header, const Octets& rest);

/// A channel's name with its 0, then `data`.
Octets WithChannel(const std::string& channel, const Octets& data);

/// A message in fragments as LCM makes them: each carries `payload_bytes`, the first the channel,
/// too.
std::vector<Octets> Fragments(std::uint32_t sequence, const std::string& channel,
                              const Octets& data, std::size_t payload_bytes = 65487);

/// `size` bytes that differ from place to place and seed to seed.
Octets Pattern(std::size_t size, std::uint32_t seed);

}  // namespace v2vouch::testing
