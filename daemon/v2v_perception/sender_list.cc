// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v_perception/sender_list.h"

#include <algorithm>
#include <cmath>
#include <optional>

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

void ListSenders(std::span<const SenderTrack> senders, const V2vPerception& priority,
                 const BiasReport& settled, Timestamp at, std::vector<PublishedTrack>& lines) {
  lines.clear();
  const Alignment& alignment = priority.alignment();
  if (!alignment.is_ready()) return;
  for (const SenderTrack& sender : senders) {
    if (at - sender.latest.received > FromSeconds(kMaxListed_s)) continue;
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
    line.track.extent = {.length_m = claim.length_m.value_or(4.5),
                         .width_m = claim.width_m.value_or(1.8),
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
    lines.push_back(std::move(line));
  }
  std::sort(lines.begin(), lines.end(),
            [](const auto& a, const auto& b) { return a.track.id < b.track.id; });
}

}  // namespace v2vouch
