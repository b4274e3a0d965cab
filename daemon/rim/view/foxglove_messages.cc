// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/view/foxglove_messages.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/rim/view/json_text.h"
#include "daemon/rim/view/page_frame.h"

namespace v2vouch::view {
namespace {

using Content = FoxgloveTopic::Content;

struct Colour {
  double r, g, b, a;
};
// Okabe and Ito's colours, as on the page.
constexpr Colour kBlue{0.0, 0.45, 0.70, 0.8};
constexpr Colour kGreen{0.0, 0.62, 0.45, 0.9};
constexpr Colour kOrange{0.90, 0.62, 0.0, 0.9};
constexpr Colour kRed{0.84, 0.37, 0.0, 0.9};
constexpr Colour kGrey{0.6, 0.6, 0.6, 0.7};
constexpr Colour kPurple{0.80, 0.47, 0.65, 0.9};

Colour ColourOfTrust(int trust) {
  switch (trust) {
    case track_t::TRUST_VALIDATED:
      return kGreen;
    case track_t::TRUST_BRIDGED:
      return kOrange;
    case track_t::TRUST_SUSPECT:
    case track_t::TRUST_REVOKED:
      return kRed;
    default:
      return kGrey;
  }
}

void PutTime(JsonText& json, std::string_view key, std::int64_t utime) {
  const std::int64_t us = std::max<std::int64_t>(utime, 0);
  json.Key(key).Open('{').Integer("sec", us / 1'000'000).Integer("nsec", us % 1'000'000 * 1000);
  json.Close('}');
}

void PutVector(JsonText& json, std::string_view key, double x, double y, double z) {
  json.Key(key).Open('{').Number("x", x).Number("y", y).Number("z", z).Close('}');
}

void PutRotation(JsonText& json, std::string_view key, double yaw) {
  json.Key(key).Open('{').Integer("x", 0).Integer("y", 0).Number("z", std::sin(yaw / 2), 6);
  json.Number("w", std::cos(yaw / 2), 6).Close('}');
}

void PutPose(JsonText& json, double x, double y, double z, double yaw) {
  json.Key("pose").Open('{');
  PutVector(json, "position", x, y, z);
  PutRotation(json, "orientation", yaw);
  json.Close('}');
}

void PutColour(JsonText& json, Colour colour) {
  json.Key("color").Open('{').Number("r", colour.r).Number("g", colour.g).Number("b", colour.b);
  json.Number("a", colour.a).Close('}');
}

void Empty(JsonText& json, std::initializer_list<std::string_view> keys) {
  for (const std::string_view key : keys) json.Key(key).Open('[').Close(']');
}

void OpenEntity(JsonText& json, std::string_view id, std::int64_t utime) {
  json.Open('{');
  PutTime(json, "timestamp", utime);
  json.Text("frame_id", "odom").Text("id", id);
  json.Key("lifetime").Open('{').Integer("sec", 0).Integer("nsec", 500'000'000).Close('}');
  json.Bool("frame_locked", false);
}

void PutMetadata(JsonText& json,
                 std::initializer_list<std::pair<std::string_view, std::string>> items) {
  json.Key("metadata").Open('[');
  for (const auto& [key, value] : items) {
    json.Open('{').Text("key", key).Text("value", value).Close('}');
  }
  json.Close(']');
}

void PutBox(JsonText& json, double x, double y, double yaw, double length, double width,
            Colour colour) {
  constexpr double kHeight_m = 1.5;
  json.Key("cubes").Open('[').Open('{');
  PutPose(json, x, y, kHeight_m / 2, yaw);
  PutVector(json, "size", length, width, kHeight_m);
  PutColour(json, colour);
  json.Close('}').Close(']');
}

void PutLabel(JsonText& json, double x, double y, std::string_view text) {
  json.Key("texts").Open('[').Open('{');
  PutPose(json, x, y, 2.5, 0.0);
  json.Bool("billboard", true).Number("font_size", 14.0).Bool("scale_invariant", true);
  PutColour(json, {1.0, 1.0, 1.0, 1.0});
  json.Text("text", text).Close('}').Close(']');
}

// The area that holds the vehicle's centre with 95 %, as a closed line.
void PutEllipse(JsonText& json, const track_t& track, Colour colour) {
  const double xx = track.covariance_odom[0], xy = track.covariance_odom[1],
               yy = track.covariance_odom[7];
  const double mean = 0.5 * (xx + yy), root = std::hypot(0.5 * (xx - yy), xy);
  constexpr double kChi2 = 5.991;  // 95 %, two degrees of freedom.
  const double a = std::sqrt(kChi2 * std::max(mean + root, 0.0));
  const double b = std::sqrt(kChi2 * std::max(mean - root, 0.0));
  const FlatPose axes{track.x_odom_m, track.y_odom_m, 0.5 * std::atan2(2 * xy, xx - yy)};
  json.Key("lines").Open('[').Open('{').Integer("type", 1);  // LINE_LOOP
  PutPose(json, 0, 0, 0, 0);
  json.Number("thickness", 2.0).Bool("scale_invariant", true).Key("points").Open('[');
  constexpr int kPoints = 24;
  for (int i = 0; i < kPoints; ++i) {
    const double angle = 2 * kPi * i / kPoints;
    const MapPoint p = axes.ToOuter(a * std::cos(angle), b * std::sin(angle));
    json.Open('{').Number("x", p.x_m).Number("y", p.y_m).Number("z", 0.1).Close('}');
  }
  json.Close(']');
  PutColour(json, colour);
  Empty(json, {"colors", "indices"});
  json.Close('}').Close(']');
}

bool IsDrawable(const track_t& track) {
  return std::isfinite(track.x_odom_m) && std::isfinite(track.y_odom_m) &&
         std::isfinite(track.yaw_odom_rad);
}

double SizeOr(double size, double fallback) { return size > 0.0 ? size : fallback; }

void PutTrack(JsonText& json, const track_t& track, std::int64_t utime, bool is_priority) {
  const bool is_hidden = is_priority && track.local_id == 0;
  const Colour colour = is_priority ? (is_hidden ? kOrange : kGreen) : kBlue;
  const std::string id = std::to_string(track.id);
  OpenEntity(json, (is_priority ? "priority_" : "local_") + id, utime);
  PutMetadata(json, {{"existence", std::to_string(track.existence)},
                     {"speed_mps", std::to_string(track.speed_mps)},
                     {"bridge_budget_s", std::to_string(track.bridge_budget_s)},
                     {"sender", is_priority ? SenderName(SenderOf(track.v2v_id)) : ""}});
  PutBox(json, track.x_odom_m, track.y_odom_m, track.yaw_odom_rad, SizeOr(track.length_m, 4.0),
         SizeOr(track.width_m, 1.8), colour);
  PutEllipse(json, track, colour);
  std::string label = id.substr(id.size() > 4 ? id.size() - 4 : 0);
  if (is_hidden && std::isfinite(track.bridge_budget_s)) {
    label += " hidden, " + std::to_string(static_cast<int>(track.bridge_budget_s)) + " s left";
  }
  PutLabel(json, track.x_odom_m, track.y_odom_m, label);
  Empty(json, {"arrows", "spheres", "cylinders", "triangles", "models"});
  json.Close('}');
}

void PutSender(JsonText& json, const track_t& track, std::int64_t utime) {
  const Colour colour = ColourOfTrust(track.trust_state);
  const std::string name = SenderName(SenderOf(track.v2v_id));
  OpenEntity(json, "sender_" + name, utime);
  PutMetadata(json, {{"trust_state", std::to_string(track.trust_state)}});
  json.Key("arrows").Open('[').Open('{');
  PutPose(json, track.x_odom_m, track.y_odom_m, 0.5, track.yaw_odom_rad);
  json.Number("shaft_length", 2.5).Number("shaft_diameter", 0.3);
  json.Number("head_length", 1.2).Number("head_diameter", 1.0);
  PutColour(json, colour);
  json.Close('}').Close(']');
  PutLabel(json, track.x_odom_m, track.y_odom_m, name);
  Empty(json, {"cubes", "spheres", "cylinders", "lines", "triangles", "models"});
  json.Close('}');
}

void PutRadar(JsonText& json, const Scene& scene, std::size_t index) {
  const auto& scan = scene.radars()[index].message;
  if (!scan) return;
  const auto ego = scene.EgoAt(scan->utime);
  if (!ego) return;
  const RadarConfig& radar = scene.vehicle().radars[index];
  OpenEntity(json, "radar_" + radar.name, scene.list_utime());
  PutMetadata(json, {});
  // A tick along the beam for each reflection, as long as its Doppler.
  json.Key("lines").Open('[').Open('{').Integer("type", 2);  // LINE_LIST
  PutPose(json, 0, 0, 0, 0);
  json.Number("thickness", 3.0).Bool("scale_invariant", true).Key("points").Open('[');
  for (const radar_detection_t& d : scan->detections) {
    const double azimuth = radar.yaw_rad + (radar.flip_azimuth ? -d.azimuth_rad : d.azimuth_rad);
    const double rate = radar.flip_range_rate ? -d.range_rate_mps : d.range_rate_mps;
    const double tick = std::clamp(0.1 * rate, -5.0, 5.0);
    for (const double r : {d.range_m, d.range_m + (std::abs(tick) < 0.2 ? 0.2 : tick)}) {
      const MapPoint p = ego->ToOuter(radar.x_m + (r + radar.range_offset_m) * std::cos(azimuth),
                                      radar.y_m + (r + radar.range_offset_m) * std::sin(azimuth));
      json.Open('{').Number("x", p.x_m, 2).Number("y", p.y_m, 2).Number("z", 0.5).Close('}');
    }
  }
  json.Close(']');
  PutColour(json, kPurple);
  Empty(json, {"colors", "indices"});
  json.Close('}').Close(']');
  Empty(json, {"arrows", "cubes", "spheres", "cylinders", "triangles", "texts", "models"});
  json.Close('}');
}

void PutTruth(JsonText& json, const Scene& scene) {
  const auto world = scene.WorldInOdom();
  if (!world) return;
  for (const truth_object_t& object : scene.truth().message->objects) {
    const MapPoint p = world->ToOuter(object.x_m, object.y_m);
    if (!std::isfinite(p.x_m) || !std::isfinite(p.y_m)) continue;
    OpenEntity(json, "truth_" + std::to_string(object.id), scene.list_utime());
    PutMetadata(json, {{"hidden", object.is_hidden != 0 ? "yes" : "no"}});
    PutBox(json, p.x_m, p.y_m, world->yaw_rad + object.yaw_rad, SizeOr(object.length_m, 4.0),
           SizeOr(object.width_m, 1.8), {0.5, 0.5, 0.5, 0.3});
    Empty(json, {"arrows", "spheres", "cylinders", "lines", "triangles", "texts", "models"});
    json.Close('}');
  }
}

std::string SceneUpdate(const Scene& scene, Content content, bool clears) {
  JsonText json;
  json.Open('{').Key("deletions").Open('[');
  if (clears) {
    json.Open('{');
    PutTime(json, "timestamp", scene.list_utime());
    json.Integer("type", 1).Text("id", "").Close('}');  // All.
  }
  json.Close(']').Key("entities").Open('[');
  const auto each = [&](Scene::List which, auto put) {
    const auto& list = scene.list(which).message;
    if (!list) return;
    for (const track_t& track : list->tracks) {
      if (IsDrawable(track)) put(track, list->utime);
    }
  };
  switch (content) {
    case Content::kLocal:
      each(Scene::List::kLocal,
           [&](const track_t& track, std::int64_t t) { PutTrack(json, track, t, false); });
      break;
    case Content::kPriority:
      each(Scene::List::kPriority,
           [&](const track_t& track, std::int64_t t) { PutTrack(json, track, t, true); });
      break;
    case Content::kSenders:
      each(Scene::List::kV2v,
           [&](const track_t& track, std::int64_t t) { PutSender(json, track, t); });
      break;
    case Content::kRadar:
      for (std::size_t i = 0; i < scene.radars().size(); ++i) PutRadar(json, scene, i);
      break;
    default:
      PutTruth(json, scene);
  }
  json.Close(']').Close('}');
  return json.Take();
}

std::string Transform(const Scene& scene) {
  JsonText json;
  const FlatPose ego = scene.EgoAt(scene.list_utime()).value_or(FlatPose{});
  json.Open('{');
  PutTime(json, "timestamp", scene.list_utime());
  json.Text("parent_frame_id", "odom").Text("child_frame_id", "base_link");
  PutVector(json, "translation", ego.x_m, ego.y_m, 0.0);
  PutRotation(json, "rotation", ego.yaw_rad);
  json.Close('}');
  return json.Take();
}

std::string Location(const gnss_fix_t& fix) {
  JsonText json;
  json.Open('{');
  PutTime(json, "timestamp", fix.utime);
  json.Text("frame_id", "base_link").Number("latitude", ToDegrees(fix.latitude_rad), 9);
  json.Number("longitude", ToDegrees(fix.longitude_rad), 9);
  json.Number("altitude", std::isfinite(fix.altitude_m) ? fix.altitude_m : 0.0);
  json.Key("position_covariance").Open('[');
  for (const double value : fix.covariance_enu_m2) {
    json.Number(std::isfinite(value) ? value : 0.0, 4);
  }
  json.Close(']').Integer("position_covariance_type", 3);  // Known.
  if (std::isfinite(fix.heading_rad)) json.Number("heading", fix.heading_rad, 5);
  json.Close('}');
  return json.Take();
}

std::string Picture(const Scene& scene, std::size_t camera) {
  const camera_image_t& picture = *scene.pictures()[camera].message;
  JsonText json;
  json.Open('{');
  PutTime(json, "timestamp", picture.utime);
  json.Text("frame_id", "camera_" + scene.vehicle().cameras[camera].name);
  json.Key("data").Raw('"' + Base64(picture.data.data(), picture.data.size()) + '"');
  json.Text("format", "jpeg").Close('}');
  return json.Take();
}

}  // namespace

std::vector<FoxgloveTopic> FoxgloveTopics(const VehicleConfig& vehicle) {
  std::vector<FoxgloveTopic> topics = {
      {"/v2vouch/local", "foxglove.SceneUpdate", Content::kLocal, 0},
      {"/v2vouch/priority", "foxglove.SceneUpdate", Content::kPriority, 0},
      {"/v2vouch/senders", "foxglove.SceneUpdate", Content::kSenders, 0},
      {"/v2vouch/radar", "foxglove.SceneUpdate", Content::kRadar, 0},
      {"/v2vouch/truth", "foxglove.SceneUpdate", Content::kTruth, 0},
      {"/tf", "foxglove.FrameTransform", Content::kTransform, 0},
      {"/ego/gnss", "foxglove.LocationFix", Content::kGnss, 0},
      {"/v2vouch/log", "foxglove.Log", Content::kLog, 0},
      {"/v2vouch/status", "v2vouch.Status", Content::kStatus, 0}};
  for (std::size_t i = 0; i < vehicle.cameras.size(); ++i) {
    topics.push_back(
        {"/camera/" + vehicle.cameras[i].name, "foxglove.CompressedImage", Content::kPicture, i});
  }
  return topics;
}

std::int64_t FoxgloveRevision(const Scene& scene, const FoxgloveTopic& topic) {
  const auto jpeg_revision = [&] {
    const auto& picture = scene.pictures()[topic.camera];
    return picture.message && picture.message->encoding == "jpeg" ? picture.revision : 0;
  };
  switch (topic.content) {
    case Content::kLocal:
      return scene.list(Scene::List::kLocal).revision;
    case Content::kPriority:
      return scene.list(Scene::List::kPriority).revision;
    case Content::kSenders:
      return scene.list(Scene::List::kV2v).revision;
    case Content::kRadar: {
      std::int64_t revision = 0;
      for (const auto& radar : scene.radars()) revision = std::max(revision, radar.revision);
      return scene.list_utime() == 0 ? 0 : revision;
    }
    case Content::kTruth:
      return scene.list_utime() == 0 ? 0 : scene.truth().revision;
    case Content::kTransform:
      return std::max(scene.list(Scene::List::kLocal).revision,
                      scene.list(Scene::List::kPriority).revision);
    case Content::kGnss:
      return scene.gnss().revision;
    case Content::kStatus:
      return scene.status().revision;
    case Content::kPicture:
      return jpeg_revision();
    case Content::kLog:
      return 0;
  }
  return 0;
}

std::string FoxgloveMessage(const Scene& scene, const FoxgloveTopic& topic, bool clears) {
  switch (topic.content) {
    case Content::kTransform:
      return Transform(scene);
    case Content::kGnss:
      return scene.gnss().message ? Location(*scene.gnss().message) : "{}";
    case Content::kStatus:
      return PageStatus(scene);
    case Content::kPicture:
      return Picture(scene, topic.camera);
    default:
      return SceneUpdate(scene, topic.content, clears);
  }
}

std::string FoxgloveLog(const ViewEvent& event) {
  JsonText json;
  json.Open('{');
  PutTime(json, "timestamp", event.at);
  const bool is_warning =
      event.kind == "withdrawn" || event.kind == "accused" || event.kind == "notice";
  json.Integer("level", is_warning ? 3 : 2).Text("message", event.text).Text("name", event.kind);
  json.Text("file", "").Integer("line", 0).Close('}');
  return json.Take();
}

}  // namespace v2vouch::view
