// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "daemon/common/data/input.h"
#include "daemon/common/geodesy/ecef.h"
#include "daemon/v2v/alignment/alignment_filter.h"

namespace v2vouch {

/// Horizontal covariance, floored; nullopt where the figures cannot be a covariance or say that the
/// fix is worth nothing.
std::optional<Eigen::Matrix2d> UsableCovariance(const GnssFix& fix, double floor_m);

bool HasPosition(const GnssFix& fix);

/// A fix in the axes of `plane`, with what it leaves unsaid of its accuracy filled in.
/// @param covariance_en UsableCovariance().
FixInPlane InPlane(const LocalPlane& plane, const GnssFix& fix,
                   const Eigen::Matrix2d& covariance_en, double yaw_floor_rad);

}  // namespace v2vouch
