// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "v2vouch/track_list_t.hpp"

namespace v2vouch::foxglove {

/// A list as arrays of numbers, for plots (Foxglove's Plot panel, PlotJuggler): v2vouch.FlatTracks,
/// one place per track in each array, nearest first; `count` and `nearest_m` of the whole list.
/// Body frame; null = unavailable; `id` is the id's last five digits, as on the page's labels.
std::string FlatTracks(const track_list_t& list);

}  // namespace v2vouch::foxglove
