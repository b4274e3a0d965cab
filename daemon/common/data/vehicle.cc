// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/data/vehicle.h"

#include <algorithm>
#include <cctype>

namespace v2vouch {

std::string SensorKey(std::string name) {
  std::ranges::transform(name, name.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name;
}

std::vector<RadarConfig> VehicleConfig::DefaultRadars() {
  RadarConfig front;
  front.name = "FRONT";
  front.x_m = 3.75;
  front.half_fov_rad = FromDegrees(30.0);
  front.max_range_m = 160.0;
  front.azimuth_sigma_rad = FromDegrees(0.3);

  RadarConfig left;
  left.name = "FRONT_LEFT";
  left.x_m = 3.45;
  left.y_m = 0.75;
  left.yaw_rad = FromDegrees(55.0);
  left.half_fov_rad = FromDegrees(70.0);
  left.max_range_m = 80.0;
  left.azimuth_sigma_rad = FromDegrees(1.0);

  RadarConfig right = left;
  right.name = "FRONT_RIGHT";
  right.y_m = -0.75;
  right.yaw_rad = FromDegrees(-55.0);
  return {front, left, right};
}

}  // namespace v2vouch
