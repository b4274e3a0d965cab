// SPDX-License-Identifier: Apache-2.0
#include "daemon/alignment/alignment.h"

#include <algorithm>
#include <cmath>

#include "daemon/alignment/flat_earth.h"
#include "daemon/base/angle.h"
#include "daemon/base/check.h"

namespace v2vouch {
namespace {

constexpr double kLattice_rad = FromDegrees(0.01);
// A fix that says nothing of its accuracy; phone grade (95 % about 5 m under open sky).
constexpr double kUnknownSigma_m = 2.5;
// Beyond this a fix is no help to anybody 100 m away.
constexpr double kUselessSigma_m = 50.0;
constexpr double kUnknownVelocitySigma_mps = 0.2;
constexpr double kMinVelocitySigma_mps = 0.05;
constexpr double kUnknownYawSigma_rad = 0.05;
constexpr double kSeedDistance_m = 20.0;
constexpr double kAgree_s = 1.0;
constexpr double kNewPlace_s = 10.0;
constexpr double kVouched_s = 5.0;
// Fixes of the new place must follow one another; after a longer silence it starts again.
constexpr double kCandidateGap_s = 2.0;

Wgs84 LatticePoint(const Wgs84& near) {
  const double latitude = std::round(near.latitude_rad / kLattice_rad) * kLattice_rad;
  const double longitude = std::round(near.longitude_rad / kLattice_rad) * kLattice_rad;
  return {std::clamp(latitude, -kPi / 2.0, kPi / 2.0), WrapAngle(longitude), 0.0};
}

// Horizontal covariance, floored; nullopt where the figures cannot be a covariance or say that the
// fix is worth nothing.
std::optional<Eigen::Matrix2d> UsableCovariance(const GnssFix& fix, double floor_m) {
  Eigen::Matrix2d C = fix.covariance_enu.topLeftCorner<2, 2>();
  if (!C.allFinite()) return std::nullopt;
  if (C.isZero(0.0)) C = kUnknownSigma_m * kUnknownSigma_m * Eigen::Matrix2d::Identity();
  C = (0.5 * (C + C.transpose())).eval();
  const double mean = 0.5 * C.trace();
  const double spread = std::hypot(0.5 * (C(0, 0) - C(1, 1)), C(0, 1));
  const double smallest = mean - spread;
  // Rounding may leave a small eigenvalue a little below 0; more than that is no covariance.
  if (C(0, 0) < 0.0 || C(1, 1) < 0.0 || smallest < -1e-6 * mean) return std::nullopt;
  if (mean + spread > kUselessSigma_m * kUselessSigma_m) return std::nullopt;
  if (smallest < floor_m * floor_m) {
    C += (floor_m * floor_m - smallest) * Eigen::Matrix2d::Identity();
  }
  return C;
}

bool HasPosition(const GnssFix& fix) {
  return fix.fix_type != FixType::kNone && std::isfinite(fix.position.latitude_rad) &&
         std::isfinite(fix.position.longitude_rad) && std::isfinite(fix.position.height_m) &&
         std::abs(fix.position.latitude_rad) <= kPi / 2.0 &&
         std::abs(fix.position.longitude_rad) <= 2.0 * kPi;
}

double SigmaOr(double sigma, double fallback, double floor) {
  return std::isfinite(sigma) && sigma > 0.0 ? std::max(sigma, floor) : fallback;
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

FixInPlane Alignment::InPlane(const GnssFix& fix, const Eigen::Matrix2d& covariance_en) const {
  // East and north at the fix are not quite L's axes: meridians converge.
  const double turn = ConvergenceAt(plane_, fix.position);
  const Eigen::Matrix2d R_LN = Pose<LocalEnu, LocalEnu>(0.0, 0.0, turn).rotation();
  FixInPlane in_plane;
  in_plane.p_L = Flat(plane_, fix.position);
  in_plane.covariance = R_LN * covariance_en * R_LN.transpose();
  if (fix.velocity_en_mps && fix.velocity_en_mps->allFinite()) {
    in_plane.v_L = R_LN * *fix.velocity_en_mps;
    in_plane.velocity_sigma_mps =
        SigmaOr(fix.velocity_sigma_mps, kUnknownVelocitySigma_mps, kMinVelocitySigma_mps);
  }
  if (fix.yaw_rad && std::isfinite(*fix.yaw_rad)) {
    in_plane.yaw_L_rad = WrapAngle(*fix.yaw_rad + turn);
    in_plane.yaw_sigma_rad =
        SigmaOr(fix.yaw_sigma_rad, kUnknownYawSigma_rad, config_.yaw_floor_rad + 1e-4);
  }
  return in_plane;
}

std::optional<Reason> Alignment::OnFix(const GnssFix& fix, const EgoState& ego) {
  if (!HasPosition(fix)) return Reason::kGnssUnusable;
  const auto covariance_en = UsableCovariance(fix, config_.position_floor_m);
  if (!covariance_en) return Reason::kGnssUnusable;
  if (newest_ && ego.stamp < *newest_) return Reason::kTooOld;
  newest_ = ego.stamp;

  if (!is_ready_) {
    // Not a jump detector yet: the plane follows the fixes until the first one is used.
    const Wgs84 lattice = LatticePoint(fix.position);
    if (!has_plane_ || Flat(plane_, fix.position).norm() > config_.reanchor_m) {
      plane_ = LocalPlane(lattice);
      has_plane_ = true;
      seed_.reset();
    }
    const auto started = Start(InPlane(fix, *covariance_en), ego);
    if (!started) return std::nullopt;
    filter_ = *started;
    is_ready_ = true;
    height_m_ = fix.position.height_m;
    Publish();
    return std::nullopt;
  }

  filter_.Predict(ego, noise_);
  ReanchorIfFar();
  const FixInPlane in_plane = InPlane(fix, *covariance_en);
  std::optional<Reason> refusal;
  if (filter_.Contradicts(in_plane, antenna_B_, ego, noise_, config_.jump_m)) {
    is_suspect_ = true;
    agrees_since_.reset();
    suspect_until_.reset();
    Challenge(in_plane, ego);
    refusal = Reason::kGnssJump;
  } else {
    candidate_.reset();
    if (is_suspect_ && !suspect_until_) {
      if (!agrees_since_) agrees_since_ = ego.stamp;
      if (ToSeconds(ego.stamp - *agrees_since_) >= kAgree_s) is_suspect_ = false;
    }
    if (suspect_until_ && ego.stamp >= *suspect_until_) {
      suspect_until_.reset();
      is_suspect_ = false;
    }
    if (is_suspect_ && !suspect_until_) {
      refusal = Reason::kGnssJump;  // Agrees again, but not yet for long enough.
    } else {
      agrees_since_.reset();
      filter_.Update(in_plane, antenna_B_, ego, noise_);
      height_m_ = fix.position.height_m;
    }
  }
  if (!filter_.IsSound()) {  // Start again rather than publish nonsense.
    is_ready_ = false;
    has_plane_ = false;
    seed_.reset();
    candidate_.reset();
    return Reason::kGnssUnusable;
  }
  Publish();
  return refusal;
}

std::optional<AlignmentFilter> Alignment::Start(const FixInPlane& fix, const EgoState& ego) {
  if (fix.yaw_L_rad) {
    return AlignmentFilter(fix, *fix.yaw_L_rad - ego.X_OB.yaw_rad(), fix.yaw_sigma_rad, antenna_B_,
                           ego);
  }
  if (const auto yaw =
          AlignmentFilter::YawFromCourse(fix, antenna_B_, ego, config_.min_course_speed_mps)) {
    return AlignmentFilter(fix, *yaw, AlignmentFilter::CourseSigma(fix, ego), antenna_B_, ego);
  }
  if (fix.v_L) return std::nullopt;
  // A receiver of positions only: compare the way in L with the way in O.
  const Eigen::Vector2d antenna_O = ego.X_OB.origin().vector() + ego.X_OB.rotation() * antenna_B_;
  const double sigma = std::sqrt(0.5 * fix.covariance.trace());
  if (!seed_) {
    seed_ = Seed{fix.p_L, antenna_O, sigma};
    return std::nullopt;
  }
  const Eigen::Vector2d way_O = antenna_O - seed_->antenna_O;
  const Eigen::Vector2d way_L = fix.p_L - seed_->antenna_L;
  const double yaw_sigma = std::hypot(sigma, seed_->sigma_m) / std::max(way_O.norm(), 1.0);
  if (way_O.norm() < kSeedDistance_m || yaw_sigma > 0.1) return std::nullopt;
  return AlignmentFilter(fix, std::atan2(way_L.y(), way_L.x()) - std::atan2(way_O.y(), way_O.x()),
                         yaw_sigma, antenna_B_, ego);
}

void Alignment::Challenge(const FixInPlane& fix, const EgoState& ego) {
  if (candidate_ && ToSeconds(ego.stamp - candidate_->last) > kCandidateGap_s) candidate_.reset();
  if (candidate_) {
    const double dt = ToSeconds(ego.stamp - candidate_->last);
    candidate_->filter.Predict(ego, noise_);
    if (candidate_->filter.Contradicts(fix, antenna_B_, ego, noise_, config_.jump_m)) {
      candidate_.reset();
    } else {
      candidate_->filter.Update(fix, antenna_B_, ego, noise_);
      candidate_->last = ego.stamp;
      if (std::abs(ego.speed_mps) >= config_.min_course_speed_mps) candidate_->driven_s += dt;
    }
  }
  if (!candidate_) {
    // Where the fix brings no yaw, ours is as good a guess as any; motion will tell.
    double yaw = filter_.yaw_rad();
    double sigma = std::sqrt(filter_.PoseCovariance()(2, 2));
    if (const auto course =
            AlignmentFilter::YawFromCourse(fix, antenna_B_, ego, config_.min_course_speed_mps)) {
      yaw = *course;
      sigma = AlignmentFilter::CourseSigma(fix, ego);
    }
    candidate_ = Candidate{AlignmentFilter(fix, yaw, sigma, antenna_B_, ego), ego.stamp, 0.0};
    return;
  }
  const bool is_vouched = vouched_ && ToSeconds(ego.stamp - *vouched_) < kVouched_s;
  if (candidate_->driven_s < kNewPlace_s || is_vouched) return;
  candidate_->filter.InheritOdometryErrors(filter_);
  filter_ = candidate_->filter;
  candidate_.reset();
  suspect_until_ = ego.stamp + FromSeconds(kNewPlace_s);
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
  if (candidate_) rebase(candidate_->filter);
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
  return ToGeodetic(centre.vector(), height_m_);
}

}  // namespace v2vouch
