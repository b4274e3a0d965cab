// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "daemon/rim/view/playback.h"

namespace v2vouch::view {

/// What a client may say: nothing that could change the car. Everything else is refused.
struct Subscribe {
  struct Item {
    std::uint32_t id = 0;  ///< The client's own.
    std::uint32_t channel = 0;
  };
  std::vector<Item> items;
};
struct Unsubscribe {
  std::vector<std::uint32_t> ids;
};
/// The page has drawn a frame.
struct Drawn {};
/// The page wants camera pictures or not.
struct WantPictures {
  bool on = false;
};
/// Why it was not understood; shown to the client.
struct NotUnderstood {
  std::string why;
};
using ClientMessage =
    std::variant<Subscribe, Unsubscribe, Drawn, WantPictures, PlaybackRequest, NotUnderstood>;

inline constexpr std::size_t kMostSubscriptions = 64;
inline constexpr std::size_t kMostClientBytes = 16384;

/// Reads a text frame: a JSON object with `op`. The bytes may be hostile.
ClientMessage ReadClientText(std::string_view text);

/// Reads a binary frame, little endian: u8 3 | u8 command (0 play, 1 pause) | f32 speed
/// | u8 has a seek | u64 seek ns | u32 length | request id. Speed 0.05 to 50.
ClientMessage ReadClientBinary(std::span<const std::uint8_t> bytes);

}  // namespace v2vouch::view
