// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "v2vouch/track_list_t.hpp"
#include "v2vouch/truth_list_t.hpp"

namespace v2vouch::foxglove {

/// Which of the three lists.
enum class ListKind { kLocal, kPriority, kSenders };

/// A list as foxglove.SceneUpdate in frame `odom`: LOCAL blue; PRIORITY green, orange with its
/// budget while hidden; senders as arrows by their trust state. Boxes have a 95 % ellipse.
std::string TrackScene(const track_list_t& list, ListKind kind, bool clears);

/// Truth as grey boxes in frame `base_link`.
std::string TruthScene(const truth_list_t& list, bool clears);

}  // namespace v2vouch::foxglove
