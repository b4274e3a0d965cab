// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/foxglove/primitives.h"

#include <algorithm>
#include <cmath>

namespace v2vouch::foxglove {

void PutTime(JsonText& json, std::string_view key, std::int64_t utime) {
  const std::int64_t us = std::max<std::int64_t>(utime, 0);
  json.Key(key).Open('{').Integer("sec", us / 1'000'000).Integer("nsec", us % 1'000'000 * 1000);
  json.Close('}');
}

void PutVector(JsonText& json, std::string_view key, double x, double y, double z) {
  json.Key(key).Open('{').Number("x", x).Number("y", y).Number("z", z).Close('}');
}

void PutRotation(JsonText& json, std::string_view key, double yaw_rad) {
  json.Key(key).Open('{').Integer("x", 0).Integer("y", 0).Number("z", std::sin(yaw_rad / 2), 6);
  json.Number("w", std::cos(yaw_rad / 2), 6).Close('}');
}

void PutPose(JsonText& json, double x, double y, double z, double yaw_rad) {
  json.Key("pose").Open('{');
  PutVector(json, "position", x, y, z);
  PutRotation(json, "orientation", yaw_rad);
  json.Close('}');
}

void PutColour(JsonText& json, Colour colour) {
  json.Key("color").Open('{').Number("r", colour.r).Number("g", colour.g).Number("b", colour.b);
  json.Number("a", colour.a).Close('}');
}

void PutEmpty(JsonText& json, std::initializer_list<std::string_view> keys) {
  for (const std::string_view key : keys) json.Key(key).Open('[').Close(']');
}

void OpenEntity(JsonText& json, std::string_view id, std::int64_t utime, std::string_view frame) {
  json.Open('{');
  PutTime(json, "timestamp", utime);
  json.Text("frame_id", frame).Text("id", id);
  json.Key("lifetime").Open('{').Integer("sec", 0).Integer("nsec", 500'000'000).Close('}');
  json.Bool("frame_locked", false);
}

void PutMetadata(JsonText& json,
                 std::initializer_list<std::pair<std::string_view, std::string>> items) {
  json.Key("metadata").Open('[');
  for (const auto& [key, value] : items) {
    json.Open('{').Text("key", key).Text("value", value).Close('}');
  }
  json.Close(']');
}

void OpenScene(JsonText& json, std::int64_t utime, bool clears) {
  json.Open('{').Key("deletions").Open('[');
  if (clears) {
    json.Open('{');
    PutTime(json, "timestamp", utime);
    json.Integer("type", 1).Text("id", "").Close('}');  // All.
  }
  json.Close(']').Key("entities").Open('[');
}

void CloseScene(JsonText& json) { json.Close(']').Close('}'); }

}  // namespace v2vouch::foxglove
