// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/net/source.h"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <algorithm>
#include <charconv>

namespace v2vouch::net {
namespace {

constexpr std::array<std::uint8_t, 12> kMapped = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF};
constexpr int kMappedBits = 96;

// @return the address's own length in bits, 0 where `text` is none.
int ReadAddress(const std::string& text, std::array<std::uint8_t, 16>& address) {
  if (inet_pton(AF_INET6, text.c_str(), address.data()) == 1) return 128;
  std::ranges::copy(kMapped, address.begin());
  return inet_pton(AF_INET, text.c_str(), address.data() + kMapped.size()) == 1 ? 32 : 0;
}

}  // namespace

bool Source::is_ipv4() const { return std::equal(kMapped.begin(), kMapped.end(), address.begin()); }

std::uint32_t Source::ipv4() const {
  std::uint32_t value = 0;
  for (std::size_t i = 12; i < 16; ++i) value = value << 8U | address[i];
  return value;
}

std::string Source::Text() const {
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (is_ipv4()) {
    inet_ntop(AF_INET, address.data() + kMapped.size(), text.data(), text.size());
  } else {
    inet_ntop(AF_INET6, address.data(), text.data(), text.size());
  }
  return text.data();
}

std::optional<Source> ParseAddress(const std::string& text) {
  Source source;
  if (ReadAddress(text, source.address) == 0) return std::nullopt;
  return source;
}

bool SourceFilter::Parse(const std::vector<std::string>& entries, SourceFilter& filter,
                         std::string& error) {
  filter.networks_.clear();
  for (const std::string& entry : entries) {
    const auto slash = std::min(entry.find('/'), entry.size());
    Network network;
    const int own_bits = ReadAddress(entry.substr(0, slash), network.address);
    int bits = own_bits;
    bool is_good = own_bits != 0;
    if (slash < entry.size()) {
      const char* const end = entry.data() + entry.size();
      const auto [stop, fault] = std::from_chars(entry.data() + slash + 1, end, bits);
      is_good = is_good && fault == std::errc() && stop == end && bits >= 0 && bits <= own_bits;
    }
    if (!is_good) {
      error = "\"" + entry + "\" is no address or network, as in 192.168.1.7 or 192.168.1.0/24";
      return false;
    }
    network.bits = own_bits == 32 ? kMappedBits + bits : bits;
    filter.networks_.push_back(network);
  }
  return true;
}

bool SourceFilter::Allows(const Source& source) const {
  if (networks_.empty()) return true;
  // 0.0.0.0 is this host: so it sends to a group that is routed to `lo`. From outside the kernel
  // takes no such datagram.
  std::array<std::uint8_t, 16> address = source.address;
  if (source.is_ipv4() && source.ipv4() == 0) {
    address[12] = 127;
    address[15] = 1;
  }
  return std::ranges::any_of(networks_, [&](const Network& network) {
    for (int bit = 0; bit < network.bits; bit += 8) {
      const auto at = static_cast<std::size_t>(bit / 8);
      const int left = std::min(8, network.bits - bit);
      const auto mask = static_cast<std::uint8_t>(0xFF00U >> static_cast<unsigned>(left));
      if (((address[at] ^ network.address[at]) & mask) != 0) return false;
    }
    return true;
  });
}

}  // namespace v2vouch::net
