// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/local/tracking/tracker.h"

namespace v2vouch {
namespace {

// Water on a radome, a tow bar, a bicycle rack: nearer to an antenna than this, or in the car's own
// path and nearer than that to its body. No vehicle drives there, and a vehicle that
// stands there came from elsewhere or is in a picture.
constexpr double kBeforeAntenna_m = 2.0;
constexpr double kInPath_m = 2.5;
constexpr double kPathMargin_m = 0.3;
// A camera that sees a vehicle through another one, so many pictures on end, sees no other one.
constexpr int kSeenThrough = 3;
// The vehicle behind stands at least so much farther, ...
constexpr double kBehind_m = 5.0;
// ... and the middle of its box lies within this share of the other's near face.
constexpr double kInnerShare = 0.5;
constexpr int kSurePictures = 3;

}  // namespace

bool Tracker::IsAtOwnBody(const RadarLook& look, const Eigen::Vector2d& p_O) const {
  if ((p_O - look.origin_O()).norm() < kBeforeAntenna_m) return true;
  const Point<Body> p_B = look.ego.X_OB.Inverse() * Point<Odometry>{p_O.x(), p_O.y()};
  const double along_m = std::abs(p_B.x_m - vehicle_->centre_x_m) - 0.5 * vehicle_->length_m;
  const double aside_m = std::abs(p_B.y_m) - 0.5 * vehicle_->width_m;
  return aside_m < kPathMargin_m && along_m < kInPath_m;
}

// A reflection that the track was given. What has been elsewhere once is no part of the car.
void Tracker::NotePlace(std::size_t track, const RadarLook& look, const Eigen::Vector2d& p_O) {
  Hidden& hidden = hidden_[track];
  if (hidden.is_apart) return;
  hidden.apart_hits += IsAtOwnBody(look, p_O) ? -1 : 1;
  hidden.is_apart = hidden.apart_hits > 0;
}

bool Tracker::MayBeOwnBody(std::size_t track) const {
  return !hidden_[track].is_apart && tracks_[track].camera_hits() == 0 &&
         tracks_[track].object_hits() == 0;
}

bool Tracker::IsTransparent(std::size_t track) const {
  return hidden_[track].seen_through >= kSeenThrough && tracks_[track].camera_hits() == 0 &&
         tracks_[track].object_hits() == 0;
}

// What only radar has seen, and what a camera sees behind it.
void Tracker::LookThrough(const CameraLook& look, std::span<const CameraMeasurement> measurements) {
  const double axis = look.ego.X_OB.yaw_rad() + look.camera.yaw_rad;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (tracks_[i].camera_hits() > 0 || tracks_[i].radar_hits() == 0) continue;
    const Eigen::Vector2d line = hidden_[i].filter.position_O() - look.origin_O();
    const double range_m = std::max(line.norm(), 0.1);
    const double bearing = WrapAngle(std::atan2(line.y(), line.x()) - axis);
    const double reach_rad = kInnerShare * std::atan2(0.5 * tracks_[i].extent.width_m, range_m);
    bool is_seen_through = false;
    for (std::size_t k = 0; k < tracks_.size() && !is_seen_through; ++k) {
      if (assigned_[k] < 0 || !tracks_[k].is_confirmed) continue;
      if (tracks_[k].camera_hits() < kSurePictures) continue;
      const CameraMeasurement& z = measurements[static_cast<std::size_t>(assigned_[k])];
      if (z.left_is_cut || z.right_is_cut || z.bottom_is_cut) continue;
      const double middle = 0.5 * (z.azimuth_left_rad + z.azimuth_right_rad);
      if (std::abs(WrapAngle(middle - bearing)) > reach_rad) continue;
      const double behind_m = (hidden_[k].filter.position_O() - look.origin_O()).norm() - range_m;
      is_seen_through = behind_m > kBehind_m + 0.5 * tracks_[k].extent.length_m;
    }
    int& count = hidden_[i].seen_through;
    count = is_seen_through ? std::min(count + 1, kSeenThrough + 1) : std::max(count - 1, 0);
  }
}

}  // namespace v2vouch
