// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/mcap/view_messages.h"

#include <cctype>
#include <utility>

#include "daemon/rim/foxglove/flat_tracks.h"
#include "daemon/rim/foxglove/messages.h"
#include "daemon/rim/foxglove/scenes.h"
#include "daemon/rim/json/json_text.h"
#include "daemon/rim/message_schema/message_schema.h"
#include "daemon/rim/view/foxglove_messages.h"
#include "daemon/rim/wire/codec.h"
#include "v2vouch/daemon_status_t.hpp"
#include "v2vouch/misbehavior_report_t.hpp"
#include "v2vouch/warning_list_t.hpp"

namespace v2vouch::mcap_export {
namespace {

using foxglove::ListKind;

// Of a channel TRACKS_<end>; a list of any other name is drawn as LOCAL is.
std::pair<std::string, ListKind> NameOf(std::string_view channel) {
  std::string end(channel.starts_with("TRACKS_") ? channel.substr(7) : channel);
  for (char& c : end) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (end == "v2v") return {"senders", ListKind::kSenders};
  return {end, end == "priority" ? ListKind::kPriority : ListKind::kLocal};
}

}  // namespace

void ViewMessages::AddTracks(std::string_view channel, std::span<const std::uint8_t> bytes,
                             std::int64_t at) {
  const auto list = wire::Decode<track_list_t>(bytes);
  if (!list) return;
  const auto [name, kind] = NameOf(channel);
  if (name == "local") {
    out_.push_back({"/tf", "foxglove.FrameTransform",
                    foxglove::EgoTransform(list->utime, list->ego_x_odom_m, list->ego_y_odom_m,
                                           list->ego_yaw_odom_rad)});
  }
  out_.push_back(
      {"/v2vouch/" + name, "foxglove.SceneUpdate", foxglove::TrackScene(*list, kind, false)});
  if (kind == ListKind::kSenders) return;
  out_.push_back({"/v2vouch/plot/" + name, "v2vouch.FlatTracks", foxglove::FlatTracks(*list)});
  if (kind == ListKind::kPriority) events_.TakePriority(*list, at);
}

void ViewMessages::AddEvents() {
  for (const view::ViewEvent& event : events_.events()) {
    if (event.number < told_) continue;
    out_.push_back({"/v2vouch/log", "foxglove.Log", view::FoxgloveLog(event)});
  }
  told_ = events_.next_number();
}

std::vector<ViewMessage> ViewMessages::Of(std::string_view channel,
                                          std::span<const std::uint8_t> message,
                                          Timestamp received) {
  out_.clear();
  const message_schema::Type* type = message_schema::TypeOf(message);
  if (type == nullptr) return {};
  const std::int64_t at = ToMicros(received);
  if (type->name == "track_list_t") {
    AddTracks(channel, message, at);
  } else if (type->name == "truth_list_t") {
    if (const auto list = wire::Decode<truth_list_t>(message)) {
      out_.push_back(
          {"/v2vouch/truth", "foxglove.SceneUpdate", foxglove::TruthScene(*list, false)});
    }
  } else if (type->name == "gnss_fix_t") {
    if (const auto fix = wire::Decode<gnss_fix_t>(message)) {
      out_.push_back({"/ego/gnss", "foxglove.LocationFix", foxglove::Location(*fix)});
    }
  } else if (type->name == "camera_image_t") {
    if (const auto image = wire::Decode<camera_image_t>(message)) {
      foxglove::Picture picture = foxglove::PictureOf(*image);
      const bool is_name = !image->sensor.empty() && IsUtf8(image->sensor);
      out_.push_back({"/camera/" + (is_name ? image->sensor : std::string(channel)), picture.schema,
                      std::move(picture.json)});
    }
  } else if (type->name == "misbehavior_report_t") {
    if (const auto report = wire::Decode<misbehavior_report_t>(message)) {
      events_.TakeReport(*report, at);
    }
  } else if (type->name == "daemon_status_t") {
    if (const auto status = wire::Decode<daemon_status_t>(message)) events_.TakeStatus(*status, at);
  } else if (type->name == "warning_list_t") {
    if (const auto warnings = wire::Decode<warning_list_t>(message)) {
      events_.TakeWarnings(*warnings, at);
    }
  }
  AddEvents();
  return std::move(out_);
}

}  // namespace v2vouch::mcap_export
