// SPDX-License-Identifier: Apache-2.0
// The steps of V2vPerception::OnFrame, in their order.
#include <algorithm>

#include "daemon/v2v/perception/claimed_position.h"
#include "daemon/v2v/perception/evidence.h"
#include "daemon/v2v/perception/partial_view.h"
#include "daemon/v2v/perception/v2v_perception.h"
#include "daemon/v2v/perception/vehicle_step.h"

namespace v2vouch {
namespace {

constexpr double kResidualAge_s = 1.0;  // An older residual is no part of the common mode.

}  // namespace

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

}  // namespace v2vouch
