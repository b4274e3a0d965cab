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
