// SPDX-License-Identifier: Apache-2.0
#include "sim/report/scene_clip.h"

#include <zlib.h>

#include <algorithm>
#include <vector>

#include "daemon/rim/io/arrival_clock.h"
#include "daemon/rim/io/event_log.h"
#include "daemon/rim/json/json_text.h"
#include "daemon/rim/page/page_files.h"
#include "daemon/rim/view/page_frame.h"
#include "daemon/rim/view/scene.h"
#include "daemon/rim/view/stored_config.h"
#include "daemon/rim/wire/codec.h"
#include "v2vouch/text_t.hpp"

namespace v2vouch::evaluation {
namespace {

constexpr std::int64_t kStep_us = 100'000;
constexpr std::size_t kMostBytes = 16u << 20;

view::StoredConfig ConfigOf(const std::string& log) {
  std::string ignored;
  const auto reader = LogReader::Open(log, ignored);
  LogEvent event;
  constexpr int kFirstEvents = 1000;
  for (int i = 0; reader && i < kFirstEvents && reader->Next(event); ++i) {
    if (event.channel != wire::ChannelNames{}.config) continue;
    if (const auto text = wire::Decode<text_t>(event.bytes)) {
      return view::ReadStoredConfig(text->text);
    }
  }
  return {};
}

struct Frame {
  std::int64_t at_us;     // Arrival in the log, made never to go back.
  std::int64_t utime_us;  // Of the newest list.
  std::string json;
};

/// Frames at even steps; where they become too many bytes, every second one goes.
class Frames {
 public:
  explicit Frames(view::Scene& scene) : scene_(scene) {}

  /// Before the message that arrived at `now_us` is taken.
  void Reach(std::int64_t now_us) {
    if (now_us < next_us_) return;
    next_us_ = now_us - now_us % step_us_ + step_us_;
    Add(now_us);
  }
  void Add(std::int64_t now_us) {
    if (scene_.list_utime() == 0 || scene_.revision() == revision_) return;
    revision_ = scene_.revision();
    frames_.push_back({now_us, scene_.list_utime(), view::PageFrame(scene_)});
    bytes_ += frames_.back().json.size();
    if (bytes_ > kMostBytes && frames_.size() > 1) Thin();
  }
  [[nodiscard]] const std::vector<Frame>& all() const { return frames_; }

 private:
  void Thin() {
    std::vector<Frame> kept;
    bytes_ = 0;
    for (std::size_t i = 0; i < frames_.size(); i += 2) {
      bytes_ += frames_[i].json.size();
      kept.push_back(std::move(frames_[i]));
    }
    frames_ = std::move(kept);
    step_us_ *= 2;
  }

  view::Scene& scene_;
  std::vector<Frame> frames_;
  std::size_t bytes_ = 0;
  std::int64_t step_us_ = kStep_us;
  std::int64_t next_us_ = 0;
  std::int64_t revision_ = -1;
};

std::string EventsJson(const view::EventList& events) {
  JsonText json;
  json.Open('[');
  for (std::int64_t next = 0; next < events.next_number();) {
    const std::int64_t from = next;
    const std::string some = view::PageEvents(events, from, next);
    if (next == from) break;
    const std::size_t begin = some.find('[') + 1, end = some.rfind(']');
    json.Raw(some.substr(begin, end - begin));
  }
  json.Close(']');
  return json.Take();
}

std::string DataJson(const view::Scene& scene, const std::vector<Frame>& frames,
                     std::optional<Timestamp> first) {
  JsonText json;
  json.Open('{').Key("frames").Open('[');
  for (const Frame& frame : frames) {
    json.Raw("{\"at\":" + std::to_string(frame.at_us) + "," + frame.json.substr(1));
  }
  json.Close(']').Key("events").Raw(EventsJson(scene.events()));
  json.Key("map").Raw(scene.map().message ? view::PageMap(*scene.map().message)
                                          : R"({"lanes":[],"buildings":[]})");
  if (first) {
    const auto found = std::ranges::lower_bound(frames, ToMicros(*first), {}, &Frame::utime_us);
    if (found != frames.end()) json.Integer("first", found->at_us);
  }
  json.Close('}');
  return json.Take();
}

// "" where zlib has no memory.
std::string Gzip(const std::string& text) {
  z_stream stream{};
  constexpr int kGzip = 15 + 16, kMemory = 9;
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kGzip, kMemory, Z_DEFAULT_STRATEGY) !=
      Z_OK) {
    return {};
  }
  std::string out(deflateBound(&stream, text.size()), '\0');
  std::string in = text;  // zlib wants it writable.
  stream.next_in = reinterpret_cast<Bytef*>(in.data());
  stream.avail_in = static_cast<uInt>(in.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const bool is_done = deflate(&stream, Z_FINISH) == Z_STREAM_END;
  out.resize(is_done ? stream.total_out : 0);
  deflateEnd(&stream);
  return out;
}

std::string FileOfPage(std::string_view path) {
  for (const PageFile& file : PageFiles()) {
    if (file.path == path) return std::string(file.content);
  }
  return {};
}

constexpr char kBody[] = R"(<div id="clip" tabindex="-1">
<p class="note" style="grid-column: 1 / -1">The scene needs JavaScript.</p>
<div class="stage"><canvas class="scene" tabindex="0"></canvas><div class="late" hidden></div>
<div class="hover" hidden></div><div class="layers"></div></div>
<div class="side"><section class="details"></section><h2>Events</h2><ol class="events"></ol></div>
<div class="bar"><button class="play">Play</button>
<select class="speed" aria-label="Speed"><option value="0.25">0.25x</option><option value="0.5">0.5x</option><option value="1" selected>1x</option>
<option value="2">2x</option><option value="5">5x</option></select>
<canvas class="timeline" aria-label="Time line"></canvas><span class="time"></span></div>
</div>
)";

}  // namespace

std::string SceneClip(const std::string& log, std::optional<Timestamp> first) {
  const view::StoredConfig config = ConfigOf(log);
  view::Scene scene(config.vehicle, config.channels);
  Frames frames(scene);
  std::string ignored;
  const auto reader = LogReader::Open(log, ignored);
  LogEvent event;
  ArrivalClock clock;
  Timestamp at{};
  while (reader && reader->Next(event)) {
    at = clock.Of(event.received);
    frames.Reach(ToMicros(at));
    scene.Take(event.channel, event.bytes, at);
  }
  frames.Add(ToMicros(at));
  if (frames.all().empty()) return {};
  const std::string data = Gzip(DataJson(scene, frames.all(), first));
  std::string out =
      "<style>" + FileOfPage("/colours.css") + FileOfPage("/report.css") + "</style>\n";
  out += kBody;
  out += "<script type=\"application/gzip\" id=\"clip-data\">" +
         Base64({reinterpret_cast<const std::uint8_t*>(data.data()), data.size()}) +
         "</script>\n<script>\n";
  for (const char* file :
       {"/words.js", "/scene.js", "/details.js", "/hands.js", "/timeline.js", "/report.js"}) {
    out += FileOfPage(file);
  }
  return out + "</script>\n";
}

}  // namespace v2vouch::evaluation
