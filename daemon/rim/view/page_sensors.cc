// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/view/page_sensors.h"

#include <cmath>

namespace v2vouch::view {
namespace {

constexpr std::size_t kMostRadarPoints = 1500;
constexpr std::int64_t kOldest_us = 500'000;  // Own-sensor messages older than this are not drawn.

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

}  // namespace

bool IsRecent(std::int64_t utime, std::int64_t now) {
  return std::abs(static_cast<double>(now) - static_cast<double>(utime)) <=
         static_cast<double>(kOldest_us);
}

void PutSensors(JsonText& json, const Scene& scene, std::int64_t now) {
  PutRadar(json, scene, now);
  PutCameras(json, scene, now);
  PutObjects(json, scene, now);
}

}  // namespace v2vouch::view
