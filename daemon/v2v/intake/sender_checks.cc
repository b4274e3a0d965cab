// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/intake/sender_checks.h"

#include <algorithm>
#include <cmath>

#include "daemon/v2v/intake/intake.h"

namespace v2vouch {
namespace {

constexpr double kContested_s = 2.0;  // So long the same core data under two ids counts.
// Claimed times closer than this are one: GNSS units repeat a place with its stamp.
constexpr double kSameTime_s = 0.02;
constexpr double kPatience_s = 3.0;    // Between two spells of poor accuracy that clear the path.
constexpr double kStanding_mps = 0.5;  // Without a course, speed below this makes no way.

}  // namespace

std::optional<Finding> SenderChecks::Judge(const Claim& claim, const SenderTrack& track,
                                           const MessageCheckConfig& config) {
  std::optional<Finding> gravest;
  const auto add = [&gravest](const std::optional<Finding>& finding) {
    if (finding && (!gravest || finding->severity > gravest->severity)) gravest = finding;
  };
  if (contested_) {
    if (ToSeconds(claim.received - *contested_) <= kContested_s) {
      add(Finding{Check::kContestedCore, Verdict::kWithdraw, "identities", 2.0, 1.0});
    }
    contested_.reset();
  }
  add(rate_.Judge(claim.received, config));
  const double dt_s = last_ ? ToSeconds(claim.received - last_->received) : 0.0;
  implausible_.OnMessage(false);
  add(implausible_.Judge(config));
  if (claim.accuracy_is_poor) {
    // A unit that reports poor accuracy makes no claim about its position: neither position nor
    // path is judged.
    was_poor_ = true;
  } else {
    // Its error has changed meanwhile, which is no displacement. At most once in kPatience_s: a
    // sender must not clear its path at will.
    if (was_poor_ && (!cleared_ || ToSeconds(claim.received - *cleared_) >= kPatience_s)) {
      path_.Restart();
      last_path_.reset();
      cleared_ = claim.received;
    }
    was_poor_ = false;
    add(JudgeMotion(claim, track, config));
    add(innovation_.Judge(track.latest_nis, track.nis_freedom, dt_s, config));
  }
  add(size_.Judge(claim.length_m, claim.width_m, config));
  add(delay_.Judge(claim.age_s, config));
  return gravest;
}

std::optional<Finding> SenderChecks::JudgeMotion(const Claim& claim, const SenderTrack& track,
                                                 const MessageCheckConfig& config) {
  Last here;
  here.received = claim.received;
  here.claimed_s = static_cast<double>(ToMicros(claim.received)) * 1e-6 - claim.age_s;
  here.p_E = claim.p_E;
  here.speed_mps = claim.speed_mps;
  here.has_course = claim.has_course;
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();
  if (claim.has_course) direction = (track.plane.R_LE() * claim.course_E).head<2>();
  if (last_) {
    const Eigen::Vector2d moved_m = (track.plane.R_LE() * (claim.p_E - last_->p_E)).head<2>();
    here.way_m = last_->way_m + moved_m;
    // A long way is not explained by a long time that is merely claimed.
    here.credible_s =
        last_->credible_s + std::min(here.claimed_s - last_->claimed_s,
                                     ToSeconds(here.received - last_->received) + config.late_s);
    // Without a claimed course the direction is that of the displacement.
    if (!claim.has_course && moved_m.norm() > 0.0) direction = moved_m.normalized();
  }
  here.yaw_rad = std::atan2(direction.y(), direction.x());
  last_ = here;

  const auto step = speed_step_.Judge(here.credible_s, here.speed_mps, config);
  const auto jump = jump_.Judge({here.credible_s, here.way_m, here.speed_mps * direction}, config);
  if (jump || !last_path_) {
    path_.Restart();
    last_path_ = here;
    return jump ? jump : step;
  }
  const double dt_s = here.credible_s - last_path_->credible_s;
  if (dt_s < kSameTime_s) return step;
  std::optional<Finding> path;
  const bool has_way = (here.has_course || std::abs(here.speed_mps) < kStanding_mps) &&
                       (last_path_->has_course || std::abs(last_path_->speed_mps) < kStanding_mps);
  if (has_way) {
    path = path_.Judge(
        {dt_s, here.way_m - last_path_->way_m,
         ClaimedWay(last_path_->yaw_rad, last_path_->speed_mps, here.yaw_rad, here.speed_mps, dt_s),
         claim.position_sigma_m},
        config);
  } else {
    path_.Restart();
  }
  last_path_ = here;
  return path && path->severity == Verdict::kAccuse ? path : step ? step : path;
}

}  // namespace v2vouch
