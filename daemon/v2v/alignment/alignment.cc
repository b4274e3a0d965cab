// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/alignment/alignment.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/check.h"
#include "daemon/v2v/alignment/fix_quality.h"
#include "daemon/v2v/alignment/flat_earth.h"

namespace v2vouch {
namespace {

constexpr double kLattice_rad = FromDegrees(0.01);
constexpr double kAgree_s = 1.0;      // Fixes agree for so long: the doubt ends.
constexpr double kNewPlace_s = 10.0;  // Of driving until a rival place is taken.
constexpr double kVouched_s = 5.0;    // So long an agreeing claim rules out a move.
// Fixes of the new place must follow one another; after a longer silence it starts again.
constexpr double kCandidateGap_s = 2.0;
// How long fixes must have agreed with an estimate before it is more than the first of several
// opinions: twice the correlation time of a receiver's errors. A few seconds of bad fixes after
// switching on (cold start, no sky) stay below.
constexpr double kEstablished_s = 10.0;
constexpr double kDirected_m = 20.0;  // Way by which a direction is confirmed.
constexpr double kOverrule_s = 1.0;
constexpr int kOverruleFixes = 3;
constexpr double kLongestStep_s = 1.5;  // A fix supports no longer than this.

Wgs84 LatticePoint(const Wgs84& near) {
  const double latitude = std::round(near.latitude_rad / kLattice_rad) * kLattice_rad;
  const double longitude = std::round(near.longitude_rad / kLattice_rad) * kLattice_rad;
  return {std::clamp(latitude, -kPi / 2.0, kPi / 2.0), WrapAngle(longitude), 0.0};
}

}  // namespace

Alignment::Alignment(const AlignmentConfig& config, const VehicleConfig& vehicle)
    : config_(config),
      vehicle_(vehicle),
      antenna_B_(vehicle.antenna_x_m, vehicle.antenna_y_m),
      noise_{config.drift_per_m, config.yaw_drift_per_s, config.min_course_speed_mps} {}

Timestamp Alignment::FixTime(const GnssFix& fix) const {
  return fix.stamp - FromSeconds(vehicle_.gnss_latency_s);
}

void Alignment::Vouch(Timestamp at) { vouched_ = vouched_ ? std::max(*vouched_, at) : at; }

// The plane is good near its origin only: half round the earth it folds back on itself.
bool Alignment::IsFar(const LocalPlane& plane, const GnssFix& fix) const {
  const Eigen::Vector3d from_E = ToEcef(fix.position).p_E - ToEcef(plane.origin()).p_E;
  constexpr double kHeights_m = 20000.0;  // Two heights may differ so.
  return from_E.norm() > 2.0 * config_.reanchor_m + kHeights_m;
}

std::optional<Refusal> Alignment::OnFix(const GnssFix& fix, const EgoState& ego) {
  if (!HasPosition(fix)) return Refusal{Reason::kGnssUnusable, "latitude_rad and longitude_rad"};
  const auto covariance_en = UsableCovariance(fix, config_.position_floor_m);
  if (!covariance_en) return Refusal{Reason::kGnssUnusable, "covariance_enu_m2"};
  if (newest_ && ego.stamp < *newest_) return Refusal{Reason::kTooOld, "utime"};
  const double dt_s = newest_ ? std::min(ToSeconds(ego.stamp - *newest_), kLongestStep_s) : 0.0;
  newest_ = ego.stamp;

  if (!is_ready_) {
    const auto started = TryStart(fix, *covariance_en, ego);
    if (!started) return std::nullopt;
    filter_ = *started;
    plane_ = *start_plane_;
    is_ready_ = true;
    support_s_ = way_m_ = 0.0;
    start_.Reset();
    if (fix.has_height) height_m_ = fix.position.height_m;
    Publish();
    return std::nullopt;
  }

  filter_.Predict(ego, noise_);
  ReanchorIfFar();
  const FixInPlane in_plane = InPlane(plane_, fix, *covariance_en, config_.yaw_floor_rad);
  const std::string_view contradiction =
      IsFar(plane_, fix) ? std::string_view("latitude_rad and longitude_rad")
                         : filter_.Contradiction(in_plane, antenna_B_, ego, noise_, config_.jump_m);
  std::optional<Refusal> refusal;
  if (!contradiction.empty()) {
    is_suspect_ = true;
    agrees_since_.reset();
    suspect_until_.reset();
    Challenge(fix, *covariance_en, dt_s, ego);
    refusal = Refusal{Reason::kGnssJump, contradiction};
  } else {
    Agree(dt_s, ego);
    if (is_suspect_ && !suspect_until_) {
      // Agrees again, but not yet for long enough.
      refusal = Refusal{Reason::kGnssJump, "latitude_rad and longitude_rad"};
    } else {
      agrees_since_.reset();
      filter_.Update(in_plane, antenna_B_, ego, noise_);
      if (fix.has_height) height_m_ = fix.position.height_m;
    }
  }
  if (!filter_.IsSound()) {  // Start again rather than publish nonsense.
    is_ready_ = false;
    start_plane_.reset();
    start_.Reset();
    candidate_.reset();
    return Reason::kGnssUnusable;
  }
  Publish();
  return refusal;
}

void Alignment::Agree(double dt_s, const EgoState& ego) {
  const bool was_established = IsEstablished();
  support_s_ += dt_s;
  way_m_ += std::abs(ego.speed_mps) * dt_s;
  if (was_established || (candidate_ && (candidate_->support_s -= dt_s) < 0.0)) {
    candidate_.reset();
    start_.Reset();
  }
  if (is_suspect_ && !suspect_until_) {
    if (!agrees_since_) agrees_since_ = ego.stamp;
    // Between openings the votes decide; a fix for the present one is not kept waiting.
    const double agreed_s = ToSeconds(ego.stamp - *agrees_since_);
    if (agreed_s >= kAgree_s || support_s_ < kEstablished_s) is_suspect_ = false;
  }
  if (suspect_until_ && ego.stamp >= *suspect_until_) {
    suspect_until_.reset();
    is_suspect_ = false;
  }
}

// Starts an estimate, or a rival of the present one, in a plane near the fix.
std::optional<AlignmentFilter> Alignment::TryStart(const GnssFix& fix,
                                                   const Eigen::Matrix2d& covariance_en,
                                                   const EgoState& ego) {
  if (!start_plane_ || Flat(*start_plane_, fix.position).norm() > config_.reanchor_m ||
      IsFar(*start_plane_, fix)) {
    start_plane_ = LocalPlane(LatticePoint(fix.position));
    start_.Reset();
  }
  return start_.OnFix(InPlane(*start_plane_, fix, covariance_en, config_.yaw_floor_rad), ego,
                      antenna_B_, config_.min_course_speed_mps, config_.jump_m);
}

bool Alignment::IsEstablished() const {
  return support_s_ >= kEstablished_s && way_m_ >= kDirected_m;
}

bool Alignment::HasWon(const Candidate& candidate) const {
  if (candidate.driven_s >= kNewPlace_s) return true;
  if (candidate.support_s < kOverrule_s || candidate.fixes < kOverruleFixes) return false;
  if (support_s_ < kEstablished_s) return candidate.support_s > support_s_;
  return way_m_ < kDirected_m && candidate.way_m >= kDirected_m;
}

void Alignment::FollowCandidate(const GnssFix& fix, const Eigen::Matrix2d& covariance_en,
                                double dt_s, const EgoState& ego) {
  if (ToSeconds(ego.stamp - candidate_->last) > kCandidateGap_s) return candidate_.reset();
  Candidate& candidate = *candidate_;
  candidate.filter.Predict(ego, noise_);
  const FixInPlane in_plane = InPlane(candidate.plane, fix, covariance_en, config_.yaw_floor_rad);
  if (IsFar(candidate.plane, fix) ||
      !candidate.filter.Contradiction(in_plane, antenna_B_, ego, noise_, config_.jump_m).empty()) {
    // One stray fix among good ones does not end what those have in common.
    candidate.support_s -= dt_s;
    if (IsEstablished() || candidate.support_s < 0.0) candidate_.reset();
    return;
  }
  candidate.filter.Update(in_plane, antenna_B_, ego, noise_);
  const double since_s = ToSeconds(ego.stamp - candidate.last);
  candidate.last = ego.stamp;
  if (std::abs(ego.speed_mps) >= config_.min_course_speed_mps) candidate.driven_s += since_s;
  candidate.support_s += dt_s;
  candidate.way_m += std::abs(ego.speed_mps) * dt_s;
  ++candidate.fixes;
}

void Alignment::Challenge(const GnssFix& fix, const Eigen::Matrix2d& covariance_en, double dt_s,
                          const EgoState& ego) {
  const auto started = TryStart(fix, covariance_en, ego);
  if (candidate_) FollowCandidate(fix, covariance_en, dt_s, ego);
  const bool is_better = candidate_ && candidate_->is_guess && started && !IsEstablished();
  if (!candidate_ || is_better) {
    const bool is_near =
        !IsFar(plane_, fix) && Flat(plane_, fix.position).norm() <= 2.0 * config_.reanchor_m;
    Candidate fresh{.plane = is_near ? plane_ : *start_plane_, .filter = {}, .last = ego.stamp};
    const FixInPlane in_plane = InPlane(fresh.plane, fix, covariance_en, config_.yaw_floor_rad);
    if (started) {
      const double turn =
          ConvergenceAt(fresh.plane, fix.position) - ConvergenceAt(*start_plane_, fix.position);
      fresh.filter = *started;
      fresh.filter.Rebase(Flat(fresh.plane, Unflat(*start_plane_, started->body_L())), turn);
    } else {
      // Where the fixes bring no yaw, the present yaw is the guess; motion corrects it.
      const double sigma = std::sqrt(filter_.PoseCovariance()(2, 2));
      fresh.filter = AlignmentFilter(in_plane, filter_.yaw_rad(), sigma, antenna_B_, ego);
      fresh.is_guess = true;
    }
    candidate_ = fresh;
    return;
  }
  const bool is_vouched = vouched_ && ToSeconds(ego.stamp - *vouched_) < kVouched_s;
  if (!HasWon(*candidate_) || is_vouched) return;
  candidate_->filter.InheritOdometryErrors(filter_);
  filter_ = candidate_->filter;
  plane_ = candidate_->plane;
  // Moving away from an established place leaves a doubt; choosing between two openings does not.
  if (IsEstablished()) {
    suspect_until_ = ego.stamp + FromSeconds(kNewPlace_s);
  } else {
    is_suspect_ = false;
  }
  support_s_ = candidate_->support_s;
  way_m_ = candidate_->way_m;
  if (fix.has_height) height_m_ = fix.position.height_m;
  candidate_.reset();
  start_.Reset();
  ReanchorIfFar();
}

void Alignment::ReanchorIfFar() {
  if (filter_.body_L().norm() <= config_.reanchor_m) return;
  const LocalPlane old = plane_;
  const Wgs84 car = Unflat(old, filter_.body_L());
  plane_ = LocalPlane(LatticePoint(car));
  const auto rebase = [&](AlignmentFilter& filter) {
    const Wgs84 place = Unflat(old, filter.body_L());
    filter.Rebase(Flat(plane_, place), ConvergenceAt(plane_, place) - ConvergenceAt(old, place));
  };
  rebase(filter_);
  if (candidate_ && candidate_->plane.origin() == old.origin()) {
    rebase(candidate_->filter);
    candidate_->plane = plane_;
  }
}

void Alignment::Publish() {
  const Eigen::Matrix3d P = filter_.PoseCovariance();
  // X_LO's origin is where O's origin lies, seen from the car through the yaw.
  const Eigen::Vector2d to_car_L = X_LO().rotation() * filter_.body_O();
  Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
  J(0, 2) = to_car_L.y();
  J(1, 2) = -to_car_L.x();
  Eigen::Matrix3d consider = Eigen::Matrix3d::Zero();
  consider.diagonal() << config_.slow_error_m * config_.slow_error_m,
      config_.slow_error_m * config_.slow_error_m, config_.yaw_floor_rad * config_.yaw_floor_rad;
  covariance_ = J * (P + consider) * J.transpose();
}

Pose<LocalEnu, Odometry> Alignment::X_LO() const { return filter_.X_LO(); }

Eigen::Matrix2d Alignment::CovarianceAt(const Eigen::Vector2d& p_O) const {
  Eigen::Matrix3d P = filter_.PoseCovariance();
  P(0, 0) += config_.slow_error_m * config_.slow_error_m;
  P(1, 1) += config_.slow_error_m * config_.slow_error_m;
  P(2, 2) += config_.yaw_floor_rad * config_.yaw_floor_rad;
  const Eigen::Vector2d from_car_L = X_LO().rotation() * (p_O - filter_.body_O());
  Eigen::Matrix<double, 2, 3> J;
  J << 1.0, 0.0, -from_car_L.y(),  //
      0.0, 1.0, from_car_L.x();
  return J * P * J.transpose();
}

Wgs84 Alignment::ToGeodetic(const Eigen::Vector2d& p_O, double height_m) const {
  V2VOUCH_CHECK(is_ready_);
  Wgs84 place = Unflat(plane_, (X_LO() * Point<Odometry>{p_O.x(), p_O.y()}).vector());
  place.height_m = height_m;
  return place;
}

Wgs84 Alignment::EgoGeodetic(const EgoState& ego) const {
  const Point<Odometry> centre = ego.X_OB * Point<Body>{vehicle_.centre_x_m, 0.0};
  return ToGeodetic(centre.vector(), height_m_.value_or(0.0));
}

}  // namespace v2vouch
