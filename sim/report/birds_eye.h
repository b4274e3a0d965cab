// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/report/moments.h"

namespace v2vouch::evaluation {

/// What a bird's-eye picture shows of the ground, in the ego's body frame [m].
struct View {
  double ahead_m = 62.0;
  double behind_m = 22.0;
  double aside_m = 34.0;
};

/// One window for all moments: wide enough for the critical vehicle in each of them.
View ChooseView(const Evaluation& evaluation, const std::vector<Moment>& moments,
                std::optional<std::size_t> critical);

/// The scene from above at one moment, ego's heading up: buildings, true boxes, the three lists
/// with 2-sigma ellipses; false claims of `liars` (may be null) within the second before.
std::string BirdsEye(const Evaluation& evaluation, const Moment& moment, const View& view,
                     std::optional<std::size_t> critical, const std::string& id,
                     const RunLog* liars = nullptr);

/// The key to the pictures.
std::string BirdsEyeLegend();

}  // namespace v2vouch::evaluation
