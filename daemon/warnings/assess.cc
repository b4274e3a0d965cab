// SPDX-License-Identifier: Apache-2.0
#include "daemon/warnings/assess.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "daemon/common/base/angle.h"

namespace v2vouch::warnings {
namespace {

constexpr double kStands_mps = 0.5;
constexpr double kTargetStands_mps = 1.0;
constexpr double kTurning_radps = 0.1;  // With a car's steering: about to turn off.
constexpr double kFastestTurn_mps = 30.0 / 3.6;
constexpr double kSameDirection_rad = 0.786;  // 45 degrees
constexpr double kOncoming_rad = 2.356;       // 135 degrees
constexpr double kLeftTurnOncoming_rad = 1.745;
constexpr double kAdjacent_m = 5.4;
constexpr double kEye_m = 1.5;  // Driver's eye ahead of the rear axle, about.

double Phi(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }

// One behind the other: whether the follower, braking with `decel_mps2` after `after_s`, never
// closes the gap to a lead that goes on braking to a stop as it does now.
bool StopsBehind(double gap_m, double speed_mps, double lead_mps, double lead_decel_mps2,
                 double after_s, double decel_mps2) {
  for (double t_s = 0.0; speed_mps > 0.0 && gap_m > 0.0; t_s += kStep_s) {
    gap_m += kStep_s * (lead_mps - speed_mps);
    lead_mps = std::max(0.0, lead_mps - kStep_s * lead_decel_mps2);
    if (t_s >= after_s) speed_mps -= kStep_s * decel_mps2;
  }
  return gap_m > 0.0;
}

class Assessor {
 public:
  Assessor(const Scene& scene, const EgoBody& body, const WarningsConfig& config)
      : scene_(scene), body_(body), config_(config) {
    const EgoReading& ego = scene.ego;
    plan_.speed_mps = ego.speed_mps;
    plan_.accel_mps2 = std::abs(ego.accel_mps2) < 0.3 ? 0.0 : ego.accel_mps2;
    plan_.curvature_per_m =
        ego.speed_mps < kStands_mps
            ? 0.0
            : std::clamp(ego.yaw_rate_radps / std::max(1.0, ego.speed_mps), -0.2, 0.2);
    if (scene.intent) plan_.path_B = scene.intent->path_B;
    sigmas_ = {ego.speed_sigma_mps, ego.yaw_rate_sigma_radps};
    stands_ = ego.speed_mps < kStands_mps;
    is_slow_ = ego.speed_mps <= kFastestTurn_mps;
    turns_left_ = is_slow_ && !stands_ && ego.yaw_rate_radps > kTurning_radps;
    signal_ = scene.intent ? scene.intent->turn_signal : TurnSignal::kUnknown;
    MakeTurns();
    fan_.emplace(plan_, sigmas_, body_, config_);
  }

  std::vector<Assessment> Run() {
    for (const Target& target : scene_.targets) {
      target_ = &target;
      body_target_ = InBody(target);
      if (IsInEgo()) continue;
      placement_ = Classify(plan_, body_, body_target_, config_);
      One();
    }
    return std::move(found_);
  }

 private:
  [[nodiscard]] BodyTarget InBody(const Target& target) const {
    BodyTarget out;
    const double c = std::cos(scene_.ego_yaw_O);
    const double s = std::sin(scene_.ego_yaw_O);
    StateMatrix turn = StateMatrix::Identity();
    turn(kX, kX) = c;
    turn(kX, kY) = s;
    turn(kY, kX) = -s;
    turn(kY, kY) = c;
    StateVector mean = target.state_O.mean;
    mean.head<2>() -= scene_.ego_p_O;
    out.mean = turn * mean;
    out.mean[kYaw] = WrapAngle(mean[kYaw] - scene_.ego_yaw_O);
    out.covariance = turn * target.state_O.covariance * turn.transpose();
    out.size = {0.5 * target.extent.length_m, 0.5 * target.extent.width_m};
    return out;
  }

  // A box well inside the ego's own: contact already, or a track of nothing; no warning helps.
  [[nodiscard]] bool IsInEgo() const {
    constexpr double kDeep_m = 0.3;
    const HalfSize own{0.5 * body_.length_m - kDeep_m, 0.5 * body_.width_m - kDeep_m};
    const StateVector& x = body_target_.mean;
    return Touch({{body_.centre_x_m, 0.0}, {1.0, 0.0}}, own,
                 {x.head<2>(), {std::cos(x[kYaw]), std::sin(x[kYaw])}}, body_target_.size);
  }

  // Left turns that the driver may be about to take: the one begun, and after the signal the usual
  // one of this speed (radii of Euro NCAP's CCFtap), now or soon.
  void MakeTurns() {
    if (turns_left_) AddTurn(plan_);
    if (!plan_.path_B.empty()) {
      const Eigen::Vector2d last = plan_.path_B.back() - plan_.path_B[plan_.path_B.size() - 2];
      if (std::atan2(last.y(), last.x()) > 0.5) AddTurn(plan_);
      return;
    }
    if (signal_ != TurnSignal::kLeft || !is_slow_) return;
    const double speed = scene_.ego.speed_mps;
    EgoPlan turn = plan_;
    turn.turn_curvature_per_m = 1.0 / (speed < 3.47 ? 9.0 : speed < 4.86 ? 11.75 : 14.75);
    turn.turn_after_s = 0.0;
    if (stands_) {
      turn.starts = true;
      turn.accel_mps2 = config_.start_accel_mps2;
      AddTurn(turn);
      return;
    }
    for (const double after_s : {0.0, 0.5, 1.0, 1.5, 2.0}) {
      turn.turn_after_s = after_s;
      AddTurn(turn);
    }
  }

  void AddTurn(const EgoPlan& plan) { turns_.emplace_back(plan, sigmas_, body_, config_); }

  void One() {
    const Zone zone = placement_.zone;
    const double heading = std::abs(body_target_.mean[kYaw]);
    const bool moves = std::abs(body_target_.mean[kSpeed]) >= kTargetStands_mps;
    if (zone == Zone::kAhead || zone == Zone::kAheadAside) {
      Ahead();
      Braking();
    }
    if (zone == Zone::kBehind) Beside();
    const bool comes = moves && heading >= kLeftTurnOncoming_rad;
    if (comes && !turns_.empty()) {
      LeftTurn();
    } else if (zone == Zone::kOncoming) {
      HeadOn();
    } else if (zone == Zone::kFromLeft || zone == Zone::kFromRight) {
      Crossing();
    }
  }

  void Ahead() {
    const Conflict conflict = AssessConflict(*fan_, body_target_, config_);
    const double closing = std::max(
        0.0, plan_.speed_mps - body_target_.mean[kSpeed] * std::cos(placement_.turned_rad));
    // A lead that brakes has to be met by more than the closing speed alone.
    const double lead_brakes = std::max(0.0, -body_target_.mean[kAccel]);
    const double gap_m = std::max(0.1, placement_.place.along_m - body_.centre_x_m -
                                           0.5 * body_.length_m - body_target_.size.length_m);
    Figures figures = FiguresOf(conflict);
    figures.required_decel_mps2 = closing * closing / (2.0 * gap_m) + lead_brakes;
    const double needed_s = config_.driver_reaction_s + closing / (2.0 * config_.driver_decel_mps2);
    const double usual_s = closing / (2.0 * config_.usual_decel_mps2);
    figures.warn_before_s = std::max(needed_s, std::min(needed_s + config_.warn_margin_s, usual_s));
    figures.urgent_before_s = config_.planner_reaction_s +
                              closing / (2.0 * config_.planner_decel_mps2) +
                              config_.urgent_margin_s;
    // While the lead brakes hard the closing speed now says too little: it grows until the contact.
    if (lead_brakes > config_.usual_decel_mps2) {
      const double lead_mps = std::max(0.0, body_target_.mean[kSpeed]);
      const auto is_too_late = [&](double after_s, double decel_mps2) {
        return !StopsBehind(gap_m, plan_.speed_mps, lead_mps, lead_brakes, after_s, decel_mps2);
      };
      const double contact_s =
          std::isfinite(conflict.exact_median_s) ? conflict.exact_median_s : conflict.median_s;
      if (is_too_late(config_.driver_reaction_s, config_.driver_decel_mps2)) {
        figures.warn_before_s = std::max(figures.warn_before_s, contact_s);
      }
      if (is_too_late(config_.planner_reaction_s + config_.urgent_margin_s,
                      config_.planner_decel_mps2)) {
        figures.urgent_before_s = std::max(figures.urgent_before_s, contact_s);
      }
    }
    Judge(Kind::kFcw, Side::kAhead, conflict, figures);
  }

  void HeadOn() {
    Conflict conflict = AssessConflict(*fan_, body_target_, config_);
    // On a bend every oncoming vehicle is ahead for a while: only what is nearly sure counts.
    if (conflict.probability < config_.urgent_probability) return;
    Judge(Kind::kFcw, Side::kOncoming, conflict, CrossingFigures(conflict));
  }

  void Crossing() {
    const bool wants_to_go = scene_.intent && !scene_.intent->is_braking &&
                             (signal_ == TurnSignal::kLeft || signal_ == TurnSignal::kRight ||
                              scene_.intent->accel_request_mps2 > 0.3);
    if (stands_) {
      if (!wants_to_go) return;
      if (!starting_) {
        EgoPlan plan = plan_;
        plan.starts = true;
        plan.accel_mps2 = config_.start_accel_mps2;
        starting_.emplace(plan, sigmas_, body_, config_);
      }
    }
    const Conflict conflict = AssessConflict(stands_ ? *starting_ : *fan_, body_target_, config_);
    const Side side = placement_.zone == Zone::kFromLeft ? Side::kLeft : Side::kRight;
    Judge(Kind::kIma, side, conflict, CrossingFigures(conflict),
          stands_ ? Level::kAdvise : Level::kUrgent);
  }

  void LeftTurn() {
    Motion other;
    PredictTarget(body_target_.mean, false, fan_->steps(), other);
    const EgoFan* nearest = nullptr;
    Conflict gap;
    for (const EgoFan& turn : turns_) {
      Conflict each;
      AssessGap(turn.mean(), turn.wide(), other, body_target_.size, each);
      if (std::isnan(each.post_encroachment_s)) continue;
      if (nearest != nullptr && each.post_encroachment_s >= gap.post_encroachment_s) continue;
      nearest = &turn;
      gap = each;
    }
    const EgoFan& fan = nearest != nullptr ? *nearest : turns_.front();
    Conflict conflict = AssessConflict(fan, body_target_, config_);
    // URGENT wants the turn itself, not the one that may come.
    const bool is_begun = turns_left_ && &fan == &turns_.front();
    if (nearest != nullptr && std::isnan(conflict.post_encroachment_s)) {
      conflict.post_encroachment_s = gap.post_encroachment_s;
      conflict.ego_enters_s = gap.ego_enters_s;
      conflict.place_B = gap.place_B;
    }
    Figures figures = CrossingFigures(conflict);
    Level by_gap = Level::kInfo;
    if (gap.post_encroachment_s <= config_.gap_advise_s) by_gap = Level::kAdvise;
    if (!stands_ && gap.post_encroachment_s <= config_.gap_warn_s &&
        gap.ego_enters_s <= figures.warn_before_s) {
      by_gap = Level::kWarn;
    }
    const Level at_most = stands_ ? Level::kAdvise : is_begun ? Level::kUrgent : Level::kWarn;
    Judge(Kind::kLta, Side::kOncoming, conflict, figures, at_most, by_gap);
  }

  void Braking() {
    const Figures base = FiguresOf({});
    if (placement_.place.along_m > config_.braking_range_m) return;
    if (std::abs(placement_.place.left_m) > kAdjacent_m) return;
    if (std::abs(body_target_.mean[kSpeed]) < kTargetStands_mps) return;
    const double sigma = std::sqrt(std::max(1e-6, body_target_.covariance(kAccel, kAccel)));
    const double p = Phi((-config_.hard_braking_mps2 - body_target_.mean[kAccel]) / sigma);
    if (target_->existence * p < config_.braking_probability) return;
    // What is not seen is what a sender says of itself: to be told of, not to be braked for.
    const bool is_seen = base.own_sensor_age_s <= 0.5;
    if (!is_seen && !(base.own_sensor_age_s <= config_.urgent_unseen_s)) return;
    Warning warning = NewWarning(Kind::kEebl, Side::kAhead);
    warning.figures = base;
    warning.figures.conflict_probability = target_->existence * p;
    warning.figures.required_decel_mps2 = -body_target_.mean[kAccel];
    warning.basis = Basis::kBraking;
    warning.level = is_seen && placement_.zone == Zone::kAhead ? Level::kWarn : Level::kAdvise;
    found_.push_back({warning, warning.level});
  }

  void Beside() {
    const StateVector& x = body_target_.mean;
    const double gap_m = std::abs(x[kY]) - 0.5 * body_.width_m - body_target_.size.width_m;
    const double rear_m = body_.centre_x_m - 0.5 * body_.length_m;
    const double nose_m = x[kX] + body_target_.size.length_m;
    const bool is_lane = gap_m > 0.0 && gap_m < config_.beside_m;
    if (!is_lane || x[kSpeed] < 2.0 || plan_.speed_mps < 3.0) return;
    const bool is_beside = nose_m > rear_m - config_.behind_m;
    const double closing = x[kSpeed] - plan_.speed_mps;
    const double time_s = closing > 0.3 ? std::max(0.0, rear_m - nose_m) / closing : 1e9;
    const bool is_closing = !is_beside && time_s <= config_.closing_s;
    if (target_->existence < config_.warn_probability) return;
    const bool is_left = x[kY] > 0.0;
    const Side side = is_left ? Side::kRearLeft : Side::kRearRight;
    const bool wants_there = signal_ == (is_left ? TurnSignal::kLeft : TurnSignal::kRight);
    const auto add = [&](Kind kind, Level level) {
      Warning warning = NewWarning(kind, side);
      warning.figures = FiguresOf({});
      warning.figures.conflict_probability = target_->existence;
      warning.figures.time_to_conflict_s = is_beside ? 0.0 : time_s;
      warning.basis = Basis::kBeside;
      warning.level = level;
      found_.push_back({warning, level});
    };
    if (is_beside) add(Kind::kBsw, Level::kAdvise);
    if (wants_there && (is_beside || is_closing)) add(Kind::kLcw, Level::kWarn);
  }

  [[nodiscard]] Warning NewWarning(Kind kind, Side side) const {
    Warning warning;
    warning.track_id = target_->track_id;
    warning.local_id = target_->local_id;
    warning.kind = kind;
    warning.side = side;
    warning.source = target_->source;
    warning.visibility = target_->visibility;
    return warning;
  }

  [[nodiscard]] Figures FiguresOf(const Conflict& conflict) const {
    Figures figures;
    figures.conflict_probability = target_->existence * conflict.probability;
    figures.time_to_conflict_s = conflict.median_s;
    figures.time_to_conflict_early_s = conflict.early_s;
    figures.post_encroachment_s = conflict.post_encroachment_s;
    figures.conflict_B = conflict.place_B;
    figures.position_B = body_target_.mean.head<2>();
    figures.speed_mps = body_target_.mean[kSpeed];
    figures.existence = target_->existence;
    if (target_->last_own != Timestamp{}) {
      figures.own_sensor_age_s = std::max(0.0, ToSeconds(scene_.now - target_->last_own));
    }
    figures.bridge_budget_s = target_->bridge_budget_s;
    return figures;
  }

  // The ego alone can avoid it: by standing before the place.
  [[nodiscard]] Figures CrossingFigures(const Conflict& conflict) const {
    Figures figures = FiguresOf(conflict);
    const double speed = std::max(0.0, plan_.speed_mps);
    figures.warn_before_s = config_.driver_reaction_s + speed / (2.0 * config_.driver_decel_mps2) +
                            config_.warn_margin_s;
    figures.urgent_before_s = config_.planner_reaction_s +
                              speed / (2.0 * config_.planner_decel_mps2) + config_.urgent_margin_s;
    const double enters_s =
        std::isfinite(conflict.median_s) ? conflict.median_s : conflict.ego_enters_s;
    if (enters_s > 0.0) figures.required_decel_mps2 = speed / (2.0 * enters_s);
    return figures;
  }

  void Judge(Kind kind, Side side, const Conflict& conflict, const Figures& figures,
             Level at_most = Level::kUrgent, Level by_gap = Level::kInfo) {
    Warning warning = NewWarning(kind, side);
    warning.figures = figures;
    // NaN compares false: never measured by an own sensor, never URGENT.
    const bool may_be_urgent = figures.own_sensor_age_s <= config_.urgent_unseen_s;
    const auto level_of = [&](double existence) {
      if (existence * conflict.probability_exact >= config_.urgent_probability &&
          conflict.exact_median_s <= figures.urgent_before_s && may_be_urgent) {
        return Level::kUrgent;
      }
      if (existence * conflict.probability >= config_.warn_probability &&
          conflict.median_s <= figures.warn_before_s) {
        return Level::kWarn;
      }
      return existence * conflict.probability >= config_.advise_probability ? Level::kAdvise
                                                                            : Level::kInfo;
    };
    warning.level = level_of(target_->existence);
    Level sure = level_of(1.0);
    if (target_->visibility != Visibility::kVisible && std::isfinite(conflict.reachable_s)) {
      const Level reach =
          conflict.reachable_s <= figures.warn_before_s ? Level::kWarn : Level::kAdvise;
      if (reach > warning.level) {
        warning.level = reach;
        warning.basis = Basis::kReachable;
      }
    }
    if (by_gap > warning.level && target_->existence >= config_.warn_probability) {
      warning.level = by_gap;
      warning.basis = Basis::kGap;
    }
    if (target_->is_sudden) at_most = Level::kAdvise;
    warning.level = std::min(warning.level, at_most);
    sure = std::max(warning.level, std::min(sure, at_most));
    if (sure < Level::kAdvise) return;
    found_.push_back({warning, sure});
  }

  const Scene& scene_;
  const EgoBody& body_;
  const WarningsConfig& config_;
  EgoPlan plan_;
  EgoSigmas sigmas_;
  bool stands_ = false;
  bool is_slow_ = false;
  bool turns_left_ = false;
  TurnSignal signal_ = TurnSignal::kUnknown;
  std::vector<EgoFan> turns_;
  std::optional<EgoFan> fan_;
  std::optional<EgoFan> starting_;  // From a stop; made when needed.
  const Target* target_ = nullptr;
  BodyTarget body_target_;
  Placement placement_;
  std::vector<Assessment> found_;
};

void PredictInO(Target& target, double dt_s) {
  StateVector& x = target.state_O.mean;
  const double moved_m = x[kSpeed] * dt_s;
  const double yaw = x[kYaw] + 0.5 * dt_s * x[kYawRate];
  x[kX] += moved_m * std::cos(yaw);
  x[kY] += moved_m * std::sin(yaw);
  x[kYaw] += dt_s * x[kYawRate];
}

std::vector<Target> At(const TargetList* list, Timestamp now) {
  if (list == nullptr) return {};
  std::vector<Target> targets = list->targets;
  for (Target& target : targets) PredictInO(target, ToSeconds(now - list->stamp));
  return targets;
}

}  // namespace

std::vector<Target> MergeLists(const TargetList* local, const TargetList* priority, Timestamp now) {
  std::vector<Target> merged = At(local, now);
  for (Target& theirs : At(priority, now)) {
    const auto own = std::ranges::find_if(merged, [&theirs](const Target& each) {
      return theirs.local_id != 0 && each.local_id == theirs.local_id &&
             each.source != Source::kPriority;
    });
    if (own == merged.end()) {
      theirs.source = Source::kPriority;
      theirs.local_id = 0;
      merged.push_back(std::move(theirs));
      continue;
    }
    own->track_id = theirs.track_id;
    own->source = Source::kBoth;
    own->bridge_budget_s = theirs.bridge_budget_s;
    own->existence = std::max(own->existence, theirs.existence);
    own->last_own = std::max(own->last_own, theirs.last_own);
    if (own->visibility != Visibility::kVisible) {
      own->state_O = theirs.state_O;
      own->extent = theirs.extent;
    }
  }
  std::ranges::sort(merged, [](const Target& a, const Target& b) {
    return std::pair(a.local_id, a.track_id) < std::pair(b.local_id, b.track_id);
  });
  return merged;
}

Placement Classify(const EgoPlan& plan, const EgoBody& body, const BodyTarget& target,
                   const WarningsConfig& config) {
  Placement placement;
  placement.place = PlaceOnPath(plan, target.mean.head<2>());
  const double reverse = target.mean[kSpeed] < 0.0 ? kPi : 0.0;
  const double turned = WrapAngle(target.mean[kYaw] - placement.place.yaw_rad);
  placement.turned_rad = WrapAngle(turned + reverse);
  placement.half_across_m = std::abs(target.size.length_m * std::sin(turned)) +
                            std::abs(target.size.width_m * std::cos(turned));
  const double along = placement.place.along_m;
  const double in_path_m = 0.5 * body.width_m + placement.half_across_m + config.path_margin_m;
  const bool in_path = std::abs(placement.place.left_m) <= in_path_m;
  const bool stands = std::abs(target.mean[kSpeed]) < kTargetStands_mps;
  const double off = std::abs(placement.turned_rad);
  const double front_m = body.centre_x_m + 0.5 * body.length_m;
  if (stands) {
    if (along > front_m && in_path) placement.zone = Zone::kAhead;
    return placement;
  }
  if (off <= kSameDirection_rad) {
    if (target.mean[kX] < kEye_m) {
      placement.zone = Zone::kBehind;
    } else {
      placement.zone = in_path ? Zone::kAhead : Zone::kAheadAside;
    }
  } else if (along < 0.0) {
    placement.zone = Zone::kElsewhere;
  } else if (off >= kOncoming_rad) {
    placement.zone = Zone::kOncoming;
  } else {
    placement.zone = placement.turned_rad < 0.0 ? Zone::kFromLeft : Zone::kFromRight;
  }
  return placement;
}

std::vector<Assessment> Assess(const Scene& scene, const EgoBody& body,
                               const WarningsConfig& config) {
  return Assessor(scene, body, config).Run();
}

}  // namespace v2vouch::warnings
