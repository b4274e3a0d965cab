// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/perception/sender_list.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "daemon/v2v/perception/claimed_position.h"

namespace v2vouch {
namespace {

// Claims older than this when listed are left out: their sender has gone silent.
constexpr double kMaxListed_s = 2.0;

std::optional<BiasEstimate> SettledBias(const BiasReport& report, SenderId sender) {
  const auto at = std::ranges::lower_bound(report.senders, sender, {}, &BiasReport::Sender::sender);
  const bool is_known = at != report.senders.end() && at->sender == sender;
  if (!is_known || at->verdict == BiasVerdict::kTooFew) return std::nullopt;
  return at->bias;
}

PublishedTrack LineOf(const SenderTrack& sender, const V2vPerception& priority,
                      const BiasReport& settled, Timestamp at) {
  const Alignment& alignment = priority.alignment();
  Claim claim = sender.latest;
  claim.p_E = sender.p_E;
  claim.course_E = sender.course_E;
  claim.speed_mps = sender.state.mean[kSpeed];
  claim.age_s = 0.0;  // The filter has carried it to its reception already.
  const ClaimInOdometry now = alignment.ToOdometry(claim, std::max(at, claim.received));

  PublishedTrack line;
  line.track.id = sender.sender;
  line.track.start = sender.first_received;
  line.track.state_O.mean << now.p_O.x(), now.p_O.y(), now.yaw_rad, now.speed_mps,
      now.yaw_rate_radps, now.accel_mps2;
  // The sender's plane is east-north; O is turned against it.
  const Eigen::Matrix2d R_OL = alignment.X_LO().Inverse().rotation();
  StateMatrix& P = line.track.state_O.covariance = sender.state.covariance;
  P.topRows<2>() = (R_OL * P.topRows<2>()).eval();
  P.leftCols<2>() = (P.leftCols<2>() * R_OL.transpose()).eval();
  line.track.state_O.covariance.topLeftCorner<2, 2>() += now.alignment;
  line.track.extent = {.length_m = claim.length_m.value_or(kUsualLength_m),
                       .width_m = claim.width_m.value_or(kUsualWidth_m),
                       .length_sigma_m = claim.length_m ? 0.1 : 1.0,
                       .width_sigma_m = claim.width_m ? 0.1 : 0.3};
  line.track.object_class = ObjectClass::kUnknown;
  line.track.existence = 0.0;  // Said by radio alone: worth nothing by itself.
  line.last_v2v = sender.latest.received;
  line.sender = sender.sender;
  line.trust = priority.TrustOf(sender.sender);
  line.position = alignment.ToGeodetic(now.p_O, claim.height_m);
  auto bias = priority.BiasOf(sender.sender);
  if (!bias) bias = SettledBias(settled, sender.sender);
  if (bias) {
    line.bias_east_m = bias->mean_en.x();
    line.bias_north_m = bias->mean_en.y();
  }
  return line;
}

}  // namespace

EgoPlace PlaceOf(const Alignment& alignment, const EgoState& ego, const VehicleConfig& vehicle) {
  const Point<Odometry> centre = ego.X_OB * Point<Body>{vehicle.centre_x_m, 0.0};
  const Pose<LocalEnu, Odometry> X_LO = alignment.X_LO();
  const Point<LocalEnu> p_L = X_LO * centre;
  const double yaw_L = X_LO.yaw_rad() + ego.X_OB.yaw_rad();
  const LocalPlane& plane = alignment.plane();
  EgoPlace place;
  place.p_E = plane.ToEcefPoint({Eigen::Vector3d(p_L.x_m, p_L.y_m, 0.0)}).p_E;
  place.course_E =
      plane.R_LE().transpose() * Eigen::Vector3d(std::cos(yaw_L), std::sin(yaw_L), 0.0);
  place.speed_mps = ego.speed_mps;
  place.is_known = true;
  return place;
}

void SenderList::Open(const TrackList& head, std::span<const SenderTrack> senders) {
  is_open_ = true;
  list_ = head;
  list_.tracks.clear();
  next_ = 0;
  senders_.clear();
  for (const SenderTrack& sender : senders) senders_.push_back(sender.sender);
  std::ranges::sort(senders_);
}

bool SenderList::Continue(const BsmIntake& intake, const V2vPerception& priority,
                          const BiasReport& settled) {
  if (!priority.alignment().is_ready()) senders_.clear();
  const std::size_t end = std::min(next_ + kPiece, senders_.size());
  for (; next_ < end; ++next_) {
    const SenderTrack* sender = intake.Find(senders_[next_]);
    if (sender == nullptr || list_.stamp - sender->latest.received > FromSeconds(kMaxListed_s)) {
      continue;
    }
    list_.tracks.push_back(LineOf(*sender, priority, settled, list_.stamp));
  }
  is_open_ = next_ < senders_.size();
  return !is_open_;
}

}  // namespace v2vouch
