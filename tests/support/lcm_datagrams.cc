// SPDX-License-Identifier: Apache-2.0
#include "tests/support/lcm_datagrams.h"

#include <algorithm>

namespace v2vouch::testing {
namespace {

void Put(Octets& bytes, std::uint32_t value, int size) {
  for (int shift = 8 * (size - 1); shift >= 0; shift -= 8) {
    bytes.push_back(static_cast<std::uint8_t>(value >> shift));
  }
}

}  // namespace

Octets WithChannel(const std::string& channel, const Octets& data) {
  Octets bytes(channel.begin(), channel.end());
  bytes.push_back(0);
  bytes.insert(bytes.end(), data.begin(), data.end());
  return bytes;
}

Octets ShortDatagram(std::uint32_t sequence, const std::string& channel, const Octets& data) {
  Octets bytes = {'L', 'C', '0', '2'};
  Put(bytes, sequence, 4);
  const Octets rest = WithChannel(channel, data);
  bytes.insert(bytes.end(), rest.begin(), rest.end());
  return bytes;
}

Octets FragmentDatagram(const FragmentHeader& header, const Octets& rest) {
  Octets bytes = {'L', 'C', '0', '3'};
  Put(bytes, header.sequence, 4);
  Put(bytes, header.message_size, 4);
  Put(bytes, header.offset, 4);
  Put(bytes, header.number, 2);
  Put(bytes, header.count, 2);
  bytes.insert(bytes.end(), rest.begin(), rest.end());
  return bytes;
}

std::vector<Octets> Fragments(std::uint32_t sequence, const std::string& channel,
                              const Octets& data, std::size_t payload_bytes) {
  const std::size_t all = channel.size() + 1 + data.size();
  const std::size_t count = (all + payload_bytes - 1) / payload_bytes;
  std::vector<Octets> fragments;
  std::size_t from = 0;
  for (std::size_t number = 0; number < count; ++number) {
    const std::size_t room = number == 0 ? payload_bytes - channel.size() - 1 : payload_bytes;
    const std::size_t to = std::min(from + room, data.size());
    const Octets part(data.begin() + static_cast<std::ptrdiff_t>(from),
                      data.begin() + static_cast<std::ptrdiff_t>(to));
    fragments.push_back(FragmentDatagram(
        {sequence, static_cast<std::uint32_t>(data.size()), static_cast<std::uint32_t>(from),
         static_cast<std::uint16_t>(number), static_cast<std::uint16_t>(count)},
        number == 0 ? WithChannel(channel, part) : part));
    from = to;
  }
  return fragments;
}

Octets Pattern(std::size_t size, std::uint32_t seed) {
  Octets bytes(size);
  std::uint32_t state = seed * 2654435761U + 1;
  for (auto& byte : bytes) {
    state = state * 1664525U + 1013904223U;
    byte = static_cast<std::uint8_t>(state >> 24U);
  }
  return bytes;
}

}  // namespace v2vouch::testing
