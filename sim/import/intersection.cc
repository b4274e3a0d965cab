// SPDX-License-Identifier: Apache-2.0
#include "sim/import/intersection.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "sim/world/geometry.h"

namespace v2vouch::sim {
namespace {

using Motions = std::vector<std::vector<CentreSample>>;

constexpr double kMinTurn_rad = FromDegrees(60.0);
constexpr double kMaxTurn_rad = FromDegrees(135.0);
constexpr double kBefore_s = 8.0;  // Recorded, and clear of others, before the middle of a turn ...
constexpr double kAfter_s = 4.0;   // ... and after it.
constexpr double kAround_s = 15.0;
constexpr double kOncomingRange_m = 80.0;
constexpr double kOncomingAngle_rad = FromDegrees(135.0);

constexpr double kArmFrom_m = 25.0;
constexpr double kArmTo_m = 50.0;
constexpr int kBearings = 72;  // Of 5 degrees.
constexpr double kHouse_m = 22.0;
constexpr double kFarthestHouse_m = 60.0;

// The sample nearest in time, or nullptr when the vehicle is not there then.
const CentreSample* At(const std::vector<CentreSample>& motion, double time_s) {
  const auto found =
      std::lower_bound(motion.begin(), motion.end(), time_s,
                       [](const CentreSample& a, double t_s) { return a.time_s < t_s; });
  if (found == motion.end() || found->time_s - time_s > 1.0) return nullptr;
  return &*found;
}

double OncomingSeconds(const Motions& motions, std::size_t ego, double middle_s) {
  // Against the direction in which the ego comes up to the intersection.
  const CentreSample* const before = At(motions[ego], middle_s - 4.0);
  if (before == nullptr) return 0.0;
  constexpr double kStep_s = 0.5;
  double seconds = 0.0;
  for (double t_s = middle_s - kAround_s; t_s <= middle_s + kAround_s; t_s += kStep_s) {
    const CentreSample* const own = At(motions[ego], t_s);
    if (own == nullptr) continue;
    for (std::size_t k = 0; k < motions.size(); ++k) {
      const CentreSample* const other = k == ego ? nullptr : At(motions[k], t_s);
      if (other == nullptr || (other->centre - own->centre).norm() > kOncomingRange_m) continue;
      const double turned_rad = AngleDifference(other->yaw_rad, before->yaw_rad);
      if (std::abs(turned_rad) > kOncomingAngle_rad) seconds += kStep_s;
    }
  }
  return seconds;
}

Box Footprint(const CentreSample& sample, const FcdBody& body) {
  return {sample.centre, sample.yaw_rad, body.length_m, body.width_m};
}

// Whether the turner's footprint meets another's round its turn.
bool Touches(const Motions& motions, const std::vector<FcdBody>& bodies, const LeftTurn& turn) {
  for (const CentreSample& own : motions[turn.vehicle]) {
    if (own.time_s < turn.middle_s - kBefore_s || own.time_s > turn.middle_s + kAfter_s) continue;
    for (std::size_t k = 0; k < motions.size(); ++k) {
      const CentreSample* const other = k == turn.vehicle ? nullptr : At(motions[k], own.time_s);
      if (other == nullptr || (other->centre - own.centre).norm() > 25.0) continue;
      if (Overlap(Footprint(own, bodies[turn.vehicle]), Footprint(*other, bodies[k]))) return true;
    }
  }
  return false;
}

// Bearings from the centre that traffic uses, as the middles of runs of used bins.
std::vector<double> ArmBearings(const Eigen::Vector2d& centre, const Motions& motions) {
  std::array<bool, kBearings> used{};
  for (const auto& motion : motions) {
    for (const CentreSample& sample : motion) {
      const Eigen::Vector2d to = sample.centre - centre;
      if (to.norm() < kArmFrom_m || to.norm() > kArmTo_m) continue;
      const double turn = (std::atan2(to.y(), to.x()) + kPi) / (2.0 * kPi);
      used[static_cast<std::size_t>(turn * kBearings) % kBearings] = true;
    }
  }
  const auto is_used = [&](int bin) {
    return used[static_cast<std::size_t>((bin % kBearings + kBearings) % kBearings)];
  };
  std::vector<double> arms;
  for (int bin = 0; bin < kBearings; ++bin) {
    if (!is_used(bin) || is_used(bin - 1)) continue;  // Starts of runs.
    int end = bin;
    while (is_used(end + 1) && end - bin < kBearings) ++end;
    arms.push_back(2.0 * kPi * (0.5 * (bin + end) + 0.5) / kBearings - kPi);
  }
  return arms;
}

double DistanceTo(const CornerBuilding& house, const Eigen::Vector2d& point) {
  const Eigen::Vector2d to = point - house.centre;
  const Eigen::Vector2d along = Direction(house.yaw_rad);
  const double x = std::abs(to.dot(along)) - 0.5 * house.length_m;
  const double y = std::abs(to.x() * -along.y() + to.y() * along.x()) - 0.5 * house.width_m;
  return std::hypot(std::max(x, 0.0), std::max(y, 0.0)) + std::min(std::max(x, y), 0.0);
}

bool IsClear(const CornerBuilding& house, const Motions& motions, double setback_m) {
  for (const auto& motion : motions) {
    for (const CentreSample& sample : motion) {
      if (DistanceTo(house, sample.centre) < setback_m) return false;
    }
  }
  return true;
}

}  // namespace

std::optional<LeftTurn> FindLeftTurn(const Motions& motions, std::size_t vehicle) {
  const auto& motion = motions[vehicle];
  const double start_rad = motion.front().yaw_rad;
  const double turn_rad = motion.back().yaw_rad - start_rad;
  if (turn_rad < kMinTurn_rad || turn_rad > kMaxTurn_rad) return std::nullopt;
  for (const CentreSample& sample : motion) {
    if (sample.yaw_rad - start_rad < 0.5 * turn_rad) continue;
    return LeftTurn{vehicle, sample.time_s, sample.centre,
                    OncomingSeconds(motions, vehicle, sample.time_s)};
  }
  return std::nullopt;
}

std::optional<LeftTurn> BusiestLeftTurn(const Motions& motions,
                                        const std::vector<FcdBody>& bodies) {
  std::optional<LeftTurn> best;
  bool is_best_clear = false;
  for (std::size_t k = 0; k < motions.size(); ++k) {
    const auto turn = FindLeftTurn(motions, k);
    if (!turn) continue;
    const bool is_recorded = turn->middle_s - motions[k].front().time_s >= kBefore_s &&
                             motions[k].back().time_s - turn->middle_s >= kAfter_s;
    if (!is_recorded) continue;
    const bool is_clear = !Touches(motions, bodies, *turn);
    const bool is_better = !best || (is_clear && !is_best_clear) ||
                           (is_clear == is_best_clear && turn->oncoming_s > best->oncoming_s);
    if (is_better) {
      best = turn;
      is_best_clear = is_clear;
    }
  }
  return best;
}

std::vector<CornerBuilding> CornerBuildings(const Eigen::Vector2d& centre, const Motions& motions,
                                            double setback_m) {
  const std::vector<double> arms = ArmBearings(centre, motions);
  std::vector<CornerBuilding> houses;
  for (std::size_t k = 0; k < arms.size(); ++k) {
    const double next_rad = k + 1 < arms.size() ? arms[k + 1] : arms.front() + 2.0 * kPi;
    const double corner_rad = next_rad - arms[k];
    // Two lanes of one road, or the open side of a T.
    if (corner_rad < FromDegrees(40.0) || corner_rad > FromDegrees(170.0)) continue;
    const double bearing_rad = arms[k] + 0.5 * corner_rad;
    // One side along the road of the arm, the house pushed outwards until it stands clear.
    CornerBuilding house{{}, arms[k], kHouse_m, kHouse_m};
    for (double away_m = 0.5 * kHouse_m; away_m < kFarthestHouse_m; away_m += 1.0) {
      house.centre = centre + away_m * Direction(bearing_rad);
      if (IsClear(house, motions, setback_m)) {
        houses.push_back(house);
        break;
      }
    }
  }
  return houses;
}

}  // namespace v2vouch::sim
