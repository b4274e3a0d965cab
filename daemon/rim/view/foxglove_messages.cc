// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/view/foxglove_messages.h"

#include <algorithm>
#include <cmath>

#include "daemon/rim/foxglove/flat_tracks.h"
#include "daemon/rim/foxglove/messages.h"
#include "daemon/rim/foxglove/primitives.h"
#include "daemon/rim/foxglove/scenes.h"
#include "daemon/rim/view/page_frame.h"

namespace v2vouch::view {
namespace {

using Content = FoxgloveTopic::Content;
using namespace foxglove;  // NOLINT(google-build-using-namespace): its building blocks.

void PutRadar(JsonText& json, const Scene& scene, std::size_t index) {
  const auto& scan = scene.radars()[index].message;
  if (!scan) return;
  const auto ego = scene.EgoAt(scan->utime);
  if (!ego) return;
  const RadarConfig& radar = scene.vehicle().radars[index];
  OpenEntity(json, "radar_" + radar.name, scene.list_utime(), "odom");
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
  PutEmpty(json, {"colors", "indices"});
  json.Close('}').Close(']');
  PutEmpty(json, {"arrows", "cubes", "spheres", "cylinders", "triangles", "texts", "models"});
  json.Close('}');
}

std::string RadarScene(const Scene& scene, bool clears) {
  JsonText json;
  OpenScene(json, scene.list_utime(), clears);
  for (std::size_t i = 0; i < scene.radars().size(); ++i) PutRadar(json, scene, i);
  CloseScene(json);
  return json.Take();
}

std::string ListScene(const Scene& scene, Scene::List which, ListKind kind, bool clears) {
  static const track_list_t kNone{};
  const auto& list = scene.list(which).message;
  return TrackScene(list ? *list : kNone, kind, clears);
}

std::string Flat(const Scene& scene, Scene::List which) {
  const auto& list = scene.list(which).message;
  return list ? FlatTracks(*list) : "{}";
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
      {"/v2vouch/status", "v2vouch.Status", Content::kStatus, 0},
      {"/v2vouch/plot/local", "v2vouch.FlatTracks", Content::kFlatLocal, 0},
      {"/v2vouch/plot/priority", "v2vouch.FlatTracks", Content::kFlatPriority, 0}};
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
    case Content::kFlatLocal:
      return scene.list(Scene::List::kLocal).revision;
    case Content::kPriority:
    case Content::kFlatPriority:
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
    case Content::kLocal:
      return ListScene(scene, Scene::List::kLocal, ListKind::kLocal, clears);
    case Content::kPriority:
      return ListScene(scene, Scene::List::kPriority, ListKind::kPriority, clears);
    case Content::kSenders:
      return ListScene(scene, Scene::List::kV2v, ListKind::kSenders, clears);
    case Content::kRadar:
      return RadarScene(scene, clears);
    case Content::kTruth:
      return scene.truth().message ? TruthScene(*scene.truth().message, clears) : "{}";
    case Content::kTransform: {
      const FlatPose ego = scene.EgoAt(scene.list_utime()).value_or(FlatPose{});
      return EgoTransform(scene.list_utime(), ego.x_m, ego.y_m, ego.yaw_rad);
    }
    case Content::kGnss:
      return scene.gnss().message ? Location(*scene.gnss().message) : "{}";
    case Content::kStatus:
      return PageStatus(scene);
    case Content::kPicture:
      return PictureOf(*scene.pictures()[topic.camera].message).json;
    case Content::kFlatLocal:
      return Flat(scene, Scene::List::kLocal);
    case Content::kFlatPriority:
      return Flat(scene, Scene::List::kPriority);
    case Content::kLog:
      break;  // Events, one by one: FoxgloveLog().
  }
  return "{}";
}

std::string FoxgloveLog(const ViewEvent& event) {
  const bool is_warning = event.kind == "withdrawn" || event.kind == "accused" ||
                          event.kind == "warned" || event.kind == "notice";
  return LogLine(event.at, is_warning ? 3 : 2, event.kind, event.text);
}

}  // namespace v2vouch::view
