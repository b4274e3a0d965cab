// SPDX-License-Identifier: Apache-2.0
#include "daemon/warnings/turn_plans.h"

#include <cmath>

namespace v2vouch::warnings {
namespace {

// Euro NCAP's CCFtap turns at 10, 15 and 20 km/h, on these radii; the nearest of the three counts.
double UsualRadius_m(double speed_mps) {
  constexpr double kBetween10And15_mps = 12.5 / 3.6;
  constexpr double kBetween15And20_mps = 17.5 / 3.6;
  return speed_mps < kBetween10And15_mps ? 9.0 : speed_mps < kBetween15And20_mps ? 11.75 : 14.75;
}

}  // namespace

std::vector<EgoPlan> PlanTurns(const EgoPlan& plan, const TurnState& state,
                               const WarningsConfig& config) {
  std::vector<EgoPlan> turns;
  if (state.turns_left) turns.push_back(plan);
  if (!plan.path_B.empty()) {
    const Eigen::Vector2d last = plan.path_B.back() - plan.path_B[plan.path_B.size() - 2];
    if (std::atan2(last.y(), last.x()) > 0.5) turns.push_back(plan);
    return turns;
  }
  if (state.signal != TurnSignal::kLeft || !state.is_slow) return turns;
  EgoPlan turn = plan;
  turn.turn_curvature_per_m = 1.0 / UsualRadius_m(plan.speed_mps);
  turn.turn_after_s = 0.0;
  if (state.stands) {
    turn.starts = true;
    turn.accel_mps2 = config.start_accel_mps2;
    turns.push_back(turn);
    return turns;
  }
  for (const double after_s : {0.0, 0.5, 1.0, 1.5, 2.0}) {
    turn.turn_after_s = after_s;
    turns.push_back(turn);
  }
  return turns;
}

}  // namespace v2vouch::warnings
