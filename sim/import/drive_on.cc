// SPDX-License-Identifier: Apache-2.0
#include "sim/import/drive_on.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace v2vouch::sim {
namespace {

using Motion = std::vector<CentreSample>;

constexpr double kStep_s = 0.1;
constexpr double kNear_s = 0.06;  // Rows are kStep_s apart or less where two vehicles are compared.
constexpr double kLeast_mps = 5.0;  // Nobody stays on the edge of the net: others come behind.
constexpr double kSpeedUp_mps2 = 1.5;
constexpr double kBrake_mps2 = 6.0;
constexpr double kHalfStrip_m = 2.0;
constexpr double kStandingGap_m = 2.0;
constexpr double kHeadway_s = 1.2;
constexpr double kFarthest_m = 100.0;  // No driver brakes for what is farther ahead.

// The row nearest to `time_s`, where there is one so near.
const CentreSample* At(const Motion& motion, double time_s) {
  const auto found =
      std::lower_bound(motion.begin(), motion.end(), time_s - kNear_s,
                       [](const CentreSample& a, double t_s) { return a.time_s < t_s; });
  return found == motion.end() || found->time_s > time_s + kNear_s ? nullptr : &*found;
}

// Where the vehicle is at `time_s`, or at the nearer end of its record.
const CentreSample& Nearest(const Motion& motion, double time_s) {
  const auto found =
      std::lower_bound(motion.begin(), motion.end(), time_s,
                       [](const CentreSample& a, double t_s) { return a.time_s < t_s; });
  return found == motion.end() ? motion.back() : *found;
}

// Free way before `self`, bumper to bumper.
double Gap(const CentreSample& self, std::size_t own, const std::vector<Motion>& motions,
           const std::vector<FcdBody>& bodies) {
  const Eigen::Vector2d ahead(std::cos(self.yaw_rad), std::sin(self.yaw_rad));
  double gap_m = kFarthest_m;
  for (std::size_t k = 0; k < motions.size(); ++k) {
    const CentreSample* const other = k == own ? nullptr : At(motions[k], self.time_s);
    if (other == nullptr) continue;
    const Eigen::Vector2d d = other->centre - self.centre;
    const double along_m = ahead.dot(d);
    if (along_m <= 0.0 || std::abs(ahead.x() * d.y() - ahead.y() * d.x()) > kHalfStrip_m) continue;
    gap_m = std::min(gap_m, along_m - 0.5 * (bodies[own].length_m + bodies[k].length_m));
  }
  return gap_m;
}

}  // namespace

void DriveOn(std::vector<Motion>& motions, const std::vector<FcdBody>& bodies, std::size_t ego,
             double to_s, double out_of_sight_m) {
  std::vector<std::size_t> leaving(motions.size());
  std::iota(leaving.begin(), leaving.end(), std::size_t{0});
  std::stable_sort(leaving.begin(), leaving.end(), [&](std::size_t a, std::size_t b) {
    return motions[a].back().time_s < motions[b].back().time_s;
  });
  for (const std::size_t k : leaving) {
    if (k == ego) continue;
    const double wanted_mps = std::max(kLeast_mps, motions[k].back().speed_mps);
    while (motions[k].back().time_s + kStep_s <= to_s + kNear_s) {
      CentreSample next = motions[k].back();
      const Eigen::Vector2d& own = Nearest(motions[ego], next.time_s).centre;
      if ((own - next.centre).norm() > out_of_sight_m) break;
      const double safe_mps =
          std::max(0.0, Gap(next, k, motions, bodies) - kStandingGap_m) / kHeadway_s;
      next.speed_mps = std::clamp(std::min(wanted_mps, safe_mps),
                                  std::max(0.0, next.speed_mps - kBrake_mps2 * kStep_s),
                                  next.speed_mps + kSpeedUp_mps2 * kStep_s);
      next.centre += kStep_s * next.speed_mps *
                     Eigen::Vector2d(std::cos(next.yaw_rad), std::sin(next.yaw_rad));
      next.time_s += kStep_s;
      motions[k].push_back(next);
    }
  }
}

}  // namespace v2vouch::sim
