// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

#include "daemon/rim/json/json_text.h"

namespace v2vouch::foxglove {

/// Parts of Foxglove's messages, written into `json`. Lengths are metres, angles radians.
struct Colour {
  double r, g, b, a;
};
// Okabe and Ito's colours, as on our own page.
inline constexpr Colour kBlue{0.0, 0.45, 0.70, 0.8};
inline constexpr Colour kGreen{0.0, 0.62, 0.45, 0.9};
inline constexpr Colour kOrange{0.90, 0.62, 0.0, 0.9};
inline constexpr Colour kRed{0.84, 0.37, 0.0, 0.9};
inline constexpr Colour kGrey{0.6, 0.6, 0.6, 0.7};
inline constexpr Colour kPurple{0.80, 0.47, 0.65, 0.9};

void PutTime(JsonText& json, std::string_view key, std::int64_t utime);
void PutVector(JsonText& json, std::string_view key, double x, double y, double z);
void PutRotation(JsonText& json, std::string_view key, double yaw_rad);
void PutPose(JsonText& json, double x, double y, double z, double yaw_rad);
void PutColour(JsonText& json, Colour colour);
void PutMetadata(JsonText& json,
                 std::initializer_list<std::pair<std::string_view, std::string>> items);
/// Lists of an entity that hold nothing.
void PutEmpty(JsonText& json, std::initializer_list<std::string_view> keys);

/// Begins an entity of a scene; the caller adds metadata and primitives and closes it. It lives
/// 0.5 s, so that a daemon that ended leaves no vehicle in the picture.
void OpenEntity(JsonText& json, std::string_view id, std::int64_t utime, std::string_view frame);
/// Begins a scene; `clears`: what was shown before is deleted (after a jump in time).
void OpenScene(JsonText& json, std::int64_t utime, bool clears);
void CloseScene(JsonText& json);

}  // namespace v2vouch::foxglove
