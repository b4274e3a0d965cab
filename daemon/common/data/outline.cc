// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/data/outline.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace v2vouch {
namespace {

// Depth of a car's reflections behind its outline grows from 0.2 m within 3 dB of the strongest
// to 0.6 m at 10 dB and 1.5 m below 15 dB.
constexpr double kStrong_db = 10.0;
// A return with another one before it, nearer by so much and no farther aside, is not the outline.
constexpr double kBehind_m = 0.7;
constexpr double kAside_m = 0.5;

}  // namespace

void KeepOutline(std::vector<OutlineReturn>& returns) {
  if (returns.size() < 2) return;
  std::ranges::sort(returns, [](const OutlineReturn& a, const OutlineReturn& b) {
    return std::tuple(-a.strength_db, a.range_m, a.azimuth_rad) <
           std::tuple(-b.strength_db, b.range_m, b.azimuth_rad);
  });
  const double least_db = returns.front().strength_db - kStrong_db;
  std::erase_if(returns, [&](const OutlineReturn& r) { return r.strength_db < least_db; });
  const std::vector<OutlineReturn> strong = returns;
  std::erase_if(returns, [&](const OutlineReturn& r) {
    return std::ranges::any_of(strong, [&](const OutlineReturn& before) {
      return r.range_m - before.range_m > kBehind_m &&
             std::abs(r.azimuth_rad - before.azimuth_rad) * before.range_m < kAside_m;
    });
  });
}

}  // namespace v2vouch
