// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/geodesy/curvature.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/geodesy/ellipsoid.h"

namespace v2vouch {

CurvatureRadii RadiiAt(double latitude_rad) {
  using wgs84::kA;
  using wgs84::kE2;
  const double sine = std::sin(latitude_rad);
  const double w = 1.0 - kE2 * sine * sine;
  return {kA * (1.0 - kE2) / (w * std::sqrt(w)),
          kA / std::sqrt(w) * std::max(std::cos(latitude_rad), 1e-6)};
}

}  // namespace v2vouch
