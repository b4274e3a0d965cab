// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "daemon/rim/wire/layout.h"

namespace v2vouch::wire {

/// A type that travels on a channel.
struct WireType {
  std::uint64_t fingerprint = 0;  ///< First eight bytes of a message.
  const Layout* layout = nullptr;
};

/// All of them, in the order of their names.
std::span<const WireType> ChannelTypes();

/// Which type a message claims to be; nullptr where it is none of ours or shorter than that.
const WireType* TypeOf(std::span<const std::uint8_t> bytes);

}  // namespace v2vouch::wire
