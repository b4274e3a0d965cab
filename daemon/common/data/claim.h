// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <optional>

#include "daemon/common/base/time.h"
#include "daemon/common/data/finding.h"
#include "daemon/common/data/input.h"

namespace v2vouch {

/// What one BSM claims, after checks and conversion. A claim, not knowledge: nothing here may
/// create, confirm or move a LOCAL track.
struct Claim {
  Timestamp received{};     ///< Orders claims.
  Timestamp first_heard{};  ///< When this sender was heard for the first time.
  double age_s = 0.0;       ///< Reception minus claimed time of the content, >= 0.
  Eigen::Vector3d p_E = Eigen::Vector3d::Zero();  ///< Centre of the footprint, ECEF [m].
  /// Unit vector of the vehicle's x axis, ECEF.
  Eigen::Vector3d course_E = Eigen::Vector3d::UnitX();
  double height_m = 0.0;   ///< Above the ellipsoid; 0 where unknown.
  double speed_mps = 0.0;  ///< Along course_E; negative in reverse.
  double accel_mps2 = 0.0;
  double yaw_rate_radps = 0.0;    ///< Left positive.
  double position_sigma_m = 2.0;  ///< Per axis, reported accuracy clamped to what we believe.
  std::optional<double> length_m;
  std::optional<double> width_m;
  std::optional<Finding> finding{};  ///< Gravest that the message stream alone has against it.
  SenderId sender = 0;
  CertificateDigest certificate{};
  TrackEvents events = 0;
  bool has_elevation = false;
  bool has_course = true;         ///< False: heading unavailable; course_E says nothing.
  bool accuracy_is_poor = false;  ///< Reported so bad that its position is of no use.
};

/// A claim in the odometry frame, carried forward to a given time.
struct ClaimInOdometry {
  Eigen::Matrix2d noise = Eigen::Matrix2d::Identity();  ///< White part per message [m^2].
  /// Common to all senders: ego pose error here [m^2].
  Eigen::Matrix2d alignment = Eigen::Matrix2d::Zero();
  Eigen::Vector2d p_O = Eigen::Vector2d::Zero();
  Timestamp stamp{};  ///< The time the state is valid for.
  double yaw_rad = 0.0;
  double speed_mps = 0.0;
  double yaw_rate_radps = 0.0;
  double accel_mps2 = 0.0;
  double yaw_sigma_rad = 0.02;
  double speed_sigma_mps = 0.2;
  SenderId sender = 0;
  TrackEvents events = 0;
  bool has_course = true;

  /// Over ground [m/s].
  [[nodiscard]] Eigen::Vector2d velocity_O() const {
    return speed_mps * Eigen::Vector2d(std::cos(yaw_rad), std::sin(yaw_rad));
  }
  /// The place that it has the sender at by `now`, which may be a little before or after `stamp`.
  [[nodiscard]] Eigen::Vector2d PlaceAt(Timestamp now) const {
    return p_O + ToSeconds(now - stamp) * velocity_O();
  }
};

}  // namespace v2vouch
