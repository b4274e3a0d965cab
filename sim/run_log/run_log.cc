// SPDX-License-Identifier: Apache-2.0
#include "sim/run_log/run_log.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <v2vouch/bsm_t.hpp>
#include <v2vouch/bsm_verdict_t.hpp>
#include <v2vouch/camera_detections_t.hpp>
#include <v2vouch/misbehavior_report_t.hpp>
#include <v2vouch/object_list_t.hpp>
#include <v2vouch/radar_scan_t.hpp>
#include <v2vouch/text_t.hpp>
#include <v2vouch/track_list_t.hpp>
#include <v2vouch/truth_bsm_t.hpp>
#include <v2vouch/truth_list_t.hpp>

#include "daemon/common/base/big_endian.h"
#include "daemon/rim/io/event_log.h"
#include "daemon/rim/wire/codec.h"

namespace v2vouch::evaluation {
namespace {

bool AllFinite(std::initializer_list<double> values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

class Reader {
 public:
  Reader(RunLog& log, ReadScope scope) : log_(log), scope_(scope) {}

  void Take(const LogEvent& event) {
    const std::string& channel = event.channel;
    if (scope_ == ReadScope::kSpoof) {
      if (channel == "TRUTH_BSM") return TakeBsmTruth(event);
      if (channel == "BSM_VERDICT") return TakeBsmVerdict(event);
    }
    if (channel == "TRACKS_LOCAL") return TakeList(event, ListKind::kLocal);
    if (channel == "TRACKS_V2V") return TakeList(event, ListKind::kV2v);
    if (channel == "TRACKS_PRIORITY") return TakeList(event, ListKind::kPriority);
    if (channel == "TRUTH") return TakeTruth(event);
    if (channel == "BSM") return TakeBsm(event);
    if (channel == "MISBEHAVIOR") return TakeReport(event);
    if (channel == "SIM_SCENARIO") return TakeText(event, scenario_);
    if (channel == "V2VOUCH_CONFIG") return TakeText(event, config_);
    if (channel.starts_with("RADAR_")) return TakeLook<radar_scan_t>(event);
    if (channel.starts_with("OBJECTS_")) return TakeLook<object_list_t>(event);
    if (!channel.starts_with("CAMERA_") || channel.ends_with("_IMAGE")) return;
    TakeLook<camera_detections_t>(event);
  }

  void Finish() {
    UseMessageClock();
    for (auto& [id, object] : objects_) log_.truth.objects.push_back(std::move(object));
    // A drive that no simulator of ours made has the sensors that the daemon was told of.
    log_.specs = ReadSceneSpecs(scenario_.empty() ? config_ : scenario_);
    for (const auto& [look, channel] : looks_) {
      for (std::size_t s = 0; s < log_.specs.sensors.size(); ++s) {
        if (log_.specs.sensors[s].channel != channel) continue;
        log_.looks.push_back({look.received, look.stamp, s});
      }
    }
  }

 private:
  template <class T>
  std::optional<T> Decoded(const LogEvent& event) {
    Result<T> message = wire::Decode<T>(event.bytes);
    if (!message) {
      ++log_.refused;
      if (message.reason() == Reason::kWrongType) ++log_.other_types[event.channel];
      return std::nullopt;
    }
    return std::move(*message);
  }

  void TakeList(const LogEvent& event, ListKind kind) {
    const auto message = Decoded<track_list_t>(event);
    if (!message) return;
    ReceivedList list{event.received, FromMicros(message->utime), message->stale != 0, {}};
    for (const track_t& track : message->tracks) {
      // Senders are unconfirmed claims; the two other lists hold what counts as a vehicle.
      if (track.is_confirmed == 0 && kind != ListKind::kV2v) continue;
      if (!AllFinite({track.x_body_m, track.y_body_m, track.yaw_body_rad, track.speed_mps,
                      track.yaw_rate_radps, track.accel_mps2})) {
        ++log_.refused;
        continue;
      }
      ListedTrack out;
      out.id = track.id;
      out.local_id = track.local_id;
      out.motion_B = {track.x_body_m,  track.y_body_m,       track.yaw_body_rad,
                      track.speed_mps, track.yaw_rate_radps, track.accel_mps2};
      out.position_covariance_B << track.covariance_body[0], track.covariance_body[1],
          track.covariance_body[6], track.covariance_body[7];
      out.length_m = track.length_m;
      out.width_m = track.width_m;
      out.object_class = track.object_class;
      out.sender = BigEndian32(track.v2v_id);
      out.start = FromMicros(track.start_utime);
      for (const track_source_t& source : track.sources) {
        if (source.kind == track_source_t::V2V) continue;
        out.last_hit = std::max(out.last_hit, FromMicros(source.last_utime));
      }
      out.visibility = track.visibility;
      out.trust = track.trust_state;
      out.bridge_budget_s = track.bridge_budget_s;
      list.tracks.push_back(out);
    }
    log_.lists[Index(kind)].push_back(std::move(list));
  }

  void TakeTruth(const LogEvent& event) {
    const auto message = Decoded<truth_list_t>(event);
    if (!message) return;
    const Timestamp stamp = FromMicros(message->utime);
    NoteTruthTime(stamp);
    recorder_ahead_ = std::min(recorder_ahead_, event.received - stamp);
    TruthSample ego;
    ego.stamp = stamp;
    ego.motion = {message->ego_x_m,
                  message->ego_y_m,
                  message->ego_yaw_rad,
                  message->ego_speed_mps,
                  message->ego_yaw_rate_radps,
                  message->ego_accel_mps2};
    log_.truth.ego.Add(std::move(ego));
    for (const truth_object_t& object : message->objects) {
      TruthObject& out = objects_[object.id];
      out.id = object.id;
      out.object_class = object.object_class;
      out.has_v2v = out.has_v2v || object.has_v2v != 0;
      out.length_m = object.length_m;
      out.width_m = object.width_m;
      out.height_m = object.height_m;
      TruthSample sample;
      sample.stamp = stamp;
      sample.motion = {
          object.x_m,       object.y_m, object.yaw_rad, object.speed_mps, object.yaw_rate_radps,
          object.accel_mps2};
      sample.is_hidden = object.is_hidden != 0;
      sample.sender = BigEndian32(object.v2v_id);
      for (const truth_sensor_t& sensor : object.sensors) {
        sample.looks.push_back(
            {sensor.sensor, sensor.detection_probability, sensor.visible_fraction});
      }
      out.motion.Add(std::move(sample));
    }
  }

  void NoteTruthTime(Timestamp stamp) {
    constexpr double kBack_s = 1.0;  // Less is two events in the wrong order.
    if (newest_truth_ && !log_.truth_step) {
      // In floating point: stamps may be anything.
      const double step_s = 1e-6 * (static_cast<double>(ToMicros(stamp)) -
                                    static_cast<double>(ToMicros(*newest_truth_)));
      if (step_s > ToSeconds(RunLog::kLongestPause) || step_s < -kBack_s) {
        log_.truth_step = {*newest_truth_, stamp};
      }
    }
    newest_truth_ = stamp;
  }

  void TakeBsm(const LogEvent& event) {
    const auto message = Decoded<bsm_t>(event);
    if (message) log_.bsms.push_back({event.received, BigEndian32(message->id)});
  }

  void TakeReport(const LogEvent& event) {
    const auto message = Decoded<misbehavior_report_t>(event);
    if (!message) return;
    log_.reports.push_back({event.received, BigEndian32(message->sender_id), message->check,
                            message->verdict == misbehavior_report_t::ACCUSE});
  }

  void TakeBsmTruth(const LogEvent& event) {
    const auto message = Decoded<truth_bsm_t>(event);
    if (!message) return;
    const truth_bsm_t& m = *message;
    log_.bsm_truths.push_back({FromMicros(m.utime),
                               m.seq,
                               BigEndian32(m.sender_id),
                               m.vehicle_id,
                               m.device_id,
                               m.is_attacker != 0,
                               m.is_attack != 0,
                               m.age_s,
                               {{m.claimed_x_m, m.claimed_y_m},
                                m.claimed_yaw_rad,
                                m.claimed_speed_mps,
                                m.claimed_accel_mps2,
                                m.claimed_length_m,
                                m.claimed_width_m},
                               {{m.honest_x_m, m.honest_y_m},
                                m.honest_yaw_rad,
                                m.honest_speed_mps,
                                m.honest_accel_mps2,
                                m.honest_length_m,
                                m.honest_width_m}});
  }

  void TakeBsmVerdict(const LogEvent& event) {
    const auto message = Decoded<bsm_verdict_t>(event);
    if (!message) return;
    log_.bsm_verdicts.push_back({FromMicros(message->utime), message->seq,
                                 BigEndian32(message->sender_id), message->trust_state,
                                 message->refusal});
  }

  void TakeText(const LogEvent& event, std::string& text) {
    const auto message = Decoded<text_t>(event);
    if (message && text.empty()) text = message->text;
  }

  // A live recording of a simulation has the recorder's wall clock on its events and the scenario's
  // time in its messages. TRUTH is sent at its own time, so its shortest way gives the difference.
  void UseMessageClock() {
    constexpr Duration kSameClock = std::chrono::seconds(1);
    if (log_.truth.empty() || std::chrono::abs(recorder_ahead_) < kSameClock) return;
    for (auto& lists : log_.lists) {
      for (ReceivedList& list : lists) list.received -= recorder_ahead_;
    }
    for (BsmArrival& bsm : log_.bsms) bsm.received -= recorder_ahead_;
    for (VerdictReport& report : log_.reports) report.received -= recorder_ahead_;
    for (auto& [look, channel] : looks_) look.received -= recorder_ahead_;
  }

  template <class T>
  void TakeLook(const LogEvent& event) {
    const auto message = Decoded<T>(event);
    if (!message) return;
    std::string channel = event.channel;
    constexpr std::string_view kDetected = "_DETECTED";
    if (channel.ends_with(kDetected)) channel.resize(channel.size() - kDetected.size());
    looks_.emplace_back(SensorLook{event.received, FromMicros(message->utime), 0},
                        std::move(channel));
  }

  RunLog& log_;
  ReadScope scope_;
  std::map<std::int64_t, TruthObject> objects_;
  std::string scenario_;
  std::string config_;  // Of the daemon.
  std::optional<Timestamp> newest_truth_;
  std::vector<std::pair<SensorLook, std::string>> looks_;
  Duration recorder_ahead_ = Duration::max();  // Of the message clock; shortest seen.
};

}  // namespace

bool ReadRunLog(const std::string& path, const std::function<void(double)>& progress, RunLog& log,
                std::string& error, ReadScope scope) {
  const auto reader = LogReader::Open(path, error);
  if (reader == nullptr) return false;
  log.path = path;
  Reader taker(log, scope);
  LogEvent event;
  std::optional<Timestamp> first;
  while (reader->Next(event)) {
    if (!first) first = event.received;
    log.log_seconds = std::max(log.log_seconds, ToSeconds(event.received - *first));
    taker.Take(event);
    if (progress && log.events % 2000 == 0) progress(reader->progress());
    ++log.events;
  }
  taker.Finish();
  log.damaged = reader->damaged();
  if (progress) progress(1.0);
  return true;
}

}  // namespace v2vouch::evaluation
