// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace v2vouch::mcap_export {

/// One message for a viewer: JSON of one of Foxglove's schemas.
struct ViewMessage {
  std::string topic;
  std::string_view schema;  ///< "foxglove.SceneUpdate"; FoxgloveSchema() has its text.
  std::string json;
};

/// JSON Schema of the fields that we fill; empty where we know none of that name.
std::string_view FoxgloveSchema(std::string_view name);

/// What a viewer draws of one LCM message, by its type:
///
///     track_list_t      scene "/scene/<end of the channel>" in frame odom; of LOCAL also the ego's
///                       pose, FrameTransform odom -> base_link on "/tf"
///     truth_list_t      scene "/scene/truth" in frame base_link
///     gnss_fix_t        LocationFix "/gnss"
///     camera_image_t    CompressedImage (jpeg) or RawImage "/<channel>"
///     misbehavior_report_t, notices of daemon_status_t   Log "/log"
///
/// Nothing for other types and for bytes that do not decode.
std::vector<ViewMessage> FoxgloveMessages(std::string_view channel,
                                          std::span<const std::uint8_t> message);

}  // namespace v2vouch::mcap_export
