// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "daemon/common/geodesy/ecef.h"

namespace v2vouch {

/// Place in L [m] of a position projected along its own vertical onto the height of L's origin, so
/// that a wrong or unknown height moves it nowhere.
Eigen::Vector2d Flat(const LocalPlane& plane, const Wgs84& position);

/// The inverse: the position at the height of L's origin that lies at `p_L`.
Wgs84 Unflat(const LocalPlane& plane, const Eigen::Vector2d& p_L);

/// Angle by which a direction counted from east at `position` must be turned to count from L's x
/// axis (convergence of the meridians, and the plane's gamma).
double ConvergenceAt(const LocalPlane& plane, const Wgs84& position);

}  // namespace v2vouch
