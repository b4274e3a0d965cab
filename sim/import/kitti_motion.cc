// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "sim/import/kitti.h"

namespace v2vouch::sim {
namespace {

constexpr double kFramePeriod_s = 0.1;
constexpr double kAgree_m = 0.25;
constexpr double kReach_m = 60.0;  // Farther labels are too rough.
constexpr std::size_t kLeastObjects = 3;
constexpr int kIterations = 10;
constexpr int kSmoothHalf = 2;

struct Step {
  double way_m = 0.0;
  double turn_rad = 0.0;
};

struct Move {
  Eigen::Vector2d middle;  // Of both places: makes the step's formula right to third order.
  Eigen::Vector2d by;
};

Eigen::Vector2d Residual(const Move& move, const Step& step) {
  return move.by - Eigen::Vector2d(-step.way_m + move.middle.y() * step.turn_rad,
                                   -move.middle.x() * step.turn_rad);
}

// Least squares over the moves for which `counts` holds.
template <class Counts>
std::optional<Step> Solve(const std::vector<Move>& moves, std::size_t least, const Counts& counts) {
  Eigen::Matrix2d N = Eigen::Matrix2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
  std::size_t used = 0;
  for (const Move& move : moves) {
    if (!counts(move)) continue;
    Eigen::Matrix2d A;
    A << -1.0, move.middle.y(), 0.0, -move.middle.x();
    N += A.transpose() * A;
    b += A.transpose() * move.by;
    ++used;
  }
  const Eigen::Vector2d solved = N.ldlt().solve(b);
  if (used < least || !solved.allFinite()) return std::nullopt;
  return Step{solved.x(), solved.y()};
}

std::size_t Agreeing(const std::vector<Move>& moves, const Step& step) {
  return static_cast<std::size_t>(std::count_if(moves.begin(), moves.end(), [&](const Move& move) {
    return Residual(move, step).norm() <= kAgree_m;
  }));
}

// The motion of the two objects with which most others agree.
Step Start(const std::vector<Move>& moves) {
  Step best;
  std::size_t most = 0;
  for (const Move& one : moves) {
    for (const Move& other : moves) {
      if (&one >= &other) continue;
      const auto step =
          Solve(moves, 2, [&](const Move& move) { return &move == &one || &move == &other; });
      const std::size_t count = step ? Agreeing(moves, *step) : 0;
      if (count > most) {
        most = count;
        best = *step;
      }
    }
  }
  return best;
}

std::optional<Step> FitFrom(Step step, const std::vector<Move>& moves) {
  for (int i = 0; i < kIterations; ++i) {
    const auto next = Solve(moves, kLeastObjects, [&](const Move& move) {
      return Residual(move, step).norm() <= kAgree_m;
    });
    if (!next) return std::nullopt;
    step = *next;
  }
  return step;
}

// Positions of one frame's objects by track, in the car's frame.
using Places = std::map<int, Eigen::Vector2d>;

std::vector<Places> PlacesOf(const std::vector<KittiLabel>& labels, const KittiCamera& camera,
                             double camera_x_m) {
  int last = 0;
  for (const KittiLabel& label : labels) last = std::max(last, label.frame);
  std::vector<Places> frames(static_cast<std::size_t>(last) + 1);
  for (const KittiLabel& label : labels) {
    if (label.track < 0 || label.type == "Pedestrian" || label.type == "Cyclist") continue;
    const Eigen::Vector2d p(label.z_m + camera_x_m, -(label.x_m + camera.shift_x_m));
    if (p.norm() < kReach_m) frames[static_cast<std::size_t>(label.frame)][label.track] = p;
  }
  return frames;
}

std::vector<std::optional<Step>> StepsOf(const std::vector<Places>& frames) {
  std::vector<std::optional<Step>> steps(frames.size());
  std::optional<Step> before;
  for (std::size_t k = 0; k + 1 < frames.size(); ++k) {
    std::vector<Move> moves;
    for (const auto& [track, from] : frames[k]) {
      const auto to = frames[k + 1].find(track);
      if (to != frames[k + 1].end())
        moves.push_back({0.5 * (from + to->second), to->second - from});
    }
    if (before) steps[k] = FitFrom(*before, moves);
    if (!steps[k]) steps[k] = FitFrom(Start(moves), moves);
    if (steps[k]) before = steps[k];
  }
  return steps;
}

// Linear between measured frames, constant before the first and behind the last.
std::vector<Step> Filled(const std::vector<std::optional<Step>>& steps) {
  std::vector<Step> filled(steps.size());
  std::optional<std::size_t> before;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    if (!steps[k]) continue;
    const std::size_t gap_begin = before ? *before + 1 : 0;
    for (std::size_t i = gap_begin; i <= k; ++i) {
      const double u =
          before ? static_cast<double>(i - *before) / static_cast<double>(k - *before) : 1.0;
      const Step& from = before ? *steps[*before] : *steps[k];
      filled[i] = {from.way_m + u * (steps[k]->way_m - from.way_m),
                   from.turn_rad + u * (steps[k]->turn_rad - from.turn_rad)};
    }
    before = k;
  }
  for (std::size_t i = before.value_or(steps.size()) + 1; i < steps.size(); ++i) {
    filled[i] = filled[*before];
  }
  return filled;
}

}  // namespace

std::vector<KittiMotion> KittiMotionFromLabels(const std::vector<KittiLabel>& labels,
                                               const KittiCamera& camera, double camera_x_m) {
  const auto steps = StepsOf(PlacesOf(labels, camera, camera_x_m));
  if (std::none_of(steps.begin(), steps.end(), [](const auto& s) { return s.has_value(); })) {
    return {};
  }
  const std::vector<Step> filled = Filled(steps);
  std::vector<KittiMotion> motion(filled.size());
  const auto last = static_cast<std::ptrdiff_t>(filled.size()) - 1;
  for (std::ptrdiff_t k = 0; k <= last; ++k) {
    // A step lies between two frames; those of k - 1 and k stand at equal distance from frame k.
    const std::ptrdiff_t begin = std::max<std::ptrdiff_t>(0, k - kSmoothHalf - 1);
    const std::ptrdiff_t end = std::min(last, k + kSmoothHalf);
    Step sum;
    for (std::ptrdiff_t i = begin; i <= end; ++i) {
      sum.way_m += filled[static_cast<std::size_t>(i)].way_m;
      sum.turn_rad += filled[static_cast<std::size_t>(i)].turn_rad;
    }
    const double time_s = static_cast<double>(end - begin + 1) * kFramePeriod_s;
    motion[static_cast<std::size_t>(k)] = {sum.way_m / time_s, sum.turn_rad / time_s,
                                           steps[static_cast<std::size_t>(k)].has_value()};
  }
  return motion;
}

}  // namespace v2vouch::sim
