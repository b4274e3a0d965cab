// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "daemon/common/base/notice.h"
#include "daemon/common/base/scratch.h"
#include "daemon/common/data/bias.h"
#include "daemon/common/data/claim.h"
#include "daemon/common/data/outputs.h"
#include "daemon/local/visibility/visibility.h"
#include "daemon/v2v/alignment/alignment.h"
#include "daemon/v2v/association/paper_list.h"
#include "daemon/v2v/perception/claim_judgement.h"
#include "daemon/v2v/perception/priority_config.h"
#include "daemon/v2v/perception/sender_pairs.h"
#include "daemon/v2v/perception/track_snapshots.h"
#include "daemon/v2v/perception/v2v_view.h"
#include "daemon/v2v/perception/vehicle_action.h"
#include "daemon/v2v/priority/priority_list.h"
#include "daemon/v2v/senders/height_judge.h"
#include "daemon/v2v/senders/sender_table.h"
#include "daemon/v2v/trust/common_mode.h"

namespace v2vouch {

/// The paper's V2V recipe, made safe: alignment, association, trust, and the PRIORITY list.
///
/// A vehicle enters PRIORITY when a sender is VALIDATED on a LOCAL track that the sensors alone are
/// sure of. It stays while
///   - the sensors see it and its sender has spoken within bridge.max_silence_s (a vehicle whose
///     radio falls silent is LOCAL's alone again, under LOCAL's rules), or
///   - it is bridged: hidden, its sender speaks at least every bridge.max_gap_s, budget is left,
///     the position is certain to bridge.max_sigma_m and inside the reachable set of the
///     sensor-only coast, and the position is not in clear view and empty.
/// A bridge that merely ends leaves no blame; a contradiction withdraws the sender (SUSPECT).
/// V2V alone creates nothing: without a LOCAL track there is no vehicle.
///
/// Every sender within reach is judged, validated or not: by its message stream (Claim::finding),
/// by what the sensors see at its claimed position, by its residuals to the LOCAL track it is taken
/// for. Penalties and doubts outlive the identity (tombstones).
///
/// While the alignment is suspect no sender is validated or accused; claims are still used, through
/// the frozen alignment. While all senders are off in the same way (common mode) that shift counts
/// as our own: no sender is accused, and each is judged by what is left of its residual.
///
/// State and its owners: TrackSnapshots (what the sensors know), SenderTable (one record per
/// sender), SenderPairs (which sender may be which track), PriorityList (the vehicles),
/// HeightJudge, CommonModeMonitor, Alignment. Judgements are functions of a V2vView of them.
///
/// Copyable: a copy is a checkpoint. Bounded by max_senders and max_pairs. Events must come in
/// order of time; the same events give the same bits.
class V2vPerception {
 public:
  V2vPerception(const PriorityConfig& config, const AlignmentConfig& alignment,
                const VehicleConfig& vehicle);

  /// @param ego at alignment().FixTime(fix).
  void OnFix(const GnssFix& fix, const EgoState& ego, Outputs& outputs);
  /// After each own-sensor frame. `map` is the visibility of that frame.
  void OnFrame(const LocalFrame& frame, const VisibilityMap& map, Outputs& outputs);
  /// Each accepted BSM, in order of reception. `ego` at its reception.
  void OnClaim(const Claim& claim, const EgoState& ego, Outputs& outputs);
  /// What the settled bias estimate says of a sender: prior of pairs that start from now on.
  void SetBiasPrior(SenderId sender, const BiasEstimate& estimate);

  /// Appends the PRIORITY tracks predicted to `at`, ordered by id.
  void Publish(Timestamp at, const EgoState& ego_at, TrackList& priority) const;

  [[nodiscard]] const Alignment& alignment() const { return alignment_; }
  [[nodiscard]] TrustState TrustOf(SenderId sender) const { return senders_.TrustOf(sender); }
  [[nodiscard]] bool IsFollowed(SenderId sender) const { return senders_.Find(sender) != nullptr; }
  /// The ego's place is in doubt: its GNSS has jumped, or all senders are off alike.
  [[nodiscard]] bool is_ego_gnss_suspect() const { return !DoubtAt(tracks_.stamp()).may_accuse(); }
  /// Appends what the heights say of the ego's receiver.
  void CollectNotices(std::vector<Notice>& notices) const { heights_.CollectNotices(notices); }
  /// Bias of a validated sender; nullopt: nothing learnt. Axes east and north.
  [[nodiscard]] std::optional<BiasEstimate> BiasOf(SenderId sender) const;
  /// Raw sensor-confirmed residuals of the last event, at most one.
  std::vector<BiasResidual> TakeResiduals() { return std::exchange(residuals_, {}); }
  /// What of the trust in senders outlives a restart; ages as of `now`. See TrustMemory.
  [[nodiscard]] std::vector<TrustMemory> TrustToKeep(Timestamp now) const;
  /// Before the first event: what an earlier run kept.
  void RestoreTrust(std::vector<TrustMemory> memories) {
    senders_.RestoreTrust(std::move(memories));
  }
  [[nodiscard]] std::size_t vehicle_count() const { return list_.vehicles().size(); }
  /// Bytes that a copy of this state takes, heap included; what a checkpoint costs.
  [[nodiscard]] std::size_t checkpoint_bytes() const;

 private:
  struct Settings {
    PriorityConfig priority;
    VehicleConfig vehicle;
  };

  [[nodiscard]] V2vView View() const;
  [[nodiscard]] EgoDoubt DoubtAt(Timestamp now) const;
  [[nodiscard]] bool IsOnAnotherLevel(const SenderRecord& record) const;
  [[nodiscard]] SenderHolds HoldingOf(SenderId sender) const;

  // A frame, in this order.
  void RememberTracks(const LocalFrame& frame, const VisibilityMap& map);
  void StepVehicles(const LocalFrame& frame, const VisibilityMap& map, Outputs& outputs);
  void JudgeClaimedPositions(const LocalFrame& frame, const VisibilityMap& map, Outputs& outputs);
  void JudgeCommonMode(Timestamp now);
  void JudgeHeights(Timestamp now);
  void Forget(Timestamp now);

  // A claim, in this order.
  SenderRecord* FollowSender(const Claim& claim, const ClaimInOdometry& here, const EgoState& ego);
  [[nodiscard]] bool IsOfInterest(const ClaimInOdometry& here, const EgoState& ego) const;
  void FollowHeight(SenderRecord& record, const Claim& claim, const ClaimInOdometry& here,
                    const EgoState& ego);
  void ObservePairs(const SenderRecord& record, const ClaimInOdometry& here);
  PriorityVehicle* TakeOver(SenderRecord& record, const ClaimInOdometry& here, Outputs& outputs);
  void Compare(SenderRecord& record, PriorityVehicle* vehicle, const ClaimInOdometry& here);
  void UsePosition(SenderRecord& record, PriorityVehicle* vehicle, const ClaimInOdometry& here);

  void Act(const VehicleAction& action, PriorityVehicle& vehicle, SenderRecord& record,
           Timestamp stamp);
  void EndVehicle(PriorityVehicle& vehicle, Timestamp stamp);
  void ReportVerdict(SenderRecord& record, Timestamp stamp, Outputs& outputs);

  std::shared_ptr<const Settings> settings_;
  Alignment alignment_;
  TrackSnapshots tracks_;
  SenderTable senders_;
  SenderPairs pairs_;
  PriorityList list_;
  HeightJudge heights_;
  CommonModeMonitor common_;
  PaperList paper_;
  std::vector<BiasResidual> residuals_;
  Scratch<std::vector<SenderResidual>> residual_means_;
};

}  // namespace v2vouch
