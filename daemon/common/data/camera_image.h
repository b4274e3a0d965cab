// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "daemon/common/data/input.h"

namespace v2vouch {

enum class ImageEncoding { kJpeg, kMono8, kBgr8 };

/// One picture as received; raw pictures have rows without padding, and as many bytes as that
/// takes.
struct CameraImage : MessageHeader {
  int camera = 0;  ///< Index into VehicleConfig::cameras.
  int width_px = 0;
  int height_px = 0;
  ImageEncoding encoding = ImageEncoding::kJpeg;
  std::vector<std::uint8_t> bytes;
};

}  // namespace v2vouch
