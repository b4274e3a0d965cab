// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/mcap/foxglove_messages.h"

#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>

#include "daemon/rim/message_schema/json_text.h"
#include "daemon/rim/message_schema/message_schema.h"
#include "daemon/rim/wire/codec.h"
#include "v2vouch/camera_image_t.hpp"
#include "v2vouch/daemon_status_t.hpp"
#include "v2vouch/gnss_fix_t.hpp"
#include "v2vouch/misbehavior_report_t.hpp"
#include "v2vouch/track_list_t.hpp"
#include "v2vouch/truth_list_t.hpp"

namespace v2vouch::mcap_export {
namespace {

using Json = nlohmann::json;

constexpr double kHeight_m = 1.5;  // Nobody estimates it.
constexpr int kWarning = 3;        // Levels of foxglove.Log.
constexpr int kError = 4;

Json TimeJson(std::int64_t utime) {
  const std::int64_t micros = std::max<std::int64_t>(utime, 0);
  return {{"sec", micros / 1'000'000}, {"nsec", micros % 1'000'000 * 1000}};
}

Json Xyz(double x, double y, double z) { return {{"x", x}, {"y", y}, {"z", z}}; }

Json Turned(double yaw_rad) {
  return {{"x", 0.0}, {"y", 0.0}, {"z", std::sin(yaw_rad / 2)}, {"w", std::cos(yaw_rad / 2)}};
}

Json PoseJson(double x, double y, double z, double yaw_rad) {
  return {{"position", Xyz(x, y, z)}, {"orientation", Turned(yaw_rad)}};
}

Json Color(double r, double g, double b, double a) {
  return {{"r", r}, {"g", g}, {"b", b}, {"a", a}};
}

// Okabe and Ito's colours, told apart by colour-blind people too.
Json ColorOf(std::string_view list, const track_t& track) {
  const double alpha = track.visibility == track_t::VISIBLE ? 0.8 : 0.35;
  if (list == "local") return Color(0.0, 0.45, 0.70, alpha);
  if (track.trust_state >= track_t::TRUST_SUSPECT) return Color(0.84, 0.37, 0.0, alpha);
  if (list == "priority") return Color(0.0, 0.62, 0.45, alpha);
  return Color(0.8, 0.47, 0.65, 0.35);
}

Json Entity(std::int64_t utime, const char* frame, std::int64_t id, double x, double y,
            double yaw_rad, double length_m, double width_m, double height_m, const Json& color,
            const std::string& text) {
  Json entity;
  entity["timestamp"] = TimeJson(utime);
  entity["frame_id"] = frame;
  entity["id"] = std::to_string(id);
  // So that nothing stays where the lists end.
  entity["lifetime"] = {{"sec", 0}, {"nsec", 300'000'000}};
  entity["frame_locked"] = false;
  for (const char* none :
       {"metadata", "arrows", "spheres", "cylinders", "lines", "triangles", "texts", "models"}) {
    entity[none] = Json::array();
  }
  entity["cubes"] = {{{"pose", PoseJson(x, y, height_m / 2, yaw_rad)},
                      {"size", Xyz(length_m, width_m, height_m)},
                      {"color", color}}};
  entity["texts"] = {{{"pose", PoseJson(x, y, height_m + 0.7, 0.0)},
                      {"billboard", true},
                      {"font_size", 0.9},
                      {"scale_invariant", false},
                      {"color", Color(0.5, 0.5, 0.5, 1.0)},
                      {"text", text}}};
  return entity;
}

ViewMessage Scene(const std::string& topic, Json entities) {
  const Json scene = {{"deletions", Json::array()}, {"entities", std::move(entities)}};
  return {topic, "foxglove.SceneUpdate", scene.dump()};
}

std::string Hex(const std::uint8_t* octets, int count) {
  std::string text;
  char digits[3];
  for (int i = 0; i < count; ++i) {
    std::snprintf(digits, sizeof(digits), "%02x", octets[i]);
    text += digits;
  }
  return text;
}

std::string LabelOf(const track_t& track) {
  // Ids are functions of a hash; four digits tell neighbours apart.
  char text[96];
  std::snprintf(text, sizeof(text), "%" PRId64 "  %.1f m/s", track.id % 10'000, track.speed_mps);
  std::string label(text);
  if (track.visibility == track_t::HIDDEN) label += "  hidden";
  if (track.visibility == track_t::OUT_OF_VIEW) label += "  out of view";
  if (std::isfinite(track.bridge_budget_s) && track.visibility != track_t::VISIBLE) {
    std::snprintf(text, sizeof(text), ", %.1f s left", track.bridge_budget_s);
    label += text;
  }
  return label;
}

std::string EndOfChannel(std::string_view channel) {
  std::string end(channel.starts_with("TRACKS_") ? channel.substr(7) : channel);
  for (char& c : end) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return end;
}

template <class T>
bool Decoded(std::span<const std::uint8_t> bytes, T& message) {
  auto result = wire::Decode<T>(bytes);
  if (!result) return false;
  message = std::move(*result);
  return true;
}

void AddTracks(std::string_view channel, std::span<const std::uint8_t> bytes,
               std::vector<ViewMessage>& out) {
  track_list_t list;
  if (!Decoded(bytes, list)) return;
  const std::string name = EndOfChannel(channel);
  Json entities = Json::array();
  for (const track_t& track : list.tracks) {
    entities.push_back(Entity(list.utime, "odom", track.id, track.x_odom_m, track.y_odom_m,
                              track.yaw_odom_rad, track.length_m, track.width_m, kHeight_m,
                              ColorOf(name, track), LabelOf(track)));
  }
  if (name == "local") {
    const Json transform = {{"timestamp", TimeJson(list.utime)},
                            {"parent_frame_id", "odom"},
                            {"child_frame_id", "base_link"},
                            {"translation", Xyz(list.ego_x_odom_m, list.ego_y_odom_m, 0.0)},
                            {"rotation", Turned(list.ego_yaw_odom_rad)}};
    out.push_back({"/tf", "foxglove.FrameTransform", transform.dump()});
  }
  out.push_back(Scene("/scene/" + name, std::move(entities)));
}

void AddTruth(std::span<const std::uint8_t> bytes, std::vector<ViewMessage>& out) {
  truth_list_t list;
  if (!Decoded(bytes, list)) return;
  const double c = std::cos(list.ego_yaw_rad);
  const double s = std::sin(list.ego_yaw_rad);
  Json entities = Json::array();
  for (const truth_object_t& object : list.objects) {
    const double dx = object.x_m - list.ego_x_m;
    const double dy = object.y_m - list.ego_y_m;
    entities.push_back(Entity(list.utime, "base_link", object.id, c * dx + s * dy, -s * dx + c * dy,
                              object.yaw_rad - list.ego_yaw_rad, object.length_m, object.width_m,
                              object.height_m, Color(0.5, 0.5, 0.5, 0.25),
                              "truth " + std::to_string(object.id)));
  }
  out.push_back(Scene("/scene/truth", std::move(entities)));
}

void AddFix(std::span<const std::uint8_t> bytes, std::vector<ViewMessage>& out) {
  gnss_fix_t fix;
  if (!Decoded(bytes, fix)) return;
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  Json covariance = Json::array();
  bool is_known = true;
  for (const double value : fix.covariance_enu_m2) {
    is_known = is_known && std::isfinite(value);
    covariance.push_back(std::isfinite(value) ? value : 0.0);
  }
  const Json json = {{"timestamp", TimeJson(fix.utime)},
                     {"frame_id", "gnss"},
                     {"latitude", fix.latitude_rad * kDegrees},
                     {"longitude", fix.longitude_rad * kDegrees},
                     {"altitude", std::isfinite(fix.altitude_m) ? fix.altitude_m : 0.0},
                     {"position_covariance", covariance},
                     {"position_covariance_type", is_known ? 3 : 0}};
  out.push_back({"/gnss", "foxglove.LocationFix", json.dump()});
}

void AddImage(std::string_view channel, std::span<const std::uint8_t> bytes,
              std::vector<ViewMessage>& out) {
  camera_image_t image;
  if (!Decoded(bytes, image)) return;
  std::string json = "{\"timestamp\":" + TimeJson(image.utime).dump() + ",\"frame_id\":";
  message_schema::AppendJsonString(json, image.sensor);
  const bool is_jpeg = image.encoding == "jpeg";
  if (is_jpeg) {
    json += R"(,"format":"jpeg")";
  } else {
    const int step = image.width_px * (image.encoding == "bgr8" ? 3 : 1);
    json += ",\"width\":" + std::to_string(image.width_px) +
            ",\"height\":" + std::to_string(image.height_px) + ",\"step\":" + std::to_string(step) +
            ",\"encoding\":";
    message_schema::AppendJsonString(json, image.encoding);
  }
  json += ",\"data\":\"";
  message_schema::AppendBase64(json, image.data);
  json += "\"}";
  out.push_back({"/" + std::string(channel),
                 is_jpeg ? "foxglove.CompressedImage" : "foxglove.RawImage", std::move(json)});
}

void AddLog(std::int64_t utime, int level, const std::string& name, const std::string& text,
            std::vector<ViewMessage>& out) {
  std::string json = "{\"timestamp\":" + TimeJson(utime).dump() +
                     ",\"level\":" + std::to_string(level) + ",\"message\":";
  message_schema::AppendJsonString(json, text);
  json += ",\"name\":";
  message_schema::AppendJsonString(json, name);
  json += R"(,"file":"","line":0})";
  out.push_back({"/log", "foxglove.Log", std::move(json)});
}

void AddReport(std::span<const std::uint8_t> bytes, std::vector<ViewMessage>& out) {
  misbehavior_report_t report;
  if (!Decoded(bytes, report)) return;
  const bool is_accused = report.verdict == misbehavior_report_t::ACCUSE;
  std::string text = "sender " + Hex(report.sender_id, 4) +
                     (is_accused ? " accused: " : " withdrawn: ") + report.check;
  for (const evidence_t& evidence : report.evidence) {
    char figure[48];
    std::snprintf(figure, sizeof(figure), " = %.3g", evidence.value);
    text += ", " + evidence.name + figure;
  }
  AddLog(report.utime, is_accused ? kError : kWarning, "misbehavior", text, out);
}

void AddNotices(std::span<const std::uint8_t> bytes, std::vector<ViewMessage>& out) {
  daemon_status_t status;
  if (!Decoded(bytes, status)) return;
  for (const notice_t& notice : status.notices) {
    AddLog(status.utime, kWarning, notice.name + ' ' + notice.channel, notice.advice, out);
  }
}

}  // namespace

std::vector<ViewMessage> FoxgloveMessages(std::string_view channel,
                                          std::span<const std::uint8_t> message) {
  std::vector<ViewMessage> out;
  const message_schema::Type* type = message_schema::TypeOf(message);
  if (type == nullptr) return out;
  if (type->name == "track_list_t") AddTracks(channel, message, out);
  if (type->name == "truth_list_t") AddTruth(message, out);
  if (type->name == "gnss_fix_t") AddFix(message, out);
  if (type->name == "camera_image_t") AddImage(channel, message, out);
  if (type->name == "misbehavior_report_t") AddReport(message, out);
  if (type->name == "daemon_status_t") AddNotices(message, out);
  return out;
}

}  // namespace v2vouch::mcap_export
