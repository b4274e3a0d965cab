// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "v2vouch/track_list_t.hpp"

namespace v2vouch::view {

inline track_t Track(std::int64_t id, double x_m, double y_m) {
  track_t track{};
  track.id = id;
  track.x_odom_m = track.x_body_m = x_m;
  track.y_odom_m = track.y_body_m = y_m;
  track.length_m = 4.5;
  track.width_m = 1.8;
  track.existence = 0.99;
  track.is_confirmed = 1;
  return track;
}

inline track_list_t List(std::int64_t utime, std::vector<track_t> tracks) {
  track_list_t list{};
  list.utime = utime;
  list.num_tracks = static_cast<std::int32_t>(tracks.size());
  list.tracks = std::move(tracks);
  return list;
}

}  // namespace v2vouch::view
