// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/intake/direction_reading.h"

#include <algorithm>
#include <cmath>

namespace v2vouch {
namespace {

constexpr double kLongestSilence_s = 1.0;  // After it the comparison starts again.
// A heading that turns by more than this (cosine) between two messages has changed its meaning.
constexpr double kTurned = -0.7;
// A displacement that does not match the speed decides nothing.
constexpr double kLeastShare = 0.4;
constexpr double kMostShare = 2.5;

}  // namespace

bool DirectionReading::Settle(const Claim& claim, const Eigen::Vector3d& u, double speed_mps) {
  const double dt_s = ToSeconds(claim.received - last_);
  if (dt_s < 0.0 || dt_s > kLongestSilence_s || u.dot(u_) < kTurned) {
    from_E_ = claim.p_E;
    way_.setZero();
    return false;
  }
  way_ += dt_s * speed_mps * u;
  const double way_m = way_.norm();
  if (way_m < kLeastWay_m) return false;
  Eigen::Vector3d moved = claim.p_E - from_E_;
  // Heights come and go (a fix in two dimensions): only the way along the road counts.
  const Eigen::Vector3d up = claim.p_E.normalized();
  moved -= moved.dot(up) * up;
  const double moved_m = moved.norm();
  const double cosine = moved_m > 0.0 ? moved.dot(way_) / (moved_m * way_m) : 0.0;
  from_E_ = claim.p_E;
  way_.setZero();
  if (moved_m < kLeastShare * way_m || moved_m > kMostShare * way_m || std::abs(cosine) < 0.5) {
    return false;
  }
  const bool was_against = is_against_;
  is_against_ = cosine < 0.0;
  is_settled_ = true;
  return is_against_ != was_against;
}

// Whether motion goes against the heading `u`, from the message before and what was driven since.
// @return whether displacement or speed has changed the answer.
bool DirectionReading::Follow(Transmission transmission, const Claim& claim,
                              const Eigen::Vector3d& u, double speed_mps) {
  const bool is_reverse = transmission == Transmission::kReverse;
  const bool is_forward = transmission == Transmission::kForward;
  if (!has_last_) {
    is_against_ = false;
    is_settled_ = false;
    from_E_ = claim.p_E;
    way_.setZero();
    return false;
  }
  const bool was_reverse = transmission_ == Transmission::kReverse;
  // With the gear, what the heading means may change; so may it where it turns round.
  if (is_reverse != was_reverse || is_forward != (transmission_ == Transmission::kForward)) {
    is_settled_ = false;
    from_E_ = claim.p_E;
    way_.setZero();
    if (!is_reverse) is_against_ = false;
  } else if (u.dot(u_) < kTurned) {
    is_settled_ = false;
    is_against_ = false;
  }
  // In reverse gear the body keeps its direction until displacement has spoken.
  if (is_reverse && !is_settled_) is_against_ = u.dot(course_) > 0.0;
  const bool may_reverse = is_reverse || (!is_forward && speed_mps <= kMostReverse_mps);
  if (may_reverse) return Settle(claim, u, speed_mps);
  const bool has_changed = is_against_;
  is_against_ = false;
  is_settled_ = false;
  from_E_ = claim.p_E;
  way_.setZero();
  return has_changed;
}
bool DirectionReading::Read(Transmission transmission, Claim& claim) {
  if (!claim.has_course) {
    has_last_ = false;
    is_settled_ = false;
    return false;
  }
  const bool is_reverse = transmission == Transmission::kReverse;
  const bool is_forward = transmission == Transmission::kForward;
  const Eigen::Vector3d u = is_reverse ? Eigen::Vector3d(-claim.course_E) : claim.course_E;
  const double speed_mps = std::abs(claim.speed_mps);
  const bool was_known = has_last_;
  const bool has_changed = Follow(transmission, claim, u, speed_mps);
  const Eigen::Vector3d direction = is_against_ ? Eigen::Vector3d(-u) : u;  // Of motion.
  if (is_reverse) {
    claim.course_E = -direction;
    claim.speed_mps = -speed_mps;  // -0.0 where it stands in reverse gear.
  } else if (!is_forward && was_known && speed_mps <= kMostReverse_mps &&
             (is_against_ ? -1.0 : 1.0) * u.dot(course_) < kTurned) {
    claim.course_E = -direction;  // The body stays as it was: it rolls the other way.
    claim.speed_mps = -speed_mps;
  } else {
    claim.course_E = direction;
    claim.speed_mps = speed_mps;
  }
  const bool has_turned = was_known && claim.course_E.dot(course_) < kTurned;
  const bool was_backwards = was_known && read_mps_ < 0.0;
  read_mps_ = claim.speed_mps;
  has_last_ = true;
  last_ = claim.received;
  transmission_ = transmission;
  u_ = u;
  course_ = claim.course_E;
  if (!has_changed && !(has_turned && was_backwards && !is_forward)) return false;
  if (reread_ != Timestamp{} && ToSeconds(claim.received - reread_) < kPatience_s) return false;
  reread_ = claim.received;
  return true;
}

}  // namespace v2vouch
