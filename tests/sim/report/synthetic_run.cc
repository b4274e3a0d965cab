// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/report/synthetic_run.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <v2vouch/bsm_t.hpp>
#include <v2vouch/camera_detections_t.hpp>
#include <v2vouch/radar_scan_t.hpp>
#include <v2vouch/text_t.hpp>
#include <v2vouch/track_list_t.hpp>
#include <v2vouch/truth_list_t.hpp>
#include <vector>

#include "daemon/common/base/random.h"
#include "daemon/rim/io/event_log.h"
#include "daemon/rim/wire/codec.h"
#include "sim/run_log/truth.h"

namespace v2vouch::evaluation {
namespace {

constexpr std::int64_t kStart_us = 1'781'510'400'000'000;

constexpr const char* kScenario = R"(name: synthetic_left_turn
sensors: {mode: realistic, noise_scale: 1.0}
buildings:
  - {x_m: 28.0, y_m: 30.0, length_m: 24.0, width_m: 26.0}
  - {x_m: 28.0, y_m: -28.0, length_m: 24.0, width_m: 26.0}
  - {x_m: 84.0, y_m: 30.0, length_m: 24.0, width_m: 26.0}
  - {x_m: 84.0, y_m: -28.0, length_m: 24.0, width_m: 26.0}
)";

struct Actor {
  std::int64_t id;
  int object_class;
  bool has_v2v;
  double length_m, width_m, height_m;
};

constexpr Actor kActors[] = {
    {1, track_t::CLASS_CAR, true, 4.5, 1.8, 1.5},
    {2, track_t::CLASS_TRUCK, false, 9.0, 2.5, 3.2},
    {3, track_t::CLASS_CAR, true, 4.6, 1.85, 1.5},
    {4, track_t::CLASS_CAR, false, 4.2, 1.75, 1.5},
    {5, track_t::CLASS_CAR, true, 4.4, 1.8, 1.5},
    {6, track_t::CLASS_PEDESTRIAN, false, 0.6, 0.6, 1.7},
};

PlanarMotion EgoAt(double t) {
  // 10 m/s braking at 1.25 m/s^2 to rest after 8 s at x = 40.
  const double moving = std::min(t, 8.0);
  PlanarMotion ego;
  ego.x_m = 10.0 * moving - 0.625 * moving * moving;
  ego.speed_mps = 10.0 - 1.25 * moving;
  ego.accel_mps2 = t < 8.0 ? -1.25 : 0.0;
  return ego;
}

PlanarMotion ActorAt(std::int64_t id, double t) {
  switch (id) {
    case 1:
      return {130.0 - 9.0 * t, 3.6, kPi, 9.0, 0.0, 0.0};
    case 2:
      return {74.0, 1.2, kPi, 0.0, 0.0, 0.0};
    case 3: {  // Straight to x = 58, then a left bend of 12 m radius at 6 m/s, then north.
      constexpr double kSpeed = 6.0, kRadius = 12.0;
      const double bend = (58.0 - 22.0) / kSpeed;
      const double turn = std::clamp((t - bend) * kSpeed / kRadius, 0.0, kPi / 2.0);
      const double after = std::max(0.0, t - bend - kPi / 2.0 * kRadius / kSpeed) * kSpeed;
      const bool is_turning = turn > 0.0 && turn < kPi / 2.0;
      const double straight = 22.0 + kSpeed * std::min(t, bend);
      return {straight + kRadius * std::sin(turn),
              kRadius * (1.0 - std::cos(turn)) + after,
              turn,
              kSpeed,
              is_turning ? kSpeed / kRadius : 0.0,
              0.0};
    }
    case 4:
      return {52.0, -6.0, 0.0, 0.0, 0.0, 0.0};
    case 5:
      return {EgoAt(t).x_m - 18.0, 0.0, 0.0, EgoAt(t).speed_mps, 0.0, EgoAt(t).accel_mps2};
    default:
      return {62.0, -12.0 + 1.2 * t, kPi / 2.0, 1.2, 0.0, 0.0};
  }
}

bool IsHidden(std::int64_t id, double t) {
  if (id == 1) return t >= SyntheticRun::kHiddenFrom_s && t < SyntheticRun::kHiddenTo_s;
  if (id == 3) return t >= 9.0;
  return id == 5;
}

void SetSender(std::int64_t id, std::uint8_t out[4]) {
  out[0] = 0x10;
  out[1] = out[2] = 0;
  out[3] = static_cast<std::uint8_t>(id);
}

class Writer {
 public:
  Writer(const SyntheticRun& run, LogWriter& log) : run_(run), log_(log), random_(run.seed) {}

  void Step(int k) {
    const double t = 0.05 * k;
    if (run_.has_truth) Truth(t);
    for (const char* name : {"FRONT", "FRONT_LEFT", "FRONT_RIGHT"}) {
      radar_scan_t scan{};
      scan.utime = Micros(t);
      scan.seq = k;
      scan.sensor = name;
      Put(std::string("RADAR_") + name, t + 0.02, scan);
    }
    if (k % 2 == 0) {
      camera_detections_t boxes{};
      boxes.utime = Micros(t);
      boxes.seq = k;
      boxes.sensor = "FRONT";
      Put("CAMERA_FRONT", t + 0.025, boxes);
      for (const Actor& actor : kActors) {
        if (actor.has_v2v) Message(actor, t);
      }
    }
    if (!run_.has_lists) return;
    List("TRACKS_LOCAL", t, 0);
    List("TRACKS_V2V", t, 1);
    List("TRACKS_PRIORITY", t, 2);
  }

  void Scenario() {
    text_t text{};
    text.name = "synthetic";
    text.text = kScenario;
    Put("SIM_SCENARIO", 0.0, text);
  }

 private:
  static std::int64_t Micros(double t) { return kStart_us + std::llround(t * 1e6); }

  template <class T>
  void Put(const std::string& channel, double received_s, const T& message) {
    wire::Encode(message, bytes_);
    log_.Write(FromMicros(Micros(received_s + run_.recorder_ahead_s)), channel, bytes_);
  }

  void Truth(double t) {
    truth_list_t list{};
    list.utime = Micros(t);
    const PlanarMotion ego = EgoAt(t);
    list.ego_x_m = ego.x_m;
    list.ego_y_m = ego.y_m;
    list.ego_yaw_rad = ego.yaw_rad;
    list.ego_speed_mps = ego.speed_mps;
    list.ego_accel_mps2 = ego.accel_mps2;
    for (const Actor& actor : kActors) {
      truth_object_t object{};
      const PlanarMotion motion = ActorAt(actor.id, t);
      object.id = actor.id;
      object.object_class = static_cast<std::int8_t>(actor.object_class);
      object.has_v2v = actor.has_v2v ? 1 : 0;
      if (actor.has_v2v) SetSender(actor.id, object.v2v_id);
      object.x_m = motion.x_m;
      object.y_m = motion.y_m;
      object.yaw_rad = motion.yaw_rad;
      object.speed_mps = motion.speed_mps;
      object.yaw_rate_radps = motion.yaw_rate_radps;
      object.accel_mps2 = motion.accel_mps2;
      object.length_m = actor.length_m;
      object.width_m = actor.width_m;
      object.height_m = actor.height_m;
      object.is_hidden = IsHidden(actor.id, t) ? 1 : 0;
      for (const char* sensor : {"RADAR_FRONT", "CAMERA_FRONT"}) {
        truth_sensor_t look{};
        look.sensor = sensor;
        look.detection_probability = object.is_hidden != 0 ? 0.0 : 0.95;
        look.visible_fraction = object.is_hidden != 0 ? 0.0 : 1.0;
        object.sensors.push_back(look);
      }
      object.num_sensors = static_cast<std::int32_t>(object.sensors.size());
      list.objects.push_back(object);
    }
    list.num_objects = static_cast<std::int32_t>(list.objects.size());
    Put("TRUTH", t, list);
  }

  void Message(const Actor& actor, double t) {
    bsm_t bsm{};
    bsm.rx_utime = Micros(t + 0.028);
    SetSender(actor.id, bsm.id);
    Put("BSM", t + 0.028, bsm);
  }

  void Add(track_list_t& list, const Actor& actor, double t, std::int64_t id, double sigma,
           double east_m) {
    const PlanarMotion ego = EgoAt(t);
    const PlanarMotion motion = ActorAt(actor.id, t);
    track_t track{};
    track.id = id;
    track.x_body_m = motion.x_m - ego.x_m + east_m + random_.Normal(0.0, sigma);
    track.y_body_m = motion.y_m - ego.y_m + random_.Normal(0.0, sigma);
    track.yaw_body_rad = motion.yaw_rad;
    track.speed_mps = motion.speed_mps;
    track.yaw_rate_radps = motion.yaw_rate_radps;
    track.accel_mps2 = motion.accel_mps2;
    const double variance = sigma * sigma + east_m * east_m / 2.0;
    track.covariance_body[0] = track.covariance_body[7] = variance;
    track.length_m = actor.length_m;
    track.width_m = actor.width_m;
    track.object_class = static_cast<std::int8_t>(actor.object_class);
    track.existence = 0.99;
    track.is_confirmed = 1;
    track.bridge_budget_s = track.latitude_rad = track.longitude_rad =
        std::numeric_limits<double>::quiet_NaN();
    if (actor.has_v2v && list.seq != 0) SetSender(actor.id, track.v2v_id);
    list.tracks.push_back(track);
  }

  void List(const std::string& channel, double t, int kind) {
    track_list_t list{};
    list.utime = Micros(t);
    list.seq = kind;
    for (const Actor& actor : kActors) {
      const bool is_hidden = IsHidden(actor.id, t);
      const bool is_confirmed = t >= 0.1;
      if (kind == 0 && !is_hidden && is_confirmed) {
        const std::int64_t back = actor.id == 1 && t >= SyntheticRun::kHiddenTo_s ? 100 : 0;
        Add(list, actor, t, 10 * actor.id + back, run_.noise_sigma_m, 0.0);
      }
      if (kind == 1 && actor.has_v2v && is_confirmed) {
        Add(list, actor, t, 10 * actor.id, 0.1, run_.bias_m);
      }
      if (kind != 2 || !actor.has_v2v || actor.id == 5 || t < 1.6) continue;
      if (is_hidden && run_.paper_like) continue;
      const double drift = actor.id == 1 && is_hidden ? 0.1 * (t - SyntheticRun::kHiddenFrom_s) : 0;
      Add(list, actor, t, 10 * actor.id, run_.noise_sigma_m, drift);
    }
    const bool is_ghost_time = kind == 0 ? t >= 11.0 && t < 11.5 : kind == 2 && run_.paper_like;
    if (is_ghost_time) {
      Add(list, kActors[0], t, 999, 0.1, -20.0);
      list.tracks.back().y_body_m -= 25.0;
    }
    list.num_tracks = static_cast<std::int32_t>(list.tracks.size());
    Put(channel, t + run_.latency_s, list);
  }

  const SyntheticRun& run_;
  LogWriter& log_;
  Random random_;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace

bool SyntheticRun::Write(const std::string& path) const {
  std::string error;
  const auto log = LogWriter::Create(path, error);
  if (log == nullptr) return false;
  Writer writer(*this, *log);
  writer.Scenario();
  const int steps = static_cast<int>(std::lround(kLength_s / 0.05));
  for (int k = 0; k <= steps; ++k) writer.Step(k);
  return log->Close(error);
}

}  // namespace v2vouch::evaluation
