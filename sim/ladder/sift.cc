// SPDX-License-Identifier: Apache-2.0
#include "sim/ladder/sift.h"

#include <cmath>
#include <map>
#include <memory>

#include "daemon/common/base/random.h"
#include "daemon/rim/io/event_log.h"
#include "daemon/rim/wire/codec.h"
#include "sim/ladder/labels.h"
#include "sim/run_log/run_log.h"

namespace v2vouch::ladder {
namespace {

using Vec2 = Eigen::Vector2d;

constexpr int kLeastDetections = 10;

bool IsCopied(const std::string& channel, Rung rung) {
  if (channel.starts_with("TRACKS_") || channel == "DAEMON_STATUS") return false;
  return rung != Rung::kAssociation || !channel.starts_with("BSM");
}

/// A scan or picture with the label of each detection.
template <class Message, class Config>
struct Labelled {
  const Config* config;
  Message message;
  std::vector<std::int64_t> labels;
};
using LabelledScan = Labelled<radar_scan_t, RadarConfig>;
using LabelledPicture = Labelled<camera_detections_t, CameraConfig>;

struct SiftedEvent {
  LogEvent event;
  std::unique_ptr<LabelledScan> scan;
  std::unique_ptr<LabelledPicture> picture;
};

class Sifter {
 public:
  Sifter(const evaluation::Truth& truth, const VehicleConfig& vehicle, Rung rung)
      : truth_(truth), vehicle_(vehicle), rung_(rung) {}

  void Take(const LogEvent& event) {
    if (!IsCopied(event.channel, rung_)) return;
    SiftedEvent out{event, nullptr, nullptr};
    for (const RadarConfig& radar : vehicle_.radars) {
      if (event.channel != "RADAR_" + radar.name) continue;
      auto scan = wire::Decode<radar_scan_t>(event.bytes);
      if (!scan) return;
      auto labels = LabelScan(truth_, radar, *scan);
      Count(labels);
      out.scan = std::make_unique<LabelledScan>(&radar, std::move(*scan), std::move(labels));
    }
    for (const CameraConfig& camera : vehicle_.cameras) {
      if (event.channel != "CAMERA_" + camera.name) continue;
      auto picture = wire::Decode<camera_detections_t>(event.bytes);
      if (!picture) return;
      auto labels = LabelPicture(truth_, camera, *picture);
      Count(labels);
      out.picture =
          std::make_unique<LabelledPicture>(&camera, std::move(*picture), std::move(labels));
    }
    events_.push_back(std::move(out));
  }

  [[nodiscard]] std::vector<std::int64_t> Seen() const {
    std::vector<std::int64_t> ids;
    for (const auto& [id, count] : counts_) {
      if (count >= kLeastDetections) ids.push_back(id);
    }
    return ids;
  }

  /// @param only the one road user that stays; kNobody = all of them.
  bool Write(const std::string& in, const std::string& path, std::int64_t only,
             std::string& error) const {
    const std::string inputs[] = {in};
    const auto writer = LogWriter::Create(path, error, inputs);
    if (writer == nullptr) return false;
    std::vector<std::uint8_t> bytes;
    for (const SiftedEvent& event : events_) {
      if (event.scan != nullptr) {
        wire::Encode(rung_ == Rung::kExtent ? Points(*event.scan) : Kept(*event.scan, only), bytes);
      } else if (event.picture != nullptr) {
        wire::Encode(rung_ == Rung::kExtent ? Points(*event.picture) : Kept(*event.picture, only),
                     bytes);
      } else {
        bytes = event.event.bytes;
      }
      writer->Write(event.event.received, event.event.channel, bytes);
    }
    return writer->Close(error);
  }

 private:
  void Count(const std::vector<std::int64_t>& labels) {
    for (const std::int64_t label : labels) {
      if (label != kNobody) ++counts_[label];
    }
  }

  static bool IsKept(std::int64_t label, std::int64_t only) {
    return label != kNobody && (only == kNobody || label == only);
  }

  static radar_scan_t Kept(const LabelledScan& scan, std::int64_t only) {
    radar_scan_t out = scan.message;
    out.detections.clear();
    for (std::size_t i = 0; i < scan.labels.size(); ++i) {
      if (IsKept(scan.labels[i], only)) out.detections.push_back(scan.message.detections[i]);
    }
    out.num_detections = static_cast<std::int32_t>(out.detections.size());
    return out;
  }

  static camera_detections_t Kept(const LabelledPicture& picture, std::int64_t only) {
    camera_detections_t out = picture.message;
    out.boxes.clear();
    for (std::size_t i = 0; i < picture.labels.size(); ++i) {
      if (IsKept(picture.labels[i], only)) out.boxes.push_back(picture.message.boxes[i]);
    }
    out.num_boxes = static_cast<std::int32_t>(out.boxes.size());
    return out;
  }

  static Random RandomFor(std::int64_t utime, std::int64_t id) {
    return Random::ForSubject(static_cast<std::uint64_t>(utime), static_cast<std::uint64_t>(id));
  }

  [[nodiscard]] radar_scan_t Points(const LabelledScan& scan) const {
    const RadarConfig& radar = *scan.config;
    const Timestamp stamp = FromMicros(scan.message.utime);
    const Vec2 antenna(radar.x_m, radar.y_m);
    const Vec2 own = EgoVelocityAt(truth_, stamp, antenna);
    radar_scan_t out = scan.message;
    out.detections.clear();
    for (const LocalTruth& local : VisibleAt(truth_, stamp)) {
      const radar_detection_t* strongest = nullptr;
      for (std::size_t i = 0; i < scan.labels.size(); ++i) {
        const radar_detection_t& detection = scan.message.detections[i];
        if (scan.labels[i] != local.object->id) continue;
        if (strongest == nullptr || detection.snr_db > strongest->snr_db) strongest = &detection;
      }
      if (strongest == nullptr) continue;
      Random random = RandomFor(scan.message.utime, local.object->id);
      radar_detection_t point = *strongest;
      const Vec2 way = local.centre_B - antenna;
      const double range = way.norm();
      if (range < 0.5) continue;
      const double azimuth = WrapAngle(std::atan2(way.y(), way.x()) - radar.yaw_rad) +
                             random.Normal(0.0, radar.azimuth_sigma_rad);
      const double rate = (local.velocity_B - own).dot(way) / range +
                          random.Normal(0.0, radar.range_rate_sigma_mps);
      point.range_m = range + random.Normal(0.0, radar.range_sigma_m) - radar.range_offset_m;
      point.azimuth_rad = radar.flip_azimuth ? -azimuth : azimuth;
      point.range_rate_mps = radar.flip_range_rate ? -rate : rate;
      out.detections.push_back(point);
    }
    out.num_detections = static_cast<std::int32_t>(out.detections.size());
    return out;
  }

  // Two pixels wide and high, the bottom at the ground under the centre, as the simulator's ideal
  // points are. The camera's roll is not looked at.
  [[nodiscard]] camera_detections_t Points(const LabelledPicture& picture) const {
    const CameraConfig& camera = *picture.config;
    camera_detections_t out = picture.message;
    out.boxes.clear();
    for (const LocalTruth& local : VisibleAt(truth_, FromMicros(picture.message.utime))) {
      const camera_box_t* seen = nullptr;
      for (std::size_t i = 0; i < picture.labels.size() && seen == nullptr; ++i) {
        if (picture.labels[i] == local.object->id) seen = &picture.message.boxes[i];
      }
      if (seen == nullptr) continue;
      Random random = RandomFor(picture.message.utime, local.object->id);
      const Vec2 way = local.centre_B - Vec2(camera.x_m, camera.y_m);
      const double off = WrapAngle(std::atan2(way.y(), way.x()) - camera.yaw_rad);
      const double ahead = way.norm() * std::cos(off);
      if (ahead < 1.0) continue;
      camera_box_t box = *seen;
      box.width_px = box.height_px = 2.0;
      box.left_px = camera.cx_px - camera.fx_px * std::tan(off) - 1.0 +
                    random.Normal(0.0, camera.edge_sigma_px);
      box.top_px = camera.cy_px +
                   camera.fy_px * std::tan(std::atan2(camera.z_m, ahead) - camera.pitch_rad) - 2.0 +
                   random.Normal(0.0, camera.edge_sigma_px);
      if (box.left_px < 0.0 || box.left_px > camera.image_width_px - 2.0 ||
          box.top_px > camera.image_height_px - 2.0) {
        continue;
      }
      out.boxes.push_back(box);
    }
    out.num_boxes = static_cast<std::int32_t>(out.boxes.size());
    return out;
  }

  const evaluation::Truth& truth_;
  const VehicleConfig& vehicle_;
  Rung rung_;
  std::vector<SiftedEvent> events_;
  std::map<std::int64_t, int> counts_;
};

std::string WithId(const std::string& path, std::int64_t id) {
  const std::size_t dot = path.rfind('.');
  const std::size_t at =
      dot == std::string::npos || path.find('/', dot) != std::string::npos ? path.size() : dot;
  return path.substr(0, at) + "." + std::to_string(id) + path.substr(at);
}

}  // namespace

std::optional<std::int64_t> Sift(const std::string& in, const VehicleConfig& vehicle, Rung rung,
                                 const std::string& out, std::vector<std::string>& written,
                                 std::string& error) {
  evaluation::RunLog log;
  if (!evaluation::ReadRunLog(in, {}, log, error)) return std::nullopt;
  if (log.truth.empty()) {
    error = in + ": holds no TRUTH";
    return std::nullopt;
  }
  const auto reader = LogReader::Open(in, error);
  if (reader == nullptr) return std::nullopt;
  Sifter sifter(log.truth, vehicle, rung);
  LogEvent event;
  while (reader->Next(event)) sifter.Take(event);
  const std::vector<std::int64_t> ids =
      rung == Rung::kAssociation ? sifter.Seen() : std::vector<std::int64_t>{kNobody};
  for (const std::int64_t id : ids) {
    const std::string path = id == kNobody ? out : WithId(out, id);
    if (!sifter.Write(in, path, id, error)) return std::nullopt;
    written.push_back(path);
  }
  return reader->damaged();
}

}  // namespace v2vouch::ladder
