// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/view/page_frame.h"

#include <algorithm>
#include <cmath>

#include "daemon/rim/json/json_text.h"
#include "daemon/rim/wire/sender_id.h"

namespace v2vouch::view {
namespace {

using wire::SenderName;
using wire::SenderOf;

constexpr std::size_t kMostSenders = 300;  // Drawn; the nearest.
constexpr std::size_t kMostRadarPoints = 1500;
constexpr std::int64_t kMostEventsAtOnce = 200;
constexpr std::int64_t kOldest_us = 500'000;  // Own-sensor messages older than this are not drawn.

bool IsRecent(std::int64_t utime, std::int64_t now) {
  return std::abs(static_cast<double>(now) - static_cast<double>(utime)) <=
         static_cast<double>(kOldest_us);
}

double AgeOf(std::int64_t utime, std::int64_t now) {
  return 1e-6 * (static_cast<double>(now) - static_cast<double>(utime));
}

void PutCovariance(JsonText& json, const track_t& track) {
  json.Key("cov").Open('[');
  json.Number(track.covariance_odom[0], 4);
  json.Number(track.covariance_odom[1], 4);
  json.Number(track.covariance_odom[7], 4);
  json.Close(']');
}

void PutMotion(JsonText& json, const track_t& track) {
  json.Number("x", track.x_odom_m).Number("y", track.y_odom_m);
  json.Number("yaw", track.yaw_odom_rad, 4).Number("v", track.speed_mps, 2);
  json.Number("len", track.length_m, 2).Number("wid", track.width_m, 2);
}

void PutTrack(JsonText& json, const track_t& track, std::int64_t now, bool is_priority) {
  // An id has 63 bits, more than a number of JavaScript: a text.
  json.Open('{').Text("id", std::to_string(track.id));
  PutMotion(json, track);
  json.Number("yr", track.yaw_rate_radps, 3).Number("acc", track.accel_mps2, 2);
  json.Number("vs", std::sqrt(std::max(0.0, track.covariance_odom[21])), 2);
  json.Integer("cls", track.object_class).Number("ex", track.existence, 3);
  json.Integer("vis", track.visibility);
  json.Number("since", AgeOf(track.start_utime, now), 1);
  PutCovariance(json, track);
  json.Key("src").Open('[');
  for (const track_source_t& source : track.sources) {
    json.Open('[').Integer(source.kind).Text(source.name);
    json.Number(AgeOf(source.last_utime, now), 2).Close(']');
  }
  json.Close(']');
  if (is_priority) {
    json.Text("local", track.local_id == 0 ? "" : std::to_string(track.local_id));
    json.Text("sender", SenderName(SenderOf(track.v2v_id)));
    json.Integer("trust", track.trust_state).Number("budget", track.bridge_budget_s, 2);
    json.Key("bias").Open('[').Number(track.bias_east_m, 2).Number(track.bias_north_m, 2);
    json.Close(']');
    json.Integer("events", track.events);
  }
  json.Close('}');
}

void PutTracks(JsonText& json, std::string_view key, const Newest<track_list_t>& list,
               bool is_priority) {
  json.Key(key).Open('[');
  if (list.message) {
    for (const track_t& track : list.message->tracks) {
      if (track.is_confirmed == 0) continue;
      PutTrack(json, track, list.message->utime, is_priority);
    }
  }
  json.Close(']');
}

void PutVerdicts(JsonText& json, const Scene& scene, std::uint32_t sender, std::int64_t now) {
  const auto* verdicts = scene.VerdictsOf(sender);
  if (verdicts == nullptr) return;
  json.Key("said").Open('[');
  for (const SenderVerdict& verdict : *verdicts) {
    json.Open('[').Number(AgeOf(verdict.utime, now), 1).Text(verdict.text);
    json.Integer(verdict.times).Close(']');
  }
  json.Close(']');
}

// The vehicle that the sender's claims are taken for; nullptr where there is none.
const track_t* VehicleOf(const Scene& scene, std::uint32_t sender) {
  const auto& priority = scene.list(Scene::List::kPriority).message;
  if (!priority) return nullptr;
  for (const track_t& track : priority->tracks) {
    if (SenderOf(track.v2v_id) == sender) return &track;
  }
  return nullptr;
}

void PutSenders(JsonText& json, const Scene& scene) {
  json.Key("senders").Open('[');
  const auto& list = scene.list(Scene::List::kV2v).message;
  if (list) {
    std::vector<const track_t*> nearest;
    for (const track_t& track : list->tracks) nearest.push_back(&track);
    const std::size_t count = std::min(nearest.size(), kMostSenders);
    const auto distance = [](const track_t* track) {
      const double d = std::hypot(track->x_body_m, track->y_body_m);
      return std::isfinite(d) ? d : 1e12;
    };
    std::partial_sort(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(count),
                      nearest.end(), [&](const track_t* a, const track_t* b) {
                        return std::pair(distance(a), a->id) < std::pair(distance(b), b->id);
                      });
    nearest.resize(count);
    for (const track_t* track : nearest) {
      const std::uint32_t sender = SenderOf(track->v2v_id);
      std::int64_t last = 0;
      for (const track_source_t& source : track->sources) last = std::max(last, source.last_utime);
      json.Open('{').Text("id", SenderName(sender));
      PutMotion(json, *track);
      json.Integer("trust", track->trust_state);
      json.Number("age", last == 0 ? NAN : AgeOf(last, list->utime), 2);
      json.Key("bias").Open('[').Number(track->bias_east_m, 2).Number(track->bias_north_m, 2);
      json.Close(']');
      if (const track_t* vehicle = VehicleOf(scene, sender)) {
        json.Text("vehicle", std::to_string(vehicle->id));
      } else if (track->local_id != 0) {
        json.Text("track", std::to_string(track->local_id));
      }
      if (scene.IsLiar(sender)) json.Bool("liar", true);
      PutVerdicts(json, scene, sender, list->utime);
      json.Close('}');
    }
  }
  json.Close(']');
  json.Integer("heard", list ? static_cast<std::int64_t>(list->tracks.size()) : 0);
}

// Points [x, y, range rate, ...]; the rate over ground, the car's own share taken off.
void PutRadar(JsonText& json, const Scene& scene, std::int64_t now) {
  json.Key("radar").Open('[');
  std::size_t points = 0;
  const auto& motion = scene.ego_motion().message;
  for (std::size_t i = 0; i < scene.radars().size(); ++i) {
    const auto& scan = scene.radars()[i].message;
    if (!scan || !IsRecent(scan->utime, now)) continue;
    const auto ego = scene.EgoAt(scan->utime);
    if (!ego) continue;
    const RadarConfig& radar = scene.vehicle().radars[i];
    for (const radar_detection_t& d : scan->detections) {
      if (++points > kMostRadarPoints) break;
      const double range = d.range_m + radar.range_offset_m;
      const double azimuth = radar.yaw_rad + (radar.flip_azimuth ? -d.azimuth_rad : d.azimuth_rad);
      const MapPoint p = ego->ToOuter(radar.x_m + range * std::cos(azimuth),
                                      radar.y_m + range * std::sin(azimuth));
      double rate = radar.flip_range_rate ? -d.range_rate_mps : d.range_rate_mps;
      if (motion) {
        const double yaw_rate =
            std::isfinite(motion->yaw_rate_radps) ? motion->yaw_rate_radps : 0.0;
        rate += (motion->speed_mps - yaw_rate * radar.y_m) * std::cos(azimuth) +
                yaw_rate * radar.x_m * std::sin(azimuth);
      }
      if (!std::isfinite(p.x_m) || !std::isfinite(p.y_m)) continue;
      json.Number(p.x_m, 2).Number(p.y_m, 2).Number(rate, 1);
    }
  }
  json.Close(']');
}

// Each camera's place, and of each box the two edges' directions in the odometry frame. The picture
// is taken as free of distortion: good for looking, not for measuring.
void PutCameras(JsonText& json, const Scene& scene, std::int64_t now) {
  json.Key("cameras").Open('[');
  for (std::size_t i = 0; i < scene.boxes().size(); ++i) {
    const CameraConfig& camera = scene.vehicle().cameras[i];
    json.Open('{').Text("name", camera.name);
    const auto& picture = scene.pictures()[i].message;
    json.Bool("picture", picture.has_value());
    const auto& boxes = scene.boxes()[i].message;
    if (boxes && IsRecent(boxes->utime, now)) {
      const auto ego = scene.EgoAt(boxes->utime);
      if (ego) {
        const MapPoint p = ego->ToOuter(camera.x_m, camera.y_m);
        json.Number("x", p.x_m).Number("y", p.y_m).Number("range", camera.max_range_m, 0);
      }
      const int width = boxes->image_width_px > 0 ? boxes->image_width_px : camera.image_width_px;
      const int height =
          boxes->image_height_px > 0 ? boxes->image_height_px : camera.image_height_px;
      json.Integer("w", width).Integer("h", height);
      json.Key("boxes").Open('[');
      for (const camera_box_t& box : boxes->boxes) {
        const auto direction = [&](double u) {
          const double yaw = ego ? ego->yaw_rad : 0.0;
          return yaw + camera.yaw_rad - std::atan2(u - camera.cx_px, camera.fx_px);
        };
        json.Open('[').Number(box.left_px, 1).Number(box.top_px, 1);
        json.Number(box.width_px, 1).Number(box.height_px, 1);
        json.Text(box.class_name).Number(box.score, 2);
        json.Number(direction(box.left_px), 4).Number(direction(box.left_px + box.width_px), 4);
        json.Close(']');
      }
      json.Close(']');
    }
    json.Close('}');
  }
  json.Close(']');
}

void PutObjects(JsonText& json, const Scene& scene, std::int64_t now) {
  json.Key("objects").Open('[');
  for (std::size_t i = 0; i < scene.objects().size(); ++i) {
    const auto& list = scene.objects()[i].message;
    if (!list || !IsRecent(list->utime, now)) continue;
    const auto ego = scene.EgoAt(list->utime);
    if (!ego) continue;
    const ObjectSensorConfig& sensor = scene.vehicle().objects[i];
    const MapPoint origin = ego->ToOuter(sensor.x_m, sensor.y_m);
    const FlatPose frame{origin.x_m, origin.y_m, ego->yaw_rad + sensor.yaw_rad};
    for (const object_t& object : list->objects) {
      const MapPoint p = frame.ToOuter(object.x_m, object.y_m);
      if (!std::isfinite(p.x_m) || !std::isfinite(p.y_m)) continue;
      const double yaw = std::isfinite(object.yaw_rad) ? object.yaw_rad : 0.0;
      json.Open('[').Number(p.x_m, 2).Number(p.y_m, 2).Number(frame.yaw_rad + yaw, 3);
      json.Number(object.length_m, 2).Number(object.width_m, 2).Close(']');
    }
  }
  json.Close(']');
}

void PutTruth(JsonText& json, const Scene& scene) {
  const auto world = scene.WorldInOdom();
  if (!world) return;
  json.Key("world").Open('[').Number(world->x_m).Number(world->y_m).Number(world->yaw_rad, 6);
  json.Close(']');
  json.Key("truth").Open('[');
  for (const truth_object_t& object : scene.truth().message->objects) {
    const MapPoint p = world->ToOuter(object.x_m, object.y_m);
    json.Open('{').Integer("id", object.id).Number("x", p.x_m, 2).Number("y", p.y_m, 2);
    json.Number("yaw", world->yaw_rad + object.yaw_rad, 4).Number("len", object.length_m, 2);
    json.Number("wid", object.width_m, 2).Bool("hidden", object.is_hidden != 0);
    json.Bool("v2v", object.has_v2v != 0).Close('}');
  }
  json.Close(']');
}

// Body frame of the ego at the warnings' time -> odometry frame.
void PutWarnings(JsonText& json, const Scene& scene, std::int64_t now) {
  json.Key("warnings").Open('[');
  const auto& list = scene.warnings().message;
  const auto ego = list ? scene.EgoAt(list->utime) : std::nullopt;
  if (ego && IsRecent(list->utime, now)) {
    for (const warning_t& warning : list->warnings) {
      const MapPoint at = ego->ToOuter(warning.x_body_m, warning.y_body_m);
      const MapPoint conflict = ego->ToOuter(warning.conflict_x_body_m, warning.conflict_y_body_m);
      json.Open('{').Integer("kind", warning.kind).Integer("level", warning.level);
      json.Text("vehicle", warning.track_id == 0 ? "" : std::to_string(warning.track_id));
      json.Text("local", warning.local_id == 0 ? "" : std::to_string(warning.local_id));
      json.Number("x", at.x_m, 2).Number("y", at.y_m, 2);
      json.Number("cx", conflict.x_m, 2).Number("cy", conflict.y_m, 2);
      json.Number("ttc", warning.time_to_conflict_s, 1).Close('}');
    }
  }
  json.Close(']');
}

void PutLines(JsonText& json, std::string_view key,
              const std::vector<std::vector<MapPoint>>& lines) {
  json.Key(key).Open('[');
  for (const auto& line : lines) {
    json.Open('[');
    for (const MapPoint& p : line) json.Number(p.x_m, 2).Number(p.y_m, 2);
    json.Close(']');
  }
  json.Close(']');
}

}  // namespace

std::string PageFrame(const Scene& scene) {
  JsonText json;
  const auto& local = scene.list(Scene::List::kLocal);
  const auto& priority = scene.list(Scene::List::kPriority);
  const auto& newest = local.revision >= priority.revision ? local : priority;
  const std::int64_t now = scene.list_utime();
  json.Open('{').Text("k", "scene").Integer("t", now);
  json.Integer("rx", scene.list_received());
  json.Integer("seq", newest.message ? newest.message->seq : -1);
  json.Bool("stale", newest.message && newest.message->stale != 0);
  json.Bool("suspect", priority.message && priority.message->ego_gnss_suspect != 0);
  if (const auto ego = scene.EgoAt(now)) {
    json.Key("ego").Open('{').Number("x", ego->x_m).Number("y", ego->y_m);
    json.Number("yaw", ego->yaw_rad, 5);
    const auto& motion = scene.ego_motion().message;
    json.Number("v", motion ? motion->speed_mps : NAN, 2);
    json.Number("yr", motion ? motion->yaw_rate_radps : NAN, 3);
    json.Number("len", scene.vehicle().length_m, 2).Number("wid", scene.vehicle().width_m, 2);
    json.Number("cx", scene.vehicle().centre_x_m, 2).Close('}');
  }
  json.Key("trail").Open('[');
  for (const MapPoint& p : scene.trail()) json.Number(p.x_m, 1).Number(p.y_m, 1);
  json.Close(']');
  json.Key("sectors").Open('[');
  if (newest.message) {
    for (const sector_health_t& sector : newest.message->sectors) {
      json.Open('[').Number(sector.from_rad, 4).Number(sector.to_rad, 4);
      json.Number(sector.range_m, 1).Integer(sector.state).Close(']');
    }
  }
  json.Close(']');
  PutTracks(json, "local", local, false);
  PutTracks(json, "priority", priority, true);
  PutSenders(json, scene);
  PutRadar(json, scene, now);
  PutCameras(json, scene, now);
  PutObjects(json, scene, now);
  PutTruth(json, scene);
  PutWarnings(json, scene, now);
  json.Integer("refused", scene.refused()).Close('}');
  return json.Take();
}

std::string PageStatus(const Scene& scene) {
  JsonText json;
  json.Open('{').Text("k", "status");
  if (const auto& status = scene.status().message) {
    json.Integer("t", status->utime).Text("version", status->version);
    json.Text("calibration", status->calibration);
    json.Key("inputs").Open('[');
    for (const input_status_t& input : status->inputs) {
      json.Open('{').Text("name", input.channel).Number("hz", input.rate_hz, 1);
      json.Number("age", input.age_s, 2).Integer("gaps", input.gaps);
      json.Integer("got", input.received).Integer("taken", input.accepted);
      json.Bool("silent", input.is_silent != 0).Close('}');
    }
    json.Close(']');
    json.Key("latency").Open('[');
    for (const stage_latency_t& stage : status->latencies) {
      json.Open('{').Text("stage", stage.stage).Number("p50", stage.p50_us, 0);
      json.Number("p99", stage.p99_us, 0).Number("max", stage.max_us, 0).Close('}');
    }
    json.Close(']');
    json.Key("refusals").Open('[');
    for (const count_t& refusal : status->refusals) {
      json.Open('[').Text(refusal.name).Integer(refusal.count).Close(']');
    }
    json.Close(']');
    json.Key("notices").Open('[');
    for (const notice_t& notice : status->notices) {
      json.Open('{').Text("name", notice.name).Text("channel", notice.channel);
      json.Number("value", notice.value).Text("advice", notice.advice).Close('}');
    }
    json.Close(']');
    json.Integer("drops_own", status->queue_drops_own)
        .Integer("drops_bsm", status->queue_drops_bsm);
    json.Integer("drops_kernel", status->kernel_drops);
    json.Integer("local", status->local_tracks).Integer("priority", status->priority_tracks);
    json.Integer("senders", status->v2v_senders);
  }
  json.Close('}');
  return json.Take();
}

std::string PageMap(const RoadMap& map) {
  JsonText json;
  json.Open('{').Text("k", "map").Text("name", map.name);
  PutLines(json, "lanes", map.lanes);
  PutLines(json, "buildings", map.buildings);
  json.Close('}');
  return json.Take();
}

std::string PageEvents(const EventList& events, std::int64_t from, std::int64_t& next) {
  JsonText json;
  json.Open('{').Text("k", "events").Key("events").Open('[');
  next = from;
  std::int64_t count = 0;
  for (const ViewEvent& event : events.events()) {
    if (event.number < from) continue;
    if (++count > kMostEventsAtOnce) break;
    json.Open('{').Integer("n", event.number).Integer("t", event.at).Text("kind", event.kind);
    json.Text("text", event.text);
    if (event.track_id != 0) json.Text("vehicle", std::to_string(event.track_id));
    if (event.local_id != 0) json.Text("track", std::to_string(event.local_id));
    if (event.sender != 0) json.Text("sender", SenderName(event.sender));
    json.Close('}');
    next = event.number + 1;
  }
  json.Close(']').Close('}');
  return json.Take();
}

std::string PagePicture(const Scene& scene, std::size_t camera) {
  const auto& picture = scene.pictures()[camera].message;
  if (!picture || picture->encoding != "jpeg") return {};
  JsonText head;
  head.Open('{').Text("camera", scene.vehicle().cameras[camera].name);
  head.Integer("t", picture->utime)
      .Integer("w", picture->width_px)
      .Integer("h", picture->height_px);
  head.Close('}');
  std::string out(1, '\x10');
  const auto size = static_cast<std::uint32_t>(head.text().size());
  for (int i = 0; i < 4; ++i) out += static_cast<char>((size >> (8 * i)) & 255);
  out += head.text();
  out.append(reinterpret_cast<const char*>(picture->data.data()), picture->data.size());
  return out;
}

}  // namespace v2vouch::view
