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

std::size_t KeepOutline(std::span<OutlineReturn> returns) {
  if (returns.size() < 2) return returns.size();
  const double least_db =
      std::ranges::max(returns, {}, &OutlineReturn::strength_db).strength_db - kStrong_db;
  std::ranges::sort(returns, {}, [](const OutlineReturn& r) {
    return std::tuple(r.range_m, r.azimuth_rad, -r.strength_db);
  });
  std::size_t kept = 0;
  for (const OutlineReturn& r : returns) {
    const bool is_behind =
        std::ranges::any_of(returns.first(kept), [&](const OutlineReturn& before) {
          return r.range_m - before.range_m > kBehind_m &&
                 std::abs(r.azimuth_rad - before.azimuth_rad) * before.range_m < kAside_m;
        });
    if (r.strength_db >= least_db && !is_behind) returns[kept++] = r;
  }
  std::ranges::sort(returns.first(kept), {}, [](const OutlineReturn& r) {
    return std::tuple(-r.strength_db, r.range_m, r.azimuth_rad);
  });
  return kept;
}

}  // namespace v2vouch
