// SPDX-License-Identifier: Apache-2.0
// Heights: who is on a bridge over us or on a road below, and what is but another zero of heights.
#include <algorithm>
#include <cmath>

#include "daemon/pipeline/priority_perception.h"

namespace v2vouch {
namespace {

constexpr double kHeard_s = 2.0;  // A sender silent for longer is no witness.
constexpr double kMostAgreed_m = 1000.0;
constexpr double kLongestStep_s = 2.0;

}  // namespace

// A bridge over us or a road below. Vehicles on one road differ by what the road climbs between
// them: nothing, as much as it climbs under the ego, as much as it climbs under the sender, or
// something between these.
bool PriorityPerception::IsOnAnotherLevel(const Link& link) const {
  if (!link.height_difference_m) return false;
  const double allowed_m = settings_->priority.safe.max_height_difference_m;
  const double difference_m = *link.height_difference_m - height_offset_.offset_m();
  return difference_m < link.least_difference_m - allowed_m ||
         difference_m > link.most_difference_m + allowed_m;
}

void PriorityPerception::FollowHeight(Link& link, const Claim& claim, const ClaimInOdometry& here,
                                      const EgoState& ego) {
  const double dt_s = link.heights_at ? ToSeconds(here.stamp - *link.heights_at) : 0.0;
  const double moved_m = claim.speed_mps * std::clamp(dt_s, 0.0, kLongestStep_s);
  link.heights_at = here.stamp;
  link.heights.Add(here.stamp, moved_m,
                   claim.has_elevation ? std::optional(claim.height_m) : std::nullopt);
  CountAgreement(link, here, std::abs(moved_m));

  link.height_difference_m.reset();
  const auto ego_m = ego_heights_.HeightAt(here.stamp);
  const auto sender_m = link.heights.HeightAt(here.stamp);
  if (!ego_m || !sender_m) return;
  link.height_difference_m = *sender_m - *ego_m;
  const Eigen::Vector2d to_sender = here.p_O - ego.X_OB.origin().vector();
  const auto rise_m = [&](double grade, double yaw_rad) {
    return grade * to_sender.dot(Eigen::Vector2d(std::cos(yaw_rad), std::sin(yaw_rad)));
  };
  const double by_ego_m = rise_m(ego_heights_.grade(), ego.X_OB.yaw_rad());
  const double by_sender_m = here.has_course ? rise_m(link.heights.grade(), here.yaw_rad) : 0.0;
  link.least_difference_m = std::min({0.0, by_ego_m, by_sender_m});
  link.most_difference_m = std::max({0.0, by_ego_m, by_sender_m});
}

// Whether the sensors see what the sender says, were heights left out: enough to be validated, by a
// track that is nobody else's.
void PriorityPerception::CountAgreement(Link& link, const ClaimInOdometry& here, double moved_m) {
  const PriorityConfig& config = settings_->priority;
  const PairTable::Pair* pair = pairs_.AssignedTo(link.sender);
  if (pair == nullptr) pair = pairs_apart_.AssignedTo(link.sender);
  if (pair == nullptr || IsHeldByAnother(pair->track_id, link.sender) ||
      IsAnothers(pair->track_id, link.sender) || link.trust.has_penalty()) {
    link.agreed_m = 0.0;
    return;
  }
  const Sensed* sensed = FindSensed(pair->track_id);
  const PairEvidence& evidence = pair->evidence;
  const auto has_seen = [&](int observations, double observed_s) {
    return evidence.observations() >= observations && evidence.span_s() >= observed_s;
  };
  const TrustConfig& trust = config.trust;
  const bool agrees = (has_seen(trust.co_observations, trust.co_observed_s) ||
                       has_seen(trust.slow_observations, trust.slow_observed_s)) &&
                      evidence.is_nis_consistent() && evidence.is_speed_consistent(config.safe) &&
                      evidence.level() <= config.safe.max_level && sensed != nullptr &&
                      sensed->is_sure &&
                      ToSeconds(here.stamp - sensed->track.LastHit()) <= config.bridge.support_s;
  if (agrees) link.agreed_m = std::min(link.agreed_m + moved_m, kMostAgreed_m);
}

void PriorityPerception::JudgeHeights(Timestamp now) {
  witnesses_.clear();
  const double allowed_m = settings_->priority.safe.max_height_difference_m;
  for (const Link& link : links_) {
    if (!link.height_difference_m || !link.heights_at) continue;
    if (std::abs(ToSeconds(now - *link.heights_at)) > kHeard_s) continue;
    const double slack_m = allowed_m + std::max(link.most_difference_m, -link.least_difference_m);
    witnesses_.push_back({link.sender, *link.height_difference_m, slack_m, link.agreed_m});
  }
  if (!height_offset_.Judge(witnesses_)) return;
  // Who is on our level now is matched with what was seen of it all the while.
  for (const Link& link : links_) {
    if (!IsOnAnotherLevel(link)) {
      pairs_.TakeFrom(pairs_apart_, link.sender, settings_->priority.safe);
    }
  }
  pairs_.Assign(settings_->priority.safe);
}

void PriorityPerception::CollectNotices(std::vector<Notice>& notices) const {
  const NoticeSubject gnss{NoticeSubject::Kind::kGnss, 0};
  if (height_offset_.offset_m() != 0.0) {
    notices.push_back({NoticeKind::kHeightOffset, gnss, height_offset_.offset_m()});
  }
  if (const auto unexplained_m = height_offset_.unexplained_m()) {
    notices.push_back({NoticeKind::kHeightsApart, gnss, *unexplained_m});
  }
}

}  // namespace v2vouch
