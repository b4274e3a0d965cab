// SPDX-License-Identifier: Apache-2.0
// What the page is sent beside its frames.
#include "daemon/rim/json/json_text.h"
#include "daemon/rim/view/page_frame.h"
#include "daemon/rim/wire/sender_id.h"

namespace v2vouch::view {
namespace {

using wire::SenderName;

constexpr std::int64_t kMostEventsAtOnce = 200;

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
