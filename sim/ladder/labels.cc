// SPDX-License-Identifier: Apache-2.0
#include "sim/ladder/labels.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "sim/scorecard/silhouette.h"

namespace v2vouch::ladder {
namespace {

using Vec2 = Eigen::Vector2d;

constexpr double kMargin_m = 0.3, kMostMargin_m = 1.5;
constexpr double kRate_mps = 1.0;
constexpr double kLeastOverlap = 0.2;

Vec2 Direction(double yaw_rad) { return {std::cos(yaw_rad), std::sin(yaw_rad)}; }

evaluation::Footprint BoxOf(const LocalTruth& truth) {
  return {truth.centre_B, truth.yaw_B_rad, truth.object->length_m, truth.object->width_m};
}

}  // namespace

std::vector<LocalTruth> VisibleAt(const evaluation::Truth& truth, Timestamp stamp) {
  std::vector<LocalTruth> locals;
  const auto X_WB = truth.EgoPose(stamp);
  if (!X_WB) return locals;
  const auto X_BW = X_WB->Inverse();
  for (const evaluation::TruthObject& object : truth.objects) {
    const auto motion = object.motion.At(stamp);
    if (!motion || object.motion.InForce(stamp)->is_hidden) continue;
    const double yaw = WrapAngle(motion->yaw_rad - X_WB->yaw_rad());
    locals.push_back({&object, (X_BW * Point<World>{motion->x_m, motion->y_m}).vector(), yaw,
                      motion->speed_mps * Direction(yaw), motion->yaw_rate_radps});
  }
  return locals;
}

Vec2 EgoVelocityAt(const evaluation::Truth& truth, Timestamp stamp, const Vec2& p_B) {
  const auto ego = truth.ego.At(stamp);
  if (!ego) return Vec2::Zero();
  return {ego->speed_mps - ego->yaw_rate_radps * p_B.y(), ego->yaw_rate_radps * p_B.x()};
}

std::vector<std::int64_t> LabelScan(const evaluation::Truth& truth, const RadarConfig& radar,
                                    const radar_scan_t& scan) {
  const Timestamp stamp = FromMicros(scan.utime);
  const std::vector<LocalTruth> locals = VisibleAt(truth, stamp);
  const Vec2 antenna(radar.x_m, radar.y_m);
  const Vec2 own = EgoVelocityAt(truth, stamp, antenna);
  std::vector<std::int64_t> labels;
  for (const radar_detection_t& detection : scan.detections) {
    std::int64_t label = kNobody;
    const double range = detection.range_m + radar.range_offset_m;
    const double azimuth = radar.flip_azimuth ? -detection.azimuth_rad : detection.azimuth_rad;
    const double rate =
        radar.flip_range_rate ? -detection.range_rate_mps : detection.range_rate_mps;
    const Vec2 way = Direction(radar.yaw_rad + azimuth);
    const Vec2 place = antenna + range * way;
    double least = std::min(kMostMargin_m, kMargin_m + 2.0 * range * radar.azimuth_sigma_rad);
    for (const LocalTruth& local : locals) {
      const double off = BoxOf(local).DistanceTo(place);
      if (off > least) continue;
      const Vec2 arm = place - local.centre_B;
      const Vec2 velocity = local.velocity_B + local.yaw_rate_radps * Vec2(-arm.y(), arm.x());
      if (std::abs((velocity - own).dot(way) - rate) > kRate_mps) continue;
      least = off;
      label = local.object->id;
    }
    labels.push_back(label);
  }
  return labels;
}

std::vector<std::int64_t> LabelPicture(const evaluation::Truth& truth, const CameraConfig& camera,
                                       const camera_detections_t& picture) {
  const std::vector<LocalTruth> locals = VisibleAt(truth, FromMicros(picture.utime));
  const Vec2 from(camera.x_m, camera.y_m);
  std::vector<std::int64_t> labels;
  for (const camera_box_t& box : picture.boxes) {
    const auto bearing = [&](double x_px) {
      return camera.yaw_rad - std::atan2(x_px - camera.cx_px, camera.fx_px);
    };
    const double left = bearing(box.left_px), right = bearing(box.left_px + box.width_px);
    std::int64_t label = kNobody;
    double best = kLeastOverlap;
    for (const LocalTruth& local : locals) {
      const evaluation::Silhouette shape = evaluation::SilhouetteOf(BoxOf(local), from);
      if (shape.range_m > camera.max_range_m + 20.0) continue;
      const double middle = right + WrapAngle(shape.middle_rad - right);
      const double low = middle - shape.half_width_rad, high = middle + shape.half_width_rad;
      const double shared = std::min(left, high) - std::max(right, low);
      const double all = std::max(left, high) - std::min(right, low);
      if (shared <= best * all) continue;
      best = shared / all;
      label = local.object->id;
    }
    labels.push_back(label);
  }
  return labels;
}

}  // namespace v2vouch::ladder
