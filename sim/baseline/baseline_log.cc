// SPDX-License-Identifier: Apache-2.0
#include "sim/baseline/baseline_log.h"

#include <v2vouch/text_t.hpp>

#include "daemon/rim/io/event_log.h"
#include "daemon/rim/wire/codec.h"
#include "sim/baseline/baseline_tracker.h"

namespace v2vouch::baseline {
namespace {

constexpr std::int64_t kListPeriod_us = 50'000;

class Runner {
 public:
  Runner(const VehicleConfig& vehicle, LogWriter& writer)
      : vehicle_(vehicle), tracker_(vehicle), writer_(writer) {}

  void Take(const LogEvent& event) {
    if (event.channel == "TRUTH" || event.channel == "SIM_SCENARIO") {
      writer_.Write(event.received, event.channel, event.bytes);
      return;
    }
    if (event.channel == "EGO_MOTION") {
      if (const auto motion = wire::Decode<ego_motion_t>(event.bytes)) tracker_.TakeMotion(*motion);
    } else if (tracker_.has_motion()) {
      TakeSensor(event);
    }
    if (tracker_.utime() >= next_list_) Publish(event.received);
  }

 private:
  void TakeSensor(const LogEvent& event) {
    for (const RadarConfig& radar : vehicle_.radars) {
      if (event.channel != "RADAR_" + radar.name) continue;
      if (const auto scan = wire::Decode<radar_scan_t>(event.bytes))
        tracker_.TakeRadar(radar, *scan);
    }
    for (const CameraConfig& camera : vehicle_.cameras) {
      if (event.channel != "CAMERA_" + camera.name) continue;
      if (const auto picture = wire::Decode<camera_detections_t>(event.bytes)) {
        tracker_.TakeCamera(camera, *picture);
      }
    }
  }

  void Publish(Timestamp received) {
    track_list_t list = tracker_.List();
    list.seq = seq_++;
    wire::Encode(list, bytes_);
    writer_.Write(received, "TRACKS_LOCAL", bytes_);
    next_list_ = tracker_.utime() - tracker_.utime() % kListPeriod_us + kListPeriod_us;
  }

  const VehicleConfig& vehicle_;
  BaselineTracker tracker_;
  LogWriter& writer_;
  std::vector<std::uint8_t> bytes_;
  std::int64_t next_list_ = 0;
  std::int64_t seq_ = 0;
};

}  // namespace

std::optional<std::int64_t> RunBaseline(const std::string& in, const VehicleConfig& vehicle,
                                        const std::string& vehicle_yaml, const std::string& out,
                                        std::string& error) {
  const auto reader = LogReader::Open(in, error);
  if (reader == nullptr) return std::nullopt;
  const std::string inputs[] = {in};
  const auto writer = LogWriter::Create(out, error, inputs);
  if (writer == nullptr) return std::nullopt;
  Runner runner(vehicle, *writer);
  LogEvent event;
  bool is_first = true;
  while (reader->Next(event)) {
    if (is_first) {
      text_t text{};
      text.utime = ToMicros(event.received);
      text.name = "vehicle";
      text.text = vehicle_yaml;
      std::vector<std::uint8_t> bytes;
      wire::Encode(text, bytes);
      writer->Write(event.received, "V2VOUCH_CONFIG", bytes);
    }
    is_first = false;
    runner.Take(event);
  }
  if (!writer->Close(error)) return std::nullopt;
  return reader->damaged();
}

}  // namespace v2vouch::baseline
