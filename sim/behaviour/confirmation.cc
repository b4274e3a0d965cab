// SPDX-License-Identifier: Apache-2.0
#include "sim/behaviour/confirmation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "sim/metrics/placing.h"
#include "sim/metrics/sight.h"

namespace v2vouch::evaluation {
namespace {

constexpr double kStanding_mps = 0.5;
// A track farther off than this from the vehicle's end is another's, though GOSPA pairs them.
constexpr double kBeyond_m = 2.0;
// Who comes into sight at the very end is no case of a late confirmation.
constexpr Duration kLeastTime = std::chrono::seconds(1);

struct Waiting {
  FirstListing figures;
  std::optional<Timestamp> first_look;
};

// A sensor's look at everybody who waits to be listed.
void TakeLook(const SensorLook& look, const RunLog& log, std::vector<Waiting>& waiting) {
  const Truth& truth = log.truth;
  const SensorSpec& sensor = log.specs.sensors[look.sensor];
  for (std::size_t o = 0; o < truth.objects.size(); ++o) {
    const TruthObject& object = truth.objects[o];
    Waiting& vehicle = waiting[o];
    if (!object.is_vehicle() || vehicle.figures.is_listed) continue;
    const TruthSample* sample = object.motion.InForce(look.stamp);
    if (sample == nullptr) continue;
    const double probability = DetectionProbability(*sample, sensor);
    if (probability < kSeeing) continue;  // Asks too much of "confirmed in three".
    if (!vehicle.first_look) {
      vehicle.first_look = look.stamp;
      vehicle.figures.is_standing = std::abs(sample->motion.speed_mps) < kStanding_mps;
    }
    ++vehicle.figures.looks;
    vehicle.figures.expected_hits += probability;
  }
}

}  // namespace

Confirmation::Mean Confirmation::Average(Of which) const {
  Mean mean;
  std::vector<int> looks;
  double looks_sum = 0.0, hits_sum = 0.0, delay_sum_s = 0.0;
  for (const FirstListing& vehicle : vehicles) {
    if (which != Of::kAll && vehicle.is_standing != (which == Of::kStanding)) continue;
    ++mean.vehicles;
    if (!vehicle.is_listed) continue;
    ++mean.listed;
    looks_sum += vehicle.looks;
    hits_sum += vehicle.expected_hits;
    delay_sum_s += vehicle.delay_s;
    looks.push_back(vehicle.looks);
  }
  if (mean.listed == 0) return mean;
  mean.looks = looks_sum / mean.listed;
  mean.expected_hits = hits_sum / mean.listed;
  mean.delay_s = delay_sum_s / mean.listed;
  std::sort(looks.begin(), looks.end());
  mean.looks_median = 0.5 * (looks[(looks.size() - 1) / 2] + looks[looks.size() / 2]);
  return mean;
}

Confirmation JudgeConfirmation(const RunLog& log, const ScoringSettings& settings) {
  const Truth& truth = log.truth;
  std::vector<Waiting> waiting(truth.objects.size());
  // In order of reception, so that a list knows the looks that came before it.
  std::vector<SensorLook> looks = log.looks;
  std::stable_sort(looks.begin(), looks.end(),
                   [](const auto& a, const auto& b) { return a.received < b.received; });
  Gospa gospa({.cutoff_m = settings.cutoff_m, .order = settings.order});
  std::vector<Eigen::Vector2d> truth_points, track_points;
  std::vector<std::size_t> objects;
  std::size_t next = 0;
  for (const ReceivedList& list : log.lists[Index(ListKind::kLocal)]) {
    for (; next < looks.size() && looks[next].received <= list.received; ++next) {
      TakeLook(looks[next], log, waiting);
    }
    if (list.is_stale || list.tracks.empty()) continue;
    const bool is_anyone_waiting = std::any_of(waiting.begin(), waiting.end(), [](const auto& v) {
      return v.first_look && !v.figures.is_listed;
    });
    if (!is_anyone_waiting) continue;
    truth_points.clear();
    track_points.clear();
    objects.clear();
    for (std::size_t o = 0; o < truth.objects.size(); ++o) {
      const auto motion = truth.objects[o].motion.At(list.stamp);
      if (!truth.objects[o].is_vehicle() || !motion) continue;
      objects.push_back(o);
      truth_points.push_back(motion->position());
    }
    const auto placed = PlaceTracks(log, &list, ListKind::kLocal, list.stamp);
    for (const auto& track : placed) track_points.push_back(track.motion_W.position());
    const auto assignment = gospa.FromPoints(truth_points, track_points).assignment;
    for (std::size_t i = 0; i < objects.size(); ++i) {
      Waiting& vehicle = waiting[objects[i]];
      if (assignment[i] < 0 || vehicle.figures.is_listed || !vehicle.first_look) continue;
      const double error =
          (track_points[static_cast<std::size_t>(assignment[i])] - truth_points[i]).norm();
      if (error > 0.5 * truth.objects[objects[i]].length_m + kBeyond_m) continue;
      vehicle.figures.is_listed = true;
      vehicle.figures.delay_s = ToSeconds(list.stamp - *vehicle.first_look);
    }
  }
  Confirmation result;
  for (std::size_t o = 0; o < waiting.size(); ++o) {
    const Waiting& vehicle = waiting[o];
    if (!vehicle.first_look || truth.end() - *vehicle.first_look < kLeastTime) continue;
    result.vehicles.push_back(vehicle.figures);
    result.vehicles.back().object = truth.objects[o].id;
  }
  return result;
}

}  // namespace v2vouch::evaluation
