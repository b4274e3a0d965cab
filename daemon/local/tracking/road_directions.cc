// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/road_directions.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/models/extent.h"
#include "daemon/common/models/measurement_model.h"

namespace v2vouch {
namespace {

constexpr double kSpacing_m = 4.0;
constexpr double kSameWay_rad = 0.35;  // 20 degrees: a lane that bends goes on.
// A vehicle at the kerb stands a lane's width beside the path of those that drive; beyond half a
// lane more it stands beside another lane.
constexpr double kBeside_m = 5.0;
// Roads are straight for so far.
constexpr double kAlong_m = 40.0;
// What is faster than this drives along its lane; what is shorter than this walks or cycles.
constexpr double kDrives_mps = 3.0;
constexpr double kWalks_m = 2.0;

}  // namespace

void RoadDirections::Learn(const EgoState& ego, const TrackTable& table) {
  if (ego.speed_mps > kDrives_mps) Note(ego.X_OB.origin().vector(), ego.X_OB.yaw_rad());
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto [track, evidence] = table[i];
    if (!track.is_confirmed || !evidence.filter.has_driven()) continue;
    if (evidence.last_hit != table.now()) continue;
    if (ClassExtent(track.object_class).length_m < kWalks_m) continue;
    const Eigen::Vector2d velocity = evidence.filter.velocity_O();
    if (velocity.norm() < kDrives_mps) continue;
    Note(evidence.filter.position_O(), std::atan2(velocity.y(), velocity.x()));
  }
}

void RoadDirections::FaceAlong(TrackTable& table) const {
  if (table.settings().point_targets) return;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto [track, evidence] = table[i];
    TrackFilter& filter = evidence.filter;
    if (!filter.is_vehicle() || filter.has_driven()) continue;
    if (evidence.last_hit != table.now()) continue;
    const double axis_rad = track.state_O.mean[kYaw];
    if (const auto yaw = DirectionAt(filter.position_O(), axis_rad)) filter.FaceTowards(*yaw);
  }
}

void RoadDirections::Note(const Eigen::Vector2d& p_O, double yaw_rad) {
  for (std::size_t k = 0; k < count_; ++k) {
    const Point& point = points_[k];
    if ((point.p_O - p_O).squaredNorm() < kSpacing_m * kSpacing_m &&
        std::abs(AngleDifference(point.yaw_rad, yaw_rad)) < kSameWay_rad) {
      return;
    }
  }
  last_ = count_ == 0 ? 0 : (last_ + 1) % kMost;
  count_ = std::min(count_ + 1, kMost);
  points_[last_] = {p_O, {std::cos(yaw_rad), std::sin(yaw_rad)}, yaw_rad};
}

std::optional<double> RoadDirections::DirectionAt(const Eigen::Vector2d& p_O,
                                                  double axis_rad) const {
  std::optional<double> best;
  double least_m = kBeside_m;
  for (std::size_t k = 0; k < count_; ++k) {
    const Point& point = points_[k];
    const Eigen::Vector2d d = p_O - point.p_O;
    const double beside_m = std::abs(point.forward.x() * d.y() - point.forward.y() * d.x());
    if (beside_m >= least_m || std::abs(point.forward.dot(d)) > kAlong_m) continue;
    if (std::abs(AxisDifference(point.yaw_rad, axis_rad)) > kSameWay_rad) continue;
    least_m = beside_m;
    best = point.yaw_rad;
  }
  return best;
}

}  // namespace v2vouch
