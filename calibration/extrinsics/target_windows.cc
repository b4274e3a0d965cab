// SPDX-License-Identifier: Apache-2.0
#include "calibration/extrinsics/target_windows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "calibration/extrinsics/camera_projection.h"

namespace v2vouch {
namespace {

constexpr std::int64_t kWindow_us = 400'000;
constexpr std::size_t kMinHits = 4;
constexpr double kMinSpan_s = 0.14;
constexpr double kSame_m = 2.0;  // Chains of two radars on one vehicle, plus 3 % of the range.
constexpr double kSame_mps = 4.0;
constexpr double kBorder_px = 2.0;
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

LookPose PoseOf(const EgoTrack::Place& at, const EgoTrack::Place& middle, double dt_s) {
  const double c = std::cos(middle.yaw_rad);
  const double s = std::sin(middle.yaw_rad);
  const double dx = at.x_m - middle.x_m;
  const double dy = at.y_m - middle.y_m;
  return {dt_s, c * dx + s * dy, -s * dx + c * dy, at.yaw_rad - middle.yaw_rad};
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

struct Foot {
  double u, v;
};

std::optional<Foot> FootOf(const CameraBox& box, const CameraDetections& picture) {
  const double right = box.left_px + box.width_px;
  const double bottom = box.top_px + box.height_px;
  if (box.left_px < kBorder_px || right > picture.image_width_px - kBorder_px ||
      bottom > picture.image_height_px - kBorder_px || box.top_px < kBorder_px) {
    return std::nullopt;
  }
  return Foot{0.5 * (box.left_px + right), bottom};
}

// Pixel of a window's target in a picture; nullopt where it is behind the camera.
std::optional<Foot> Predicted(const TargetWindow& window, const LookPose& pose,
                              const CameraConfig& camera, const double* mounting) {
  const double dx = window.state[0] + pose.dt_s * window.state[2] - pose.x_m;
  const double dy = window.state[1] + pose.dt_s * window.state[3] - pose.y_m;
  const double c = std::cos(pose.yaw_rad);
  const double s = std::sin(pose.yaw_rad);
  Foot foot{};
  if (!ProjectGround(camera, mounting, c * dx + s * dy, -s * dx + c * dy, 0.0, foot.u, foot.v)) {
    return std::nullopt;
  }
  return foot;
}

std::vector<Foot> FeetOf(const CameraDetections& picture, const CameraConfig& camera) {
  std::vector<Foot> feet;
  for (const CameraBox& box : picture.boxes) {
    if (box.score < camera.min_score) continue;
    if (const auto foot = FootOf(box, picture)) feet.push_back(*foot);
  }
  return feet;
}

// For each window (by its place in `open`), the box of this picture that is its own.
void MatchBoxes(const CameraDetections& picture, std::size_t index, const EgoTrack& ego,
                const CameraConfig& camera, const double* mounting, double gate_rad,
                std::vector<TargetWindow*>& open) {
  const auto at = ego.At(picture.stamp);
  if (!at) return;
  struct Candidate {
    double nearest = 1e9, second = 1e9;
    std::size_t other = 0;
  };
  const std::vector<Foot> feet = FeetOf(picture, camera);
  std::vector<Candidate> of_window(open.size());
  std::vector<Candidate> of_box(feet.size());
  std::vector<LookPose> poses(open.size());
  const auto note = [](Candidate& candidate, double distance, std::size_t other) {
    if (distance < candidate.nearest) {
      candidate.second = candidate.nearest;
      candidate.nearest = distance;
      candidate.other = other;
    } else {
      candidate.second = std::min(candidate.second, distance);
    }
  };
  for (std::size_t i = 0; i < open.size(); ++i) {
    const TargetWindow& window = *open[i];
    const auto middle = ego.At(window.middle);
    const double dt_s = ToSeconds(picture.stamp - window.middle);
    poses[i] = PoseOf(*at, *middle, dt_s);
    const auto predicted = Predicted(window, poses[i], camera, mounting);
    if (!predicted) continue;
    for (std::size_t k = 0; k < feet.size(); ++k) {
      const double distance = std::hypot((feet[k].u - predicted->u) / camera.fx_px,
                                         (feet[k].v - predicted->v) / camera.fy_px);
      note(of_window[i], distance, k);
      note(of_box[k], distance, i);
    }
  }
  for (std::size_t i = 0; i < open.size(); ++i) {
    const Candidate& mine = of_window[i];
    if (mine.nearest > gate_rad || mine.second < 2.0 * mine.nearest) continue;
    const Candidate& its = of_box[mine.other];
    if (its.other != i || its.second < 2.0 * its.nearest) continue;
    open[i]->camera_looks.push_back(
        {picture.camera, index, poses[i], feet[mine.other].u, feet[mine.other].v});
  }
}

// All windows of the drive, in order of time, with their radar looks.
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

// Calls `look(picture, index, windows around it)` for every picture of the camera that has any.
template <class Look>
void ForEachPicture(const DriveLog& log, int camera, std::vector<TargetWindow>& windows,
                    const Look& look) {
  auto first = windows.begin();
  std::vector<TargetWindow*> open;
  for (std::size_t i = 0; i < log.pictures.size(); ++i) {
    const CameraDetections& picture = log.pictures[i];
    if (picture.camera != camera) continue;
    const std::int64_t number = ToMicros(picture.stamp) / kWindow_us;
    const auto number_of = [](const TargetWindow& w) { return ToMicros(w.middle) / kWindow_us; };
    while (first != windows.end() && number_of(*first) < number) ++first;
    open.clear();
    for (auto it = first; it != windows.end() && number_of(*it) == number; ++it) {
      open.push_back(&*it);
    }
    if (!open.empty()) look(picture, i, open);
  }
}

}  // namespace

void AimCamera(const DriveLog& log, const EgoTrack& ego, const VehicleConfig& vehicle, int camera,
               const std::vector<RadarChain>& chains, MountingParameters& parameters) {
  constexpr double kReach_rad = FromDegrees(5.0);
  constexpr double kBin_rad = FromDegrees(0.25);
  constexpr int kBins = 40;           // Each way: 2 kReach_rad / kBin_rad.
  constexpr double kStandsOut = 1.5;  // Against the best peak that is not its neighbour.
  const CameraConfig& config = vehicle.cameras[static_cast<std::size_t>(camera)];
  std::vector<TargetWindow> windows = MakeWindows(ego, chains);
  std::vector<double> votes(kBins * kBins, 0.0);
  ForEachPicture(
      log, camera, windows, [&](const CameraDetections& picture, std::size_t, auto& open) {
        const auto at = ego.At(picture.stamp);
        if (!at) return;
        const std::vector<Foot> feet = FeetOf(picture, config);
        for (const TargetWindow* window : open) {
          const auto middle = ego.At(window->middle);
          const LookPose pose = PoseOf(*at, *middle, ToSeconds(picture.stamp - window->middle));
          const auto predicted = Predicted(*window, pose, config, parameters.Camera(camera));
          if (!predicted) continue;
          for (const Foot& foot : feet) {
            const int i = static_cast<int>(
                std::floor(((foot.u - predicted->u) / config.fx_px + kReach_rad) / kBin_rad));
            const int k = static_cast<int>(
                std::floor(((foot.v - predicted->v) / config.fy_px + kReach_rad) / kBin_rad));
            if (i >= 0 && i < kBins && k >= 0 && k < kBins)
              votes[static_cast<std::size_t>(i * kBins + k)] += 1.0;
          }
        }
      });
  // Three by three bins together, so that a peak on a bin's edge counts.
  double best = 0.0;
  int best_i = 0;
  int best_k = 0;
  std::vector<double> smooth(votes.size(), 0.0);
  for (int i = 1; i + 1 < kBins; ++i) {
    for (int k = 1; k + 1 < kBins; ++k) {
      double sum = 0.0;
      for (int di = -1; di <= 1; ++di) {
        for (int dk = -1; dk <= 1; ++dk) {
          sum += votes[static_cast<std::size_t>((i + di) * kBins + k + dk)];
        }
      }
      smooth[static_cast<std::size_t>(i * kBins + k)] = sum;
      if (sum > best) {
        best = sum;
        best_i = i;
        best_k = k;
      }
    }
  }
  double second = 0.0;
  for (int i = 1; i + 1 < kBins; ++i) {
    for (int k = 1; k + 1 < kBins; ++k) {
      if (std::abs(i - best_i) <= 4 && std::abs(k - best_k) <= 4) continue;
      second = std::max(second, smooth[static_cast<std::size_t>(i * kBins + k)]);
    }
  }
  if (best < 30.0 || best < kStandsOut * second) return;
  // A camera that points farther left or down has everything farther right or up.
  parameters.Camera(camera)[3] += (best_i + 0.5) * kBin_rad - kReach_rad;
  parameters.Camera(camera)[4] -= (best_k + 0.5) * kBin_rad - kReach_rad;
}

std::vector<TargetWindow> PairTargets(const DriveLog& log, const EgoTrack& ego,
                                      const VehicleConfig& vehicle,
                                      const MountingParameters& parameters,
                                      const std::vector<RadarChain>& chains, double gate_rad) {
  std::vector<TargetWindow> windows = MakeWindows(ego, chains);
  for (int camera = 0; camera < parameters.cameras(); ++camera) {
    ForEachPicture(
        log, camera, windows, [&](const CameraDetections& picture, std::size_t index, auto& open) {
          MatchBoxes(picture, index, ego, vehicle.cameras[static_cast<std::size_t>(camera)],
                     parameters.Camera(camera), gate_rad, open);
        });
  }
  std::erase_if(windows, [](const TargetWindow& window) {
    const int radar = window.radar_looks.empty() ? 0 : window.radar_looks.front().radar;
    return window.camera_looks.empty() &&
           std::ranges::all_of(window.radar_looks,
                               [&](const auto& look) { return look.radar == radar; });
  });
  return windows;
}

}  // namespace v2vouch
