// SPDX-License-Identifier: Apache-2.0
#include "sim/scorecard/lead.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "sim/metrics/scoring.h"

namespace v2vouch::evaluation {
namespace {

constexpr double kNearest_m = 4.0, kFarthest_m = 50.0;
constexpr double kHalfLane_m = 1.6;
constexpr double kArcFrom_mps = 2.0;
constexpr double kSight = 0.8, kSightFor_s = 2.0;
constexpr double kAlong_m = 5.0, kAcross_m = 2.0;

const SceneTruth* LeadOf(const Scene& scene) {
  const double curvature = std::abs(scene.ego_W.speed_mps) >= kArcFrom_mps
                               ? scene.ego_W.yaw_rate_radps / scene.ego_W.speed_mps
                               : 0.0;
  const SceneTruth* lead = nullptr;
  for (const SceneTruth& truth : scene.truths) {
    if (!truth.is_vehicle) continue;
    const double x = truth.motion_B.x_m;
    const double off = truth.motion_B.y_m - 0.5 * curvature * x * x;
    if (x < kNearest_m || x > kFarthest_m || std::abs(off) > kHalfLane_m) continue;
    if (lead == nullptr || x < lead->motion_B.x_m) lead = &truth;
  }
  return lead;
}

const ListedTrack* NearestTo(const SceneTruth& lead, const Scene& scene) {
  const ListedTrack* nearest = nullptr;
  double least = 0.0;
  for (const ListedTrack* track : scene.tracks) {
    const Eigen::Vector2d off = track->motion_B.position() - lead.motion_B.position();
    if (std::abs(off.x()) > kAlong_m || std::abs(off.y()) > kAcross_m) continue;
    if (nearest != nullptr && off.norm() >= least) continue;
    nearest = track;
    least = off.norm();
  }
  return nearest;
}

}  // namespace

double LeadFigures::absent_share() const {
  return lists > 0 ? static_cast<double>(absent) / static_cast<double>(lists) : kNoValue;
}

LeadFigures JudgeLead(const std::vector<Scene>& scenes, const ScorecardSettings& settings) {
  LeadFigures figures;
  std::map<std::size_t, double> seen_since;  // Per object, while it is in sight.
  double absent_s = 0.0;
  for (const Scene& scene : scenes) {
    for (const SceneTruth& truth : scene.truths) {
      if (truth.sight() < kSight) {
        seen_since.erase(truth.object);
      } else {
        seen_since.try_emplace(truth.object, scene.t_s);
      }
    }
    if (!scene.is_scored) continue;
    const SceneTruth* lead = LeadOf(scene);
    const auto since = lead == nullptr ? seen_since.end() : seen_since.find(lead->object);
    if (since == seen_since.end() || !lead->is_in_scope ||
        scene.t_s - since->second < kSightFor_s - 1e-9) {
      absent_s = 0.0;
      continue;
    }
    ++figures.lists;
    const ListedTrack* track = NearestTo(*lead, scene);
    if (track == nullptr) {
      ++figures.absent;
      absent_s += settings.period_s;
      figures.longest_absence_s = std::max(figures.longest_absence_s, absent_s);
      continue;
    }
    absent_s = 0.0;
    figures.along_m.Add(track->motion_B.x_m - lead->motion_B.x_m);
  }
  return figures;
}

}  // namespace v2vouch::evaluation
