// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <v2vouch/camera_detections_t.hpp>
#include <v2vouch/radar_scan_t.hpp>
#include <vector>

#include "daemon/common/data/vehicle.h"
#include "sim/run_log/truth.h"

namespace v2vouch::ladder {

inline constexpr std::int64_t kNobody = 0;  ///< Label of what comes from no road user.

/// Which road user each detection of a scan comes from: the nearest true box that is not hidden and
/// within 0.3 m and two azimuth sigmas of it, whose rigid body's range rate there is within 1 m/s
/// of the measured one. An independent simulator's own labels: such a box catches 96 % of a
/// vehicle's returns and 1 % of others.
/// @return truth ids, or kNobody; all kNobody where the truth has no ego pose at that time.
std::vector<std::int64_t> LabelScan(const evaluation::Truth& truth, const RadarConfig& radar,
                                    const radar_scan_t& scan);

/// The same for the boxes of a picture: the road user, not hidden, whose silhouette overlaps the
/// box's bearings best, by a fifth of their union at least.
std::vector<std::int64_t> LabelPicture(const evaluation::Truth& truth, const CameraConfig& camera,
                                       const camera_detections_t& picture);

/// A road user in the ego's body frame at one time; velocity over ground, body axes.
struct LocalTruth {
  const evaluation::TruthObject* object = nullptr;
  Eigen::Vector2d centre_B = Eigen::Vector2d::Zero();
  double yaw_B_rad = 0.0;
  Eigen::Vector2d velocity_B = Eigen::Vector2d::Zero();
  double yaw_rate_radps = 0.0;
};
std::vector<LocalTruth> VisibleAt(const evaluation::Truth& truth, Timestamp stamp);

/// Velocity of a point of the ego's body, body axes.
Eigen::Vector2d EgoVelocityAt(const evaluation::Truth& truth, Timestamp stamp,
                              const Eigen::Vector2d& p_B);

}  // namespace v2vouch::ladder
