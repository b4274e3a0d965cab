// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace v2vouch::net {

/// Keeps a socket a member of an IPv4 multicast group, on the interface that the routes name for
/// it. Linux forgets a membership when the interface goes or loses its last address, and never
/// moves it to another interface; the socket is not notified and receives nothing any more.
class Membership {
 public:
  /// @param group in network byte order.
  Membership(int descriptor, std::uint32_t group) : descriptor_(descriptor), group_(group) {}

  /// @return 0, or the errno of what stands in the way, such as no route.
  int Join();
  /// Joins again where that is needed. To be called about once a second. @return true where it was.
  bool Renew();

 private:
  [[nodiscard]] int Set(int option, int device) const;

  int descriptor_;
  std::uint32_t group_;
  int device_ = 0;  // Index of the interface.
};

}  // namespace v2vouch::net
