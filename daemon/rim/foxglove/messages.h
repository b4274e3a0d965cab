// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "v2vouch/camera_image_t.hpp"
#include "v2vouch/gnss_fix_t.hpp"

namespace v2vouch::foxglove {

/// JSON Schema of the fields that we fill of a schema of Foxglove's, or of FlatTracks();
/// {"type":"object"} for any other name.
std::string_view Schema(std::string_view name);

/// foxglove.FrameTransform: the ego (`base_link`, rear axle) in the odometry frame (`odom`).
std::string EgoTransform(std::int64_t utime, double x_odom_m, double y_odom_m, double yaw_odom_rad);

/// foxglove.LocationFix, degrees.
std::string Location(const gnss_fix_t& fix);

/// foxglove.CompressedImage of a JPEG, foxglove.RawImage of the other encodings.
struct Picture {
  std::string_view schema;
  std::string json;
};
Picture PictureOf(const camera_image_t& image);

/// foxglove.Log; levels: 2 info, 3 warning, 4 error.
std::string LogLine(std::int64_t utime, int level, std::string_view name, std::string_view text);

}  // namespace v2vouch::foxglove
