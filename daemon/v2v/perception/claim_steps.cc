// SPDX-License-Identifier: Apache-2.0
// The steps of V2vPerception::OnClaim, in their order.
#include <algorithm>
#include <cmath>

#include "daemon/v2v/perception/bridge_claim.h"
#include "daemon/v2v/perception/claimed_position.h"
#include "daemon/v2v/perception/evidence.h"
#include "daemon/v2v/perception/pseudonym_change.h"
#include "daemon/v2v/perception/v2v_perception.h"

namespace v2vouch {
namespace {

// Way of agreement that is counted for a sender; the vote about heights needs far less.
constexpr double kMostAgreed_m = 1000.0;

}  // namespace

bool V2vPerception::IsOfInterest(const ClaimInOdometry& here, const EgoState& ego) const {
  const PriorityConfig& config = settings_->priority;
  const auto is_near = [&](const Eigen::Vector2d& p_O) {
    return (p_O - here.p_O).squaredNorm() < config.interest_m * config.interest_m;
  };
  const double distance_m = (ego.X_OB.origin().vector() - here.p_O).norm();
  return distance_m < config.trust.place.max_distance_m ||
         std::ranges::any_of(tracks_.tracks(),
                             [&](const TrackSnapshot& snapshot) {
                               return is_near(snapshot.track.state_O.mean.head<2>());
                             }) ||
         std::ranges::any_of(list_.vehicles(), [&](const PriorityVehicle& vehicle) {
           return is_near(vehicle.filter.mean().head<2>());
         });
}

SenderRecord* V2vPerception::FollowSender(const Claim& claim, const ClaimInOdometry& here,
                                          const EgoState& ego) {
  const PriorityConfig& config = settings_->priority;
  SenderRecord* record = senders_.Find(claim.sender);
  if (record == nullptr) {
    if (claim.accuracy_is_poor || !IsOfInterest(here, ego)) return nullptr;
    const SenderLimits limits{static_cast<std::size_t>(config.max_senders), config.turnover_hz};
    const auto admission = senders_.Admit(claim, here, limits, config.trust.tombstone,
                                          [this](SenderId id) { return HoldingOf(id); });
    if (admission.evicted) pairs_.Drop(*admission.evicted);
    if (admission.record == nullptr) return nullptr;
    record = admission.record;
  }
  record->first_heard = claim.first_heard;
  record->length_m = claim.length_m;
  record->width_m = claim.width_m;
  record->certificate = claim.certificate;
  return record;
}

void V2vPerception::FollowHeight(SenderRecord& record, const Claim& claim,
                                 const ClaimInOdometry& here, const EgoState& ego) {
  const double moved_m = std::abs(heights_.OnClaim(record, claim, here, ego));
  const PairTable::Pair* pair = pairs_.AssignedTo(record.sender);
  double& agreed_m = record.height.agreed_m;
  if (pair == nullptr || record.trust.has_penalty() ||
      IsAnothers(View(), pair->track_id, record.sender)) {
    agreed_m = 0.0;
  } else if (AgreesButForHeight(View(), *pair, here.stamp)) {
    agreed_m = std::min(agreed_m + moved_m, kMostAgreed_m);
  }
}

void V2vPerception::ObservePairs(const SenderRecord& record, const ClaimInOdometry& here) {
  const PriorityConfig& config = settings_->priority;
  std::optional<BiasPrior> prior;
  if (record.prior_en) {
    const Eigen::Matrix2d R_OL = alignment_.X_LO().rotation().transpose();
    prior = BiasPrior{R_OL * record.prior_en->mean_en,
                      R_OL * record.prior_en->covariance * R_OL.transpose()};
  }
  pairs_.Observe(record, here, IsOnAnotherLevel(record), tracks_, prior, config);
}

// The vehicle that a sender without one goes on with: its own, which an intruder had taken over, or
// that of its former pseudonym.
PriorityVehicle* V2vPerception::TakeOver(SenderRecord& record, const ClaimInOdometry& here,
                                         Outputs& outputs) {
  const PriorityConfig& config = settings_->priority;
  const double contest_s = config.identity_change.contest_s;
  while (PriorityVehicle* vehicle =
             FindContested(list_, record.sender, here.stamp, config.identity_change)) {
    vehicle->predecessor.reset();
    SenderRecord* intruder = senders_.Find(vehicle->sender);
    if (intruder == nullptr) continue;
    record.trust.InheritFrom(intruder->trust);
    vehicle->sender = record.sender;
    pairs_.SetIncumbent(intruder->sender, std::nullopt);
    pairs_.SetIncumbent(record.sender, vehicle->local_id);
    intruder->trust.OnFinding(here.stamp,
                              {Check::kContestedIdentity, Verdict::kWithdraw, "silence_s",
                               ToSeconds(here.stamp - vehicle->handover), contest_s},
                              DoubtAt(here.stamp).may_accuse());
    ReportVerdict(*intruder, here.stamp, outputs);
    return vehicle;
  }
  PriorityVehicle* continued = FindContinued(list_, record, here, config);
  if (continued == nullptr) return nullptr;
  const SenderId successor = record.sender;
  const SenderId old = continued->sender;
  if (const SenderRecord* old_record = senders_.Find(old)) {
    record.trust.InheritFrom(old_record->trust);
  }
  continued->predecessor = old;
  continued->handover = here.stamp;
  continued->sender = successor;
  pairs_.DropFromLevel(old);
  pairs_.SetIncumbent(successor, continued->local_id);
  senders_.Remove(old);
  return continued;
}

void V2vPerception::Compare(SenderRecord& record, PriorityVehicle* vehicle,
                            const ClaimInOdometry& here) {
  const EgoDoubt doubt = DoubtAt(here.stamp);
  const Comparison comparison =
      CompareWithSensors(View(), record, vehicle, here, common_.mode(), doubt);
  if (!comparison.is_made) return;
  if (comparison.is_track_switch) {
    pairs_.DropFromLevel(record.sender);
    record.withdrawn_id = 0;
    if (vehicle != nullptr) EndVehicle(*vehicle, here.stamp);
    return;
  }
  if (vehicle == nullptr || !record.trust.is_relied_on() || doubt.is_suspect) return;
  const Eigen::Matrix2d R_LO = alignment_.X_LO().rotation();
  residuals_.push_back({record.sender, here.stamp, R_LO * comparison.residual_O,
                        R_LO * comparison.covariance_O * R_LO.transpose()});
  alignment_.Vouch(here.stamp);
}

void V2vPerception::UsePosition(SenderRecord& record, PriorityVehicle* vehicle,
                                const ClaimInOdometry& here) {
  const PriorityConfig& config = settings_->priority;
  if (vehicle == nullptr) {
    const double yaw_sigma_rad = std::sqrt(alignment_.covariance()(2, 2));
    if (const auto validated =
            Validate(View(), record, here, alignment_.is_suspect(), yaw_sigma_rad)) {
      pairs_.SetIncumbent(record.sender, validated->local_id);
      list_.Add(*validated);
    }
  } else if (!vehicle->has_ended()) {
    Act(UseClaim(record, *vehicle, here, config), *vehicle, record, here.stamp);
  }
  record.last = here;
  record.has_last = true;
}

}  // namespace v2vouch
