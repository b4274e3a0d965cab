// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/perception/v2v_perception.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "daemon/common/geodesy/ecef.h"
#include "daemon/v2v/perception/bridge_claim.h"
#include "daemon/v2v/perception/claimed_position.h"
#include "daemon/v2v/perception/evidence.h"
#include "daemon/v2v/perception/partial_view.h"
#include "daemon/v2v/perception/pseudonym_change.h"
#include "daemon/v2v/perception/vehicle_step.h"
#include "daemon/v2v/trust/report.h"

namespace v2vouch {
namespace {

// Ego GNSS moving the alignment by more than this at once changes every residual; no sender's
// doing.
constexpr double kAlignmentStep_m = 2.0;
constexpr double kPairReach_m = 20.0;   // No claim, however poor, starts a pair from farther away.
constexpr double kResidualAge_s = 1.0;  // An older residual is no part of the common mode.
constexpr double kMostAgreed_m = 1000.0;

}  // namespace

V2vPerception::V2vPerception(const PriorityConfig& config, const AlignmentConfig& alignment,
                             const VehicleConfig& vehicle)
    : settings_(std::make_shared<const Settings>(Settings{config, vehicle})),
      alignment_(alignment, vehicle) {}

void V2vPerception::OnFix(const GnssFix& fix, const EgoState& ego, Outputs& outputs) {
  const bool was_ready = alignment_.is_ready();
  const Point<Odometry> here = ego.X_OB.origin();
  const Wgs84 before = was_ready ? alignment_.ToGeodetic(here.vector(), 0.0) : Wgs84{};
  if (const auto refusal = alignment_.OnFix(fix, ego)) {
    return outputs.Refuse(*refusal, fix.stamp);
  }
  if (!alignment_.is_ready()) return;
  heights_.OnFix(fix, ego);
  if (!was_ready) return;
  const Wgs84 after = alignment_.ToGeodetic(here.vector(), 0.0);
  if ((ToEcef(after).p_E - ToEcef(before).p_E).norm() < kAlignmentStep_m) return;
  // The alignment has moved under all senders at once: what was learnt of them starts again from
  // the priors, and no sender is blamed.
  const PriorityFilterConfig& filter = settings_->priority.filter;
  const Eigen::Matrix2d prior =
      filter.bias_sigma_m * filter.bias_sigma_m * Eigen::Matrix2d::Identity();
  for (PriorityVehicle& vehicle : list_.vehicles()) {
    vehicle.filter.ResetErrors(prior + alignment_.CovarianceAt(here.vector()), filter);
  }
  for (SenderRecord& record : senders_.records()) {
    record.trust.ForgetResiduals();
    record.has_last = false;
  }
}

void V2vPerception::OnFrame(const LocalFrame& frame, const VisibilityMap& map, Outputs& outputs) {
  const PriorityConfig& config = settings_->priority;
  if (config.association == AssociationMode::kPaper) {
    return paper_.OnFrame(frame.stamp, frame.tracks, config.paper);
  }
  senders_.OnEvent(frame.stamp);
  RememberTracks(frame, map);
  StepVehicles(frame, map, outputs);
  JudgeClaimedPositions(frame, map, outputs);
  JudgeCommonMode(frame.stamp);
  JudgeHeights(frame.stamp);
  Forget(frame.stamp);
}

void V2vPerception::OnClaim(const Claim& claim, const EgoState& ego, Outputs& outputs) {
  const PriorityConfig& config = settings_->priority;
  if (!alignment_.is_ready()) return outputs.Refuse(Reason::kNoGnss, claim.received);
  const ClaimInOdometry here = alignment_.ToOdometry(claim, claim.received);
  if (config.association == AssociationMode::kPaper) return paper_.OnClaim(here, config.paper);

  SenderRecord* record = FollowSender(claim, here, ego);
  if (record == nullptr) return;
  PriorityVehicle* vehicle = list_.Of(record->sender);
  FollowHeight(*record, claim, here, ego);
  const bool has_position = !claim.accuracy_is_poor;
  if (has_position && IsFromAnotherDevice(View(), *record, vehicle, here)) {
    return outputs.Refuse(Reason::kBsmContradicted, claim.received);
  }
  JudgeMessage(*record, vehicle, claim, here, DoubtAt(here.stamp).may_accuse(), config.trust);
  if (has_position) {
    ObservePairs(*record, here);
    if (vehicle == nullptr) vehicle = TakeOver(*record, here, outputs);
    record = senders_.Find(claim.sender);  // TakeOver may have moved it.
    Compare(*record, vehicle, here);
    UsePosition(*record, vehicle, here);
  } else if (vehicle != nullptr) {
    Act(UseMotion(*record, *vehicle, here, config), *vehicle, *record, here.stamp);
  }
  senders_.UpdateTombstone(*record);
  ReportVerdict(*record, here.stamp, outputs);
  list_.DropEnded();
}

void V2vPerception::SetBiasPrior(SenderId sender, const BiasEstimate& estimate) {
  if (SenderRecord* record = senders_.Find(sender)) record->prior_en = estimate;
}

std::optional<BiasEstimate> V2vPerception::BiasOf(SenderId sender) const {
  const PriorityVehicle* vehicle = list_.Of(sender);
  if (vehicle == nullptr || !alignment_.is_ready()) return std::nullopt;
  const Eigen::Matrix2d R_LO = alignment_.X_LO().rotation();
  return BiasEstimate{R_LO * vehicle->filter.bias(),
                      R_LO * vehicle->filter.bias_covariance() * R_LO.transpose()};
}

std::vector<TrustMemory> V2vPerception::TrustToKeep(Timestamp now) const {
  return senders_.TrustToKeep(now, settings_->priority.trust.again_s);
}

std::size_t V2vPerception::checkpoint_bytes() const {
  return sizeof(*this) + senders_.records().size_bytes() + tracks_.tracks().size_bytes() +
         pairs_.size_bytes() + list_.vehicles().size_bytes() + paper_.entries().size_bytes();
}

V2vView V2vPerception::View() const {
  return {settings_->priority, settings_->vehicle, tracks_, senders_, pairs_.on_level(), list_};
}

EgoDoubt V2vPerception::DoubtAt(Timestamp now) const {
  return {alignment_.is_suspect(), common_.IsShifted(now, settings_->priority.trust.common_mode)};
}

bool V2vPerception::IsOnAnotherLevel(const SenderRecord& record) const {
  return heights_.IsOnAnotherLevel(record, settings_->priority.safe.max_height_difference_m);
}

SenderHolds V2vPerception::HoldingOf(SenderId sender) const {
  if (list_.Of(sender) != nullptr) return SenderHolds::kVehicle;
  return pairs_.on_level().AssignedTo(sender) != nullptr ? SenderHolds::kTrack
                                                         : SenderHolds::kNothing;
}

void V2vPerception::RememberTracks(const LocalFrame& frame, const VisibilityMap& map) {
  const PriorityConfig& config = settings_->priority;
  tracks_.Begin(frame.stamp);
  for (const LocalTrack& track : frame.tracks) {
    if (!track.is_confirmed) continue;
    // Coverage is asked for tracks that a sender may be; the question is not cheap.
    const bool has_pair = pairs_.HasTrack(track.id);
    const auto expected = ExpectedFootprint(View(), track, frame.stamp);
    tracks_.Add(track, {.is_sure = has_pair && AreSensorsSure(track, frame, map, settings_->vehicle,
                                                              config.sensor_support),
                        .is_hit = track.support.IsHitAt(frame.stamp) ||
                                  std::ranges::find(frame.updates, track.id,
                                                    &SensorUpdate::track_id) != frame.updates.end(),
                        .is_partial = IsPartiallyObserved(View(), track, expected, frame, map)});
  }
}

void V2vPerception::StepVehicles(const LocalFrame& frame, const VisibilityMap& map,
                                 Outputs& outputs) {
  for (PriorityVehicle& vehicle : list_.vehicles()) {
    SenderRecord* record = senders_.Find(vehicle.sender);
    if (record == nullptr) {
      EndVehicle(vehicle, frame.stamp);
      continue;
    }
    const VehicleStep step = StepVehicle(View(), vehicle, frame, map);
    if (step.is_lost) record->trust.OnSensorsLost();
    if (step.has_reappeared) {
      pairs_.SetIncumbent(vehicle.sender, vehicle.local_id);
      record->trust.OnSensorsRegained();
    }
    if (step.has_failed_numerics) outputs.Refuse(Reason::kTrackNumerics, frame.stamp);
    Act(step.action, vehicle, *record, frame.stamp);
    if (step.action.kind == VehicleAction::Kind::kBlame) {
      ReportVerdict(*record, frame.stamp, outputs);
    }
  }
  list_.DropEnded();
}

void V2vPerception::JudgeClaimedPositions(const LocalFrame& frame, const VisibilityMap& map,
                                          Outputs& outputs) {
  const TrustConfig& config = settings_->priority.trust;
  const bool may_accuse = DoubtAt(frame.stamp).may_accuse();
  for (SenderRecord& record : senders_.records()) {
    const PriorityVehicle* vehicle = list_.Of(record.sender);
    if (vehicle != nullptr && vehicle->is_supported) {
      record.place.OnVouched();
      continue;
    }
    if (!record.IsRecent(frame.stamp) || IsOnAnotherLevel(record)) continue;
    if (!record.trust.is_relied_on()) {
      record.shared.OnLook(frame.stamp, IsPositionShared(View(), record, frame.stamp));
      if (const auto finding = record.shared.Judge(config.shared_place)) {
        record.trust.OnFinding(frame.stamp, *finding, false);
        ReportVerdict(record, frame.stamp, outputs);
      }
    }
    if (!record.place.IsDue(frame.stamp, config.place)) continue;
    if (IsSeenBySensors(View(), record)) {
      record.place.OnVouched();
      if (record.trust.is_relied_on()) continue;
      record.unseen = FindUnseenNeighbours(View(), record, frame, map);
      continue;
    }
    record.place.OnLook(frame.stamp, ObserveClaimedPosition(View(), record, frame, map),
                        config.place);
    if (const auto finding = record.place.Judge(config.accuse_hold_s, config.place)) {
      record.trust.OnFinding(frame.stamp, *finding, may_accuse);
      ReportVerdict(record, frame.stamp, outputs);
    }
  }
  list_.DropEnded();
}

void V2vPerception::JudgeCommonMode(Timestamp now) {
  residual_means_.clear();
  for (const SenderRecord& record : senders_.records()) {
    const ResidualHistory& history = record.trust.history();
    if (!history.is_settled() || ToSeconds(now - history.last()) > kResidualAge_s) continue;
    residual_means_.push_back({record.sender, history.mean_O()});
  }
  common_.Judge(residual_means_, now, settings_->priority.trust.common_mode);
}

void V2vPerception::JudgeHeights(Timestamp now) {
  const AssociationConfig& config = settings_->priority.safe;
  if (!heights_.Judge(senders_.records(), now, config.max_height_difference_m)) return;
  // Senders that are on our level now are matched with what was observed of them all the while.
  for (const SenderRecord& record : senders_.records()) {
    if (!IsOnAnotherLevel(record)) pairs_.BringToLevel(record.sender, config);
  }
  pairs_.Assign(config);
}

void V2vPerception::Forget(Timestamp now) {
  const PriorityConfig& config = settings_->priority;
  pairs_.Expire(now, config.safe);
  senders_.DropSilent(now, config.contact_s, [this](SenderId id) { return HoldingOf(id); });
}

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
  pairs_.Observe(here, IsOnAnotherLevel(record), tracks_, prior, config.safe, config.filter.motion);
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

void V2vPerception::Act(const VehicleAction& action, PriorityVehicle& vehicle, SenderRecord& record,
                        Timestamp stamp) {
  switch (action.kind) {
    case VehicleAction::Kind::kGoOn:
      return;
    case VehicleAction::Kind::kEnd:
      return EndVehicle(vehicle, stamp);
    case VehicleAction::Kind::kBlame:
      return record.trust.OnFinding(stamp, action.finding, DoubtAt(stamp).may_accuse());
  }
}

void V2vPerception::EndVehicle(PriorityVehicle& vehicle, Timestamp stamp) {
  vehicle.id = 0;
  pairs_.SetIncumbent(vehicle.sender, std::nullopt);
  if (SenderRecord* record = senders_.Find(vehicle.sender)) record->trust.Release(stamp);
}

void V2vPerception::ReportVerdict(SenderRecord& record, Timestamp stamp, Outputs& outputs) {
  const auto judgement = record.trust.TakeVerdict();
  if (!judgement) return;
  outputs.reports.push_back(ReportOf(*judgement, record.sender, record.certificate, stamp));
  if (PriorityVehicle* vehicle = list_.Of(record.sender)) {
    record.withdrawn_id = vehicle->local_id;
    EndVehicle(*vehicle, stamp);
  }
}

void V2vPerception::Publish(Timestamp at, const EgoState& ego_at, TrackList& priority) const {
  const PriorityConfig& config = settings_->priority;
  priority.ego_gnss_suspect = is_ego_gnss_suspect();
  const bool has_place = alignment_.is_ready();
  const double height_m = has_place ? alignment_.EgoGeodetic(ego_at).height_m : 0.0;
  const auto add = [&](PublishedTrack line) {
    if (has_place) {
      line.position = alignment_.ToGeodetic(line.track.state_O.mean.head<2>(), height_m);
    }
    priority.tracks.push_back(std::move(line));
  };
  for (const PaperList::Entry& entry : paper_.entries()) {
    PublishedTrack line;
    line.track = entry.track;
    line.track.id = entry.id;
    if (at > entry.stamp) {
      PredictCtra(line.track.state_O, ToSeconds(at - entry.stamp), config.filter.motion);
    }
    line.local_id = entry.local_id;
    line.last_v2v = entry.last_v2v;
    line.sender = entry.sender;
    add(std::move(line));
  }
  for (const PriorityVehicle& vehicle : list_.vehicles()) {
    PublishedTrack line = LineOf(vehicle, at, config.filter, config.bridge);
    line.trust = TrustOf(vehicle.sender);
    if (const auto bias = BiasOf(vehicle.sender)) {
      line.bias_east_m = bias->mean_en.x();
      line.bias_north_m = bias->mean_en.y();
    }
    add(std::move(line));
  }
}

}  // namespace v2vouch
