// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/glances.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"

namespace v2vouch {

void Glances::Add(const CameraLook& look, const CameraMeasurement& z) {
  if (z.left_is_cut || z.right_is_cut) return;
  last_ = count_ == 0 ? 0 : (last_ + 1) % kMost;
  count_ = std::min(count_ + 1, kMost);
  Glance& glance = glances_[last_];
  glance.from_O = look.origin_O();
  glance.middle_rad = 0.5 * (z.azimuth_left_rad + z.azimuth_right_rad) + look.ego.X_OB.yaw_rad() +
                      look.camera.yaw_rad;
  glance.half_rad = 0.5 * (z.azimuth_left_rad - z.azimuth_right_rad) + z.azimuth_sigma_rad;
  glance.middle = {std::cos(glance.middle_rad), std::sin(glance.middle_rad)};
  glance.beside = glance.half_rad < 1.0 ? 1.001 * std::tan(glance.half_rad) + 1e-6 : 0.0;
  glance.height_m = look.camera.z_m;
  glance.depression_rad = z.depression_rad;
  glance.weight = z.bottom_is_cut ? 0.0 : 1.0 / (z.depression_sigma_rad * z.depression_sigma_rad);
}

std::optional<double> Glances::Misfit(const Eigen::Vector2d& p_O) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < count_; ++k) {
    const Glance& glance = glances_[k];
    const Eigen::Vector2d line = p_O - glance.from_O;
    // Nearly every return of a scan ends here.
    if (glance.beside > 0.0) {
      const double ahead = glance.middle.dot(line);
      const double aside = glance.middle.x() * line.y() - glance.middle.y() * line.x();
      if (std::abs(aside) > glance.beside * ahead) return std::nullopt;
    }
    const double bearing = std::atan2(line.y(), line.x());
    if (std::abs(WrapAngle(bearing - glance.middle_rad)) > glance.half_rad) return std::nullopt;
    const double off = std::atan2(glance.height_m, line.norm()) - glance.depression_rad;
    sum += glance.weight * off * off;
  }
  return sum;
}

double Glances::RangeTo(const Eigen::Vector2d& p_O) const {
  return (p_O - glances_[last_].from_O).norm();
}

}  // namespace v2vouch
