// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/view/page_frame.h"

#include <algorithm>
#include <cmath>

#include "daemon/rim/json/json_text.h"
#include "daemon/rim/view/page_sensors.h"
#include "daemon/rim/wire/sender_id.h"

namespace v2vouch::view {
namespace {

using wire::SenderName;
using wire::SenderOf;

constexpr std::size_t kMostSenders = 300;  // Drawn; the nearest.

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
  PutSensors(json, scene, now);
  PutTruth(json, scene);
  PutWarnings(json, scene, now);
  json.Integer("refused", scene.refused()).Close('}');
  return json.Take();
}

}  // namespace v2vouch::view
