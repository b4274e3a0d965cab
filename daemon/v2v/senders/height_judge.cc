// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/senders/height_judge.h"

#include <algorithm>
#include <cmath>

namespace v2vouch {
namespace {

constexpr double kHeard_s = 2.0;  // A sender silent for longer is no witness.
constexpr double kLongestStep_s = 2.0;

}  // namespace

void HeightJudge::OnFix(const GnssFix& fix, const EgoState& ego) {
  const Eigen::Vector2d here = ego.X_OB.origin().vector();
  const double moved_m = ego_at_ ? (here - *ego_at_).norm() : 0.0;
  ego_at_ = here;
  const bool has_height = fix.has_height && fix.fix_type >= FixType::k3d;
  ego_.Add(ego.stamp, std::copysign(moved_m, ego.speed_mps),
           has_height ? std::optional(fix.position.height_m) : std::nullopt);
}

double HeightJudge::OnClaim(SenderRecord& record, const Claim& claim, const ClaimInOdometry& here,
                            const EgoState& ego) const {
  SenderHeight& height = record.height;
  const double dt_s = height.last ? ToSeconds(here.stamp - *height.last) : 0.0;
  const double moved_m = claim.speed_mps * std::clamp(dt_s, 0.0, kLongestStep_s);
  height.last = here.stamp;
  height.track.Add(here.stamp, moved_m,
                   claim.has_elevation ? std::optional(claim.height_m) : std::nullopt);
  height.difference_m.reset();
  const auto ego_m = ego_.HeightAt(here.stamp);
  const auto sender_m = height.track.HeightAt(here.stamp);
  if (!ego_m || !sender_m) return moved_m;
  height.difference_m = *sender_m - *ego_m;
  const Eigen::Vector2d to_sender = here.p_O - ego.X_OB.origin().vector();
  const auto rise_m = [&](double grade, double yaw_rad) {
    return grade * to_sender.dot(Eigen::Vector2d(std::cos(yaw_rad), std::sin(yaw_rad)));
  };
  const double by_ego_m = rise_m(ego_.grade(), ego.X_OB.yaw_rad());
  const double by_sender_m = here.has_course ? rise_m(height.track.grade(), here.yaw_rad) : 0.0;
  height.least_m = std::min({0.0, by_ego_m, by_sender_m});
  height.most_m = std::max({0.0, by_ego_m, by_sender_m});
  return moved_m;
}

bool HeightJudge::IsOnAnotherLevel(const SenderRecord& record, double allowed_m) const {
  const SenderHeight& height = record.height;
  if (!height.difference_m) return false;
  const double difference_m = *height.difference_m - offset_.offset_m();
  return difference_m < height.least_m - allowed_m || difference_m > height.most_m + allowed_m;
}

bool HeightJudge::Judge(std::span<const SenderRecord> records, Timestamp now, double allowed_m) {
  witnesses_.clear();
  for (const SenderRecord& record : records) {
    const SenderHeight& height = record.height;
    if (!height.difference_m || !height.last) continue;
    if (std::abs(ToSeconds(now - *height.last)) > kHeard_s) continue;
    const double slack_m = allowed_m + std::max(height.most_m, -height.least_m);
    witnesses_.push_back({record.sender, *height.difference_m, slack_m, height.agreed_m});
  }
  return offset_.Judge(witnesses_);
}

void HeightJudge::CollectNotices(std::vector<Notice>& notices) const {
  const NoticeSubject gnss{NoticeSubject::Kind::kGnss, 0};
  if (offset_.offset_m() != 0.0) {
    notices.push_back({NoticeKind::kHeightOffset, gnss, offset_.offset_m()});
  }
  if (const auto unexplained_m = offset_.unexplained_m()) {
    notices.push_back({NoticeKind::kHeightsApart, gnss, *unexplained_m});
  }
}

}  // namespace v2vouch
