// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/foxglove/scenes.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/rim/foxglove/primitives.h"
#include "daemon/rim/wire/sender_id.h"

namespace v2vouch::foxglove {
namespace {

using wire::SenderName;
using wire::SenderOf;

constexpr char kOdometry[] = "odom";

Colour ColourOfTrust(int trust) {
  switch (trust) {
    case track_t::TRUST_VALIDATED:
      return kGreen;
    case track_t::TRUST_BRIDGED:
      return kOrange;
    case track_t::TRUST_SUSPECT:
    case track_t::TRUST_REVOKED:
      return kRed;
    default:
      return kGrey;
  }
}

void PutBox(JsonText& json, double x, double y, double yaw, double length, double width,
            Colour colour) {
  constexpr double kHeight_m = 1.5;
  json.Key("cubes").Open('[').Open('{');
  PutPose(json, x, y, kHeight_m / 2, yaw);
  PutVector(json, "size", length, width, kHeight_m);
  PutColour(json, colour);
  json.Close('}').Close(']');
}

void PutLabel(JsonText& json, double x, double y, std::string_view text) {
  json.Key("texts").Open('[').Open('{');
  PutPose(json, x, y, 2.5, 0.0);
  json.Bool("billboard", true).Number("font_size", 14.0).Bool("scale_invariant", true);
  PutColour(json, {1.0, 1.0, 1.0, 1.0});
  json.Text("text", text).Close('}').Close(']');
}

// The area that holds the vehicle's centre with 95 %, as a closed line.
void PutEllipse(JsonText& json, const track_t& track, Colour colour) {
  const double xx = track.covariance_odom[0], xy = track.covariance_odom[1],
               yy = track.covariance_odom[7];
  const double mean = 0.5 * (xx + yy), root = std::hypot(0.5 * (xx - yy), xy);
  constexpr double kChi2 = 5.991;  // 95 %, two degrees of freedom.
  const double a = std::sqrt(kChi2 * std::max(mean + root, 0.0));
  const double b = std::sqrt(kChi2 * std::max(mean - root, 0.0));
  const double turn = 0.5 * std::atan2(2 * xy, xx - yy), c = std::cos(turn), s = std::sin(turn);
  json.Key("lines").Open('[').Open('{').Integer("type", 1);  // LINE_LOOP
  PutPose(json, 0, 0, 0, 0);
  json.Number("thickness", 2.0).Bool("scale_invariant", true).Key("points").Open('[');
  constexpr int kPoints = 24;
  for (int i = 0; i < kPoints; ++i) {
    const double angle = 2 * kPi * i / kPoints;
    const double u = a * std::cos(angle), v = b * std::sin(angle);
    json.Open('{').Number("x", track.x_odom_m + c * u - s * v);
    json.Number("y", track.y_odom_m + s * u + c * v).Number("z", 0.1).Close('}');
  }
  json.Close(']');
  PutColour(json, colour);
  PutEmpty(json, {"colors", "indices"});
  json.Close('}').Close(']');
}

bool IsDrawable(const track_t& track) {
  return std::isfinite(track.x_odom_m) && std::isfinite(track.y_odom_m) &&
         std::isfinite(track.yaw_odom_rad);
}

double SizeOr(double size, double fallback) { return size > 0.0 ? size : fallback; }

void PutTrack(JsonText& json, const track_t& track, std::int64_t utime, bool is_priority) {
  const bool is_hidden = is_priority && track.local_id == 0;
  const Colour colour = is_priority ? (is_hidden ? kOrange : kGreen) : kBlue;
  const std::string id = std::to_string(track.id);
  OpenEntity(json, (is_priority ? "priority_" : "local_") + id, utime, kOdometry);
  PutMetadata(json, {{"existence", std::to_string(track.existence)},
                     {"speed_mps", std::to_string(track.speed_mps)},
                     {"bridge_budget_s", std::to_string(track.bridge_budget_s)},
                     {"sender", is_priority ? SenderName(SenderOf(track.v2v_id)) : ""}});
  PutBox(json, track.x_odom_m, track.y_odom_m, track.yaw_odom_rad, SizeOr(track.length_m, 4.0),
         SizeOr(track.width_m, 1.8), colour);
  PutEllipse(json, track, colour);
  std::string label = id.substr(id.size() > 4 ? id.size() - 4 : 0);
  if (is_hidden && std::isfinite(track.bridge_budget_s)) {
    label += " hidden, " + std::to_string(static_cast<int>(track.bridge_budget_s)) + " s left";
  }
  PutLabel(json, track.x_odom_m, track.y_odom_m, label);
  PutEmpty(json, {"arrows", "spheres", "cylinders", "triangles", "models"});
  json.Close('}');
}

void PutSender(JsonText& json, const track_t& track, std::int64_t utime) {
  const Colour colour = ColourOfTrust(track.trust_state);
  const std::string name = SenderName(SenderOf(track.v2v_id));
  OpenEntity(json, "sender_" + name, utime, kOdometry);
  PutMetadata(json, {{"trust_state", std::to_string(track.trust_state)}});
  json.Key("arrows").Open('[').Open('{');
  PutPose(json, track.x_odom_m, track.y_odom_m, 0.5, track.yaw_odom_rad);
  json.Number("shaft_length", 2.5).Number("shaft_diameter", 0.3);
  json.Number("head_length", 1.2).Number("head_diameter", 1.0);
  PutColour(json, colour);
  json.Close('}').Close(']');
  PutLabel(json, track.x_odom_m, track.y_odom_m, name);
  PutEmpty(json, {"cubes", "spheres", "cylinders", "lines", "triangles", "models"});
  json.Close('}');
}

void PutTruth(JsonText& json, const truth_object_t& object, const truth_list_t& list) {
  const double c = std::cos(list.ego_yaw_rad), s = std::sin(list.ego_yaw_rad);
  const double dx = object.x_m - list.ego_x_m, dy = object.y_m - list.ego_y_m;
  const double x = c * dx + s * dy, y = -s * dx + c * dy;
  if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(object.yaw_rad)) return;
  OpenEntity(json, "truth_" + std::to_string(object.id), list.utime, "base_link");
  PutMetadata(json, {{"hidden", object.is_hidden != 0 ? "yes" : "no"}});
  PutBox(json, x, y, object.yaw_rad - list.ego_yaw_rad, SizeOr(object.length_m, 4.0),
         SizeOr(object.width_m, 1.8), {0.5, 0.5, 0.5, 0.3});
  PutEmpty(json, {"arrows", "spheres", "cylinders", "lines", "triangles", "texts", "models"});
  json.Close('}');
}

}  // namespace

std::string TrackScene(const track_list_t& list, ListKind kind, bool clears) {
  JsonText json;
  OpenScene(json, list.utime, clears);
  for (const track_t& track : list.tracks) {
    if (!IsDrawable(track)) continue;
    if (kind == ListKind::kSenders) {
      PutSender(json, track, list.utime);
    } else {
      PutTrack(json, track, list.utime, kind == ListKind::kPriority);
    }
  }
  CloseScene(json);
  return json.Take();
}

std::string TruthScene(const truth_list_t& list, bool clears) {
  JsonText json;
  OpenScene(json, list.utime, clears);
  for (const truth_object_t& object : list.objects) PutTruth(json, object, list);
  CloseScene(json);
  return json.Take();
}

}  // namespace v2vouch::foxglove
