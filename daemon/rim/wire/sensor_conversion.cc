// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/wire/sensor_conversion.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "daemon/rim/wire/message_parts.h"

namespace v2vouch::wire {
namespace {

// Bounds that no sensor of a road vehicle exceeds: past them a number is a fault, not a
// measurement.
constexpr double kMaxRangeRate_mps = 200.0;
constexpr double kMaxPixel = 1e5;

}  // namespace

Result<RadarScan> FromWire(const radar_scan_t& message, const RadarConfig& radar, int index,
                           Timestamp received, RefusalTally& dropped) {
  FieldJudge judge(dropped);
  JudgeSensor(message.sensor, radar.name, judge);
  JudgeTime(message, received, judge);
  if (judge.refusal()) return *judge.refusal();

  RadarScan scan;
  static_cast<MessageHeader&>(scan) = Header(message, radar.clock_offset_s, received);
  scan.radar = index;
  scan.detections.reserve(message.detections.size());
  for (const radar_detection_t& from : message.detections) {
    const double range_m = from.range_m + radar.range_offset_m;
    FieldJudge each(dropped);
    each.Need(range_m, 0.0, kMaxRange_m, "detections.range_m");
    each.Need(range_m > 0.0, {Reason::kOutOfRange, "detections.range_m"});
    each.Need(from.azimuth_rad, -kTurn_rad, kTurn_rad,
              LooksLikeDegrees(from.azimuth_rad) ? "detections.azimuth_rad looks like degrees"
                                                 : "detections.azimuth_rad");
    each.Need(from.range_rate_mps, -kMaxRangeRate_mps, kMaxRangeRate_mps,
              "detections.range_rate_mps");
    if (each.refusal()) {
      dropped.Add(*each.refusal());
      continue;
    }
    scan.detections.push_back({
        .range_m = range_m,
        .azimuth_rad = WrapAngle(radar.flip_azimuth ? -from.azimuth_rad : from.azimuth_rad),
        .range_rate_mps = radar.flip_range_rate ? -from.range_rate_mps : from.range_rate_mps,
        .rcs_dbsm =
            each.Optional(from.rcs_dbsm, -200.0, 200.0, "detections.rcs_dbsm").value_or(kNaN),
        .snr_db = each.Optional(from.snr_db, -200.0, 300.0, "detections.snr_db").value_or(kNaN),
        .track_id = std::max(from.track_id, -1),
    });
  }
  return scan;
}

Result<CameraDetections> FromWire(const camera_detections_t& message, const CameraConfig& camera,
                                  int index, Timestamp received, RefusalTally& dropped) {
  FieldJudge judge(dropped);
  JudgeSensor(message.sensor, camera.name, judge);
  JudgeTime(message, received, judge);
  // Pixels of another resolution than the intrinsics are for would mean other angles. A driver that
  // does not know its own says 0.
  const auto is_size = [](int said, int configured) { return said == 0 || said == configured; };
  judge.Need(is_size(message.image_width_px, camera.image_width_px),
             {Reason::kOutOfRange, "image_width_px"});
  judge.Need(is_size(message.image_height_px, camera.image_height_px),
             {Reason::kOutOfRange, "image_height_px"});
  if (judge.refusal()) return *judge.refusal();

  CameraDetections detections;
  static_cast<MessageHeader&>(detections) = Header(message, camera.clock_offset_s, received);
  detections.camera = index;
  detections.image_width_px = camera.image_width_px;
  detections.image_height_px = camera.image_height_px;
  detections.boxes.reserve(message.boxes.size());
  for (const camera_box_t& from : message.boxes) {
    FieldJudge each(dropped);
    each.Need(from.left_px, -kMaxPixel, kMaxPixel, "boxes.left_px");
    each.Need(from.top_px, -kMaxPixel, kMaxPixel, "boxes.top_px");
    each.Need(from.width_px, 0.0, kMaxPixel, "boxes.width_px");
    each.Need(from.width_px > 0.0, {Reason::kOutOfRange, "boxes.width_px"});
    each.Need(from.height_px, 0.0, kMaxPixel, "boxes.height_px");
    each.Need(from.height_px > 0.0, {Reason::kOutOfRange, "boxes.height_px"});
    if (each.refusal()) {
      dropped.Add(*each.refusal());
      continue;
    }
    const auto object_class = Class(from.class_name, "boxes.class_name", dropped);
    if (!object_class) continue;
    detections.boxes.push_back({
        .left_px = from.left_px,
        .top_px = from.top_px,
        .width_px = from.width_px,
        .height_px = from.height_px,
        .object_class = *object_class,
        .score = Score(from.score, "boxes.score", "boxes.score looks like percent", each),
    });
  }
  return detections;
}

}  // namespace v2vouch::wire
