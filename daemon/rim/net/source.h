// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace v2vouch::net {

/// Where a datagram came from. An IPv4 address is held as ::ffff:a.b.c.d.
struct Source {
  std::array<std::uint8_t, 16> address{};
  std::uint16_t port = 0;

  [[nodiscard]] bool is_ipv4() const;
  /// The last four bytes, which is all of an IPv4 address.
  [[nodiscard]] std::uint32_t ipv4() const;
  /// The address: "192.168.1.7", "fe80::1".
  [[nodiscard]] std::string Text() const;
};

/// The source of port 0 at an address written out; nullopt: no address. Its Text() is how senders
/// of that address are told.
std::optional<Source> ParseAddress(const std::string& text);

/// Addresses and networks that may send. Empty: anybody.
class SourceFilter {
 public:
  /// @param entries addresses, or networks as in "192.168.1.0/24" or "fd00::/8".
  /// @return false with the first that is neither in `error`.
  static bool Parse(const std::vector<std::string>& entries, SourceFilter& filter,
                    std::string& error);
  [[nodiscard]] bool Allows(const Source& source) const;

 private:
  struct Network {
    std::array<std::uint8_t, 16> address{};
    int bits = 128;
  };
  std::vector<Network> networks_;
};

}  // namespace v2vouch::net
