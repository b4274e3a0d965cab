// SPDX-License-Identifier: Apache-2.0
#include "daemon/warnings/assess.h"

#include <algorithm>
#include <cmath>

#include "daemon/warnings/levels.h"
#include "daemon/warnings/placement.h"
#include "daemon/warnings/turn_plans.h"

namespace v2vouch::warnings {
namespace {

constexpr double kStands_mps = 0.5;     // Of the ego: slower stands.
constexpr double kTurning_radps = 0.1;  // With a car's steering: about to turn off.
constexpr double kFastestTurn_mps = 30.0 / 3.6;
constexpr double kLeftTurnOncoming_rad = 1.745;
constexpr double kAdjacent_m = 5.4;

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
    for (const EgoPlan& turn :
         PlanTurns(plan_, {stands_, is_slow_, turns_left_, signal_}, config_)) {
      turns_.emplace_back(turn, sigmas_, body_, config_);
    }
    fan_.emplace(plan_, sigmas_, body_, config_);
  }

  std::vector<Assessment> Run() {
    for (const Target& target : scene_.targets) {
      target_ = &target;
      body_target_ = InBody(target, scene_.ego_p_O, scene_.ego_yaw_O);
      if (IsInEgo(body_target_, body_)) continue;
      placement_ = Classify(plan_, body_, body_target_, config_);
      AssessTarget();
    }
    return std::move(found_);
  }

 private:
  // All kinds that apply to the vehicle at hand.
  void AssessTarget() {
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
    const Conflict conflict =
        AssessConflict(*fan_, InItsLane(plan_, body_target_, placement_), config_);
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
    const bool is_alongside = IsAlongside(body_, body_target_, placement_);
    Judge(Kind::kFcw, Side::kAhead, conflict, figures,
          is_alongside ? Level::kAdvise : Level::kUrgent);
  }

  void HeadOn() {
    const std::optional<BodyTarget> kept = ComingInItsLane(body_target_, placement_);
    Conflict conflict =
        AssessConflict(kept ? Straight() : *fan_, kept ? *kept : body_target_, config_);
    // On a bend every oncoming vehicle is ahead for a while: of one that follows no lane along the
    // ego's path only what is nearly sure counts.
    const double least = kept ? config_.warn_probability : config_.urgent_probability;
    if (conflict.probability < least) return;
    if (kept) {
      const auto step = static_cast<std::size_t>(std::lround(conflict.median_s / kStep_s));
      conflict.place_B = fan_->mean()[step].centre;
    }
    Judge(Kind::kFcw, Side::kOncoming, conflict, CrossingFigures(conflict));
  }

  // The ego's path laid out straight.
  const EgoFan& Straight() {
    if (!straight_) {
      EgoPlan plan = plan_;
      plan.curvature_per_m = 0.0;
      plan.path_B.clear();
      straight_.emplace(plan, sigmas_, body_, config_);
    }
    return *straight_;
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
    // What a vehicle has done since it was hidden nobody knows.
    const bool is_seen = target_->visibility == Visibility::kVisible;
    const Conflict conflict = AssessConflict(
        stands_ ? *starting_ : *fan_, is_seen ? Steadied(body_target_) : body_target_, config_);
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
    const auto chance = [&](double mps2) {
      return target_->existence * Phi((-mps2 - body_target_.mean[kAccel]) / sigma);
    };
    // What a vouched sender says of its brakes comes 0.3 s before own sensors are sure of it; that
    // it brakes at all they must see.
    double p = chance(config_.hard_braking_mps2);
    if (target_->says_hard_braking) p = std::max(p, chance(config_.claimed_braking_mps2));
    if (p < config_.braking_probability) return;
    // An unseen vehicle's braking is its sender's claim: it may advise, not make the ego brake.
    const bool is_seen = base.own_sensor_age_s <= 0.5;
    if (!is_seen && !(base.own_sensor_age_s <= config_.urgent_unseen_s)) return;
    Warning warning = NewWarning(Kind::kEebl, Side::kAhead);
    warning.figures = base;
    warning.figures.conflict_probability = p;
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

  // Only the ego can avoid it: by stopping before the conflict.
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
    const double urgent_probability =
        kind == Kind::kIma ? config_.urgent_crossing_probability : config_.urgent_probability;
    const Levels levels =
        LevelsOf(*target_, conflict, figures, {urgent_probability, at_most, by_gap}, config_);
    warning.level = levels.level;
    warning.basis = levels.basis;
    if (levels.if_sure < Level::kAdvise) return;
    found_.push_back({warning, levels.if_sure});
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
  std::optional<EgoFan> straight_;  // The path laid out straight; made when needed.
  const Target* target_ = nullptr;
  BodyTarget body_target_;
  Placement placement_;
  std::vector<Assessment> found_;
};

}  // namespace

std::vector<Assessment> Assess(const Scene& scene, const EgoBody& body,
                               const WarningsConfig& config) {
  return Assessor(scene, body, config).Run();
}

}  // namespace v2vouch::warnings
