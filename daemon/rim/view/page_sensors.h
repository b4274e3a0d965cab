// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "daemon/rim/json/json_text.h"
#include "daemon/rim/view/scene.h"

namespace v2vouch::view {

/// Whether a message of an own sensor is new enough to be drawn at `now`.
bool IsRecent(std::int64_t utime, std::int64_t now);

/// Radar points, cameras with their boxes, and other sources' boxes, as PageFrame() has them.
void PutSensors(JsonText& json, const Scene& scene, std::int64_t now);

}  // namespace v2vouch::view
