// SPDX-License-Identifier: Apache-2.0
#include "calibration/extrinsics/chain_windows.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace v2vouch {
namespace {

constexpr std::size_t kMinHits = 4;
constexpr double kMinSpan_s = 0.14;
constexpr double kSame_m = 2.0;  // Chains of two radars on one vehicle, plus 3 % of the range.
constexpr double kSame_mps = 4.0;
constexpr double kFarthest_m = 100.0;

// A piece of a chain within one window: a straight line fitted in O.
struct Piece {
  std::size_t chain = 0;
  std::vector<const ChainHit*> hits;
  double x = 0.0, y = 0.0, vx = 0.0, vy = 0.0;  // At the window's middle.
};

bool Fit(Piece& piece, Timestamp middle) {
  double n = 0.0, t = 0.0, tt = 0.0, x = 0.0, y = 0.0, tx = 0.0, ty = 0.0;
  for (const ChainHit* hit : piece.hits) {
    const double dt = ToSeconds(hit->stamp - middle);
    n += 1.0;
    t += dt;
    tt += dt * dt;
    x += hit->x_O;
    y += hit->y_O;
    tx += dt * hit->x_O;
    ty += dt * hit->y_O;
  }
  const double det = n * tt - t * t;
  if (piece.hits.size() < kMinHits ||
      ToSeconds(piece.hits.back()->stamp - piece.hits.front()->stamp) < kMinSpan_s || det <= 0.0) {
    return false;
  }
  piece.x = (tt * x - t * tx) / det;
  piece.y = (tt * y - t * ty) / det;
  piece.vx = (n * tx - t * x) / det;
  piece.vy = (n * ty - t * y) / det;
  return true;
}

// Chains of several radars that are one vehicle.
std::vector<std::vector<Piece>> Grouped(std::vector<Piece> pieces,
                                        const std::vector<RadarChain>& chains, double ego_x,
                                        double ego_y) {
  std::vector<std::vector<Piece>> groups;
  std::ranges::stable_sort(pieces, {}, [&](const Piece& p) { return chains[p.chain].radar; });
  for (Piece& piece : pieces) {
    const double reach = kSame_m + 0.03 * std::hypot(piece.x - ego_x, piece.y - ego_y);
    const auto same = std::ranges::find_if(groups, [&](const std::vector<Piece>& group) {
      const Piece& first = group.front();
      return std::hypot(first.x - piece.x, first.y - piece.y) < reach &&
             std::hypot(first.vx - piece.vx, first.vy - piece.vy) < kSame_mps &&
             std::ranges::none_of(group, [&](const Piece& other) {
               return chains[other.chain].radar == chains[piece.chain].radar;
             });
    });
    if (same == groups.end()) {
      groups.push_back({std::move(piece)});
    } else {
      same->push_back(std::move(piece));
    }
  }
  return groups;
}

TargetWindow WindowOf(const std::vector<Piece>& group, const std::vector<RadarChain>& chains,
                      const EgoTrack& ego, Timestamp middle, const EgoTrack::Place& place) {
  TargetWindow window{.middle = middle, .radar_looks = {}, .camera_looks = {}};
  const Piece& piece = group.front();
  const double c = std::cos(place.yaw_rad);
  const double s = std::sin(place.yaw_rad);
  const double dx = piece.x - place.x_m;
  const double dy = piece.y - place.y_m;
  window.state[0] = c * dx + s * dy;
  window.state[1] = -s * dx + c * dy;
  window.state[2] = c * piece.vx + s * piece.vy;
  window.state[3] = -s * piece.vx + c * piece.vy;
  for (const Piece& part : group) {
    for (const ChainHit* hit : part.hits) {
      const auto at = ego.At(hit->stamp);
      if (!at) continue;
      window.radar_looks.push_back({chains[part.chain].radar, part.chain,
                                    PoseOf(*at, place, ToSeconds(hit->stamp - middle)),
                                    hit->range_m, hit->azimuth_rad});
    }
  }
  return window;
}

}  // namespace

LookPose PoseOf(const EgoTrack::Place& at, const EgoTrack::Place& middle, double dt_s) {
  const double c = std::cos(middle.yaw_rad);
  const double s = std::sin(middle.yaw_rad);
  const double dx = at.x_m - middle.x_m;
  const double dy = at.y_m - middle.y_m;
  return {dt_s, c * dx + s * dy, -s * dx + c * dy, at.yaw_rad - middle.yaw_rad};
}

std::vector<TargetWindow> MakeWindows(const EgoTrack& ego, const std::vector<RadarChain>& chains) {
  std::map<std::int64_t, std::vector<Piece>> by_window;
  for (std::size_t i = 0; i < chains.size(); ++i) {
    for (const ChainHit& hit : chains[i].hits) {
      if (hit.range_m > kFarthest_m) continue;
      std::vector<Piece>& pieces = by_window[ToMicros(hit.stamp) / kWindow_us];
      if (pieces.empty() || pieces.back().chain != i) pieces.push_back({.chain = i, .hits = {}});
      pieces.back().hits.push_back(&hit);
    }
  }
  std::vector<TargetWindow> windows;
  for (auto& [number, pieces] : by_window) {
    const Timestamp middle = FromMicros(number * kWindow_us + kWindow_us / 2);
    const auto place = ego.At(middle);
    std::erase_if(pieces, [&](Piece& piece) { return !Fit(piece, middle); });
    if (!place || pieces.empty()) continue;
    for (const auto& group : Grouped(std::move(pieces), chains, place->x_m, place->y_m)) {
      windows.push_back(WindowOf(group, chains, ego, middle, *place));
    }
  }
  return windows;
}

}  // namespace v2vouch
