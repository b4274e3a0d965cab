// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/foxglove/flat_tracks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "daemon/rim/foxglove/primitives.h"

namespace v2vouch::foxglove {
namespace {

constexpr std::int64_t kShortId = 100'000;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double DistanceOf(const track_t& track) {
  const double distance = std::hypot(track.x_body_m, track.y_body_m);
  return std::isfinite(distance) ? distance : 1e12;
}

// Seconds since an own sensor last measured it.
double OwnAge(const track_t& track, std::int64_t utime) {
  double age = kNone;
  for (const track_source_t& source : track.sources) {
    if (source.kind == track_source_t::V2V) continue;
    age = std::fmin(age,
                    1e-6 * (static_cast<double>(utime) - static_cast<double>(source.last_utime)));
  }
  return age;
}

}  // namespace

std::string FlatTracks(const track_list_t& list) {
  std::vector<const track_t*> nearest;
  for (const track_t& track : list.tracks) nearest.push_back(&track);
  std::ranges::sort(nearest, [](const track_t* a, const track_t* b) {
    return std::pair(DistanceOf(*a), a->id) < std::pair(DistanceOf(*b), b->id);
  });
  JsonText json;
  json.Open('{');
  PutTime(json, "timestamp", list.utime);
  json.Integer("count", static_cast<std::int64_t>(nearest.size()));
  json.Number("nearest_m", nearest.empty() ? kNone : DistanceOf(*nearest.front()));
  const auto array = [&](std::string_view key, auto value) {
    json.Key(key).Open('[');
    for (const track_t* track : nearest) json.Number(value(*track));
    json.Close(']');
  };
  array("id", [](const track_t& t) { return static_cast<double>(t.id % kShortId); });
  array("x_m", [](const track_t& t) { return t.x_body_m; });
  array("y_m", [](const track_t& t) { return t.y_body_m; });
  array("speed_mps", [](const track_t& t) { return t.speed_mps; });
  array("yaw_rad", [](const track_t& t) { return t.yaw_body_rad; });
  array("existence", [](const track_t& t) { return t.existence; });
  array("sigma_m", [](const track_t& t) {
    return std::sqrt(std::max(0.0, t.covariance_body[0] + t.covariance_body[7]));
  });
  array("own_age_s", [&](const track_t& t) { return OwnAge(t, list.utime); });
  array("budget_s", [](const track_t& t) { return t.bridge_budget_s; });
  array("trust_state", [](const track_t& t) { return static_cast<double>(t.trust_state); });
  json.Close('}');
  return json.Take();
}

}  // namespace v2vouch::foxglove
