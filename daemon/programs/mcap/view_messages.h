// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/common/base/time.h"
#include "daemon/rim/view/event_list.h"

namespace v2vouch::mcap_export {

/// One message for a viewer: JSON of one of Foxglove's schemas, or of ours for plots.
struct ViewMessage {
  std::string topic;
  std::string_view schema;  ///< "foxglove.SceneUpdate"; foxglove::Schema() has its text.
  std::string json;
};

/// What a viewer draws of LCM messages, by their type, on the topics that v2vouch-view has too:
///
///     track_list_t      scene "/v2vouch/local", ".../priority", ".../senders" and arrays for plots
///                       "/v2vouch/plot/..."; of LOCAL also the ego's pose, odom -> base_link,
///                       "/tf"
///     truth_list_t      scene "/v2vouch/truth"
///     gnss_fix_t        LocationFix "/ego/gnss"
///     camera_image_t    CompressedImage (jpeg) or RawImage "/camera/<sensor>"
///     what happened     Log "/v2vouch/log": validated, hidden, accused, warned of, notices
///
/// Nothing for other types and for bytes that do not decode.
class ViewMessages {
 public:
  std::vector<ViewMessage> Of(std::string_view channel, std::span<const std::uint8_t> message,
                              Timestamp received);

 private:
  void AddTracks(std::string_view channel, std::span<const std::uint8_t> bytes, std::int64_t at);
  void AddEvents();

  view::EventList events_;
  std::int64_t told_ = 0;  // Events so far.
  std::vector<ViewMessage> out_;
};

}  // namespace v2vouch::mcap_export
