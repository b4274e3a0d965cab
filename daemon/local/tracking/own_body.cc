// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/own_body.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"

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

bool IsAtOwnBody(const VehicleConfig& vehicle, const RadarLook& look, const Eigen::Vector2d& p_O) {
  if ((p_O - look.origin_O()).norm() < kBeforeAntenna_m) return true;
  const Point<Body> p_B = look.ego.X_OB.Inverse() * Point<Odometry>{p_O.x(), p_O.y()};
  const double along_m = std::abs(p_B.x_m - vehicle.centre_x_m) - 0.5 * vehicle.length_m;
  const double aside_m = std::abs(p_B.y_m) - 0.5 * vehicle.width_m;
  return aside_m < kPathMargin_m && along_m < kInPath_m;
}

bool IsNamed(const LocalTrack& track) { return track.camera_hits() + track.object_hits() > 0; }

// Whether a listed vehicle that the picture shows stands behind, in this direction.
bool ShowsVehicleBehind(const CameraLook& look, std::span<const CameraMeasurement> measurements,
                        const Association& association, const TrackTable& table,
                        const TrackTable::ConstRow& before) {
  const double axis = look.ego.X_OB.yaw_rad() + look.camera.yaw_rad;
  const Eigen::Vector2d line = before.evidence.filter.position_O() - look.origin_O();
  const double range_m = std::max(line.norm(), 0.1);
  const double bearing = WrapAngle(std::atan2(line.y(), line.x()) - axis);
  const double reach_rad = kInnerShare * std::atan2(0.5 * before.track.extent.width_m, range_m);
  for (std::size_t k = 0; k < table.size(); ++k) {
    const auto [track, evidence] = table[k];
    const auto given = association.GivenTo(k);
    if (!given || !track.is_confirmed || track.camera_hits() < kSurePictures) continue;
    const CameraMeasurement& z = measurements[*given];
    if (z.left_is_cut || z.right_is_cut || z.bottom_is_cut) continue;
    const double middle = 0.5 * (z.azimuth_left_rad + z.azimuth_right_rad);
    if (std::abs(WrapAngle(middle - bearing)) > reach_rad) continue;
    const double behind_m = (evidence.filter.position_O() - look.origin_O()).norm() - range_m;
    if (behind_m > kBehind_m + 0.5 * track.extent.length_m) return true;
  }
  return false;
}

}  // namespace

void NoteOwnBody(const VehicleConfig& vehicle, const RadarLook& look, const Eigen::Vector2d& p_O,
                 TrackEvidence& evidence) {
  if (evidence.is_apart) return;
  evidence.apart_hits += IsAtOwnBody(vehicle, look, p_O) ? -1 : 1;
  evidence.is_apart = evidence.apart_hits > 0;
}

bool MayBeOwnBody(const LocalTrack& track, const TrackEvidence& evidence) {
  return !evidence.is_apart && !IsNamed(track);
}

bool IsTransparent(const LocalTrack& track, const TrackEvidence& evidence) {
  return evidence.seen_through >= kSeenThrough && !IsNamed(track);
}

void CountSeenThrough(const CameraLook& look, std::span<const CameraMeasurement> measurements,
                      const Association& association, TrackTable& table) {
  const TrackTable& others = table;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto [track, evidence] = table[i];
    if (track.camera_hits() > 0 || track.radar_hits() == 0) continue;
    int& count = evidence.seen_through;
    count = ShowsVehicleBehind(look, measurements, association, others, others[i])
                ? std::min(count + 1, kSeenThrough + 1)
                : std::max(count - 1, 0);
  }
}

}  // namespace v2vouch
