// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "daemon/rim/view/scene.h"

namespace v2vouch::view {

/// The scene as the page draws it (docs/reference/view-protocol.md): one JSON object with all that
/// is to see, so that a page that missed the frames before it misses nothing. Everything lies in
/// the odometry frame, metres and radians; texts of others are strings and never markup.
std::string PageFrame(const Scene& scene);

/// Daemon's own figures, for the strip charts.
std::string PageStatus(const Scene& scene);

/// Lanes and buildings, in the world frame; a frame's `world` says where that lies.
std::string PageMap(const RoadMap& map);

/// Events from number `from` on, at most 200.
/// @param next set to the number behind the last of them.
std::string PageEvents(const EventList& events, std::int64_t from, std::int64_t& next);

/// A picture: u8 kind (16), u32 length of the JSON, JSON {camera, t, w, h}, JPEG bytes.
/// Empty where the picture is no JPEG.
std::string PagePicture(const Scene& scene, std::size_t camera);

}  // namespace v2vouch::view
