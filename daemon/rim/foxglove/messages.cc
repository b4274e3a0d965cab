// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/foxglove/messages.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/rim/foxglove/primitives.h"

namespace v2vouch::foxglove {

std::string EgoTransform(std::int64_t utime, double x_odom_m, double y_odom_m,
                         double yaw_odom_rad) {
  JsonText json;
  json.Open('{');
  PutTime(json, "timestamp", utime);
  json.Text("parent_frame_id", "odom").Text("child_frame_id", "base_link");
  PutVector(json, "translation", x_odom_m, y_odom_m, 0.0);
  PutRotation(json, "rotation", yaw_odom_rad);
  json.Close('}');
  return json.Take();
}

std::string Location(const gnss_fix_t& fix) {
  JsonText json;
  json.Open('{');
  PutTime(json, "timestamp", fix.utime);
  json.Text("frame_id", "base_link").Number("latitude", ToDegrees(fix.latitude_rad), 9);
  json.Number("longitude", ToDegrees(fix.longitude_rad), 9);
  json.Number("altitude", std::isfinite(fix.altitude_m) ? fix.altitude_m : 0.0);
  json.Key("position_covariance").Open('[');
  bool is_known = true;
  for (const double value : fix.covariance_enu_m2) {
    is_known = is_known && std::isfinite(value);
    json.Number(std::isfinite(value) ? value : 0.0, 4);
  }
  json.Close(']').Integer("position_covariance_type", is_known ? 3 : 0);
  if (std::isfinite(fix.heading_rad)) json.Number("heading", fix.heading_rad, 5);
  json.Close('}');
  return json.Take();
}

Picture PictureOf(const camera_image_t& image) {
  const bool is_jpeg = image.encoding == "jpeg";
  JsonText json;
  json.Open('{');
  PutTime(json, "timestamp", image.utime);
  json.Text("frame_id", "camera_" + image.sensor);
  if (is_jpeg) {
    json.Text("format", "jpeg");
  } else {
    json.Integer("width", image.width_px).Integer("height", image.height_px);
    json.Integer("step", std::int64_t{image.width_px} * (image.encoding == "bgr8" ? 3 : 1));
    json.Text("encoding", image.encoding);
  }
  json.Key("data").Raw('"' + Base64(image.data) + '"').Close('}');
  return {is_jpeg ? "foxglove.CompressedImage" : "foxglove.RawImage", json.Take()};
}

std::string LogLine(std::int64_t utime, int level, std::string_view name, std::string_view text) {
  JsonText json;
  json.Open('{');
  PutTime(json, "timestamp", utime);
  json.Integer("level", level).Text("message", text).Text("name", name);
  json.Text("file", "").Integer("line", 0).Close('}');
  return json.Take();
}

}  // namespace v2vouch::foxglove
