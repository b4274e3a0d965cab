// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "daemon/alignment/alignment.h"
#include "daemon/association/height_offset.h"
#include "daemon/association/height_track.h"
#include "daemon/association/pair_table.h"
#include "daemon/association/paper_list.h"
#include "daemon/base/notice.h"
#include "daemon/base/scratch.h"
#include "daemon/data/bias.h"
#include "daemon/data/claim.h"
#include "daemon/data/outputs.h"
#include "daemon/data/track.h"
#include "daemon/pipeline/priority_config.h"
#include "daemon/priority/priority_vehicle.h"
#include "daemon/trust/claimed_place.h"
#include "daemon/trust/common_mode.h"
#include "daemon/trust/sender_trust.h"
#include "daemon/trust/shared_place.h"
#include "daemon/trust/tombstones.h"
#include "daemon/trust/trust_memory.h"
#include "daemon/visibility/visibility.h"

namespace v2vouch {

/// The rolled-back V2V part: alignment, association, trust, and the PRIORITY vehicles.
///
/// A vehicle enters PRIORITY when a sender is VALIDATED on a LOCAL track that the sensors alone are
/// sure of. It stays while
///   - the sensors see it and its sender has spoken within bridge.max_silence_s (a vehicle whose
///     radio falls silent is LOCAL's alone again, under LOCAL's rules), or
///   - it is bridged: hidden, its sender speaks at least every bridge.max_gap_s, budget is left,
///     the position is certain to bridge.max_sigma_m and inside the reachable set of the
///     sensor-only coast, and the place is not in clear view and empty.
/// A bridge that merely ends leaves no blame; a contradiction withdraws the sender (SUSPECT).
/// V2V alone creates nothing: without a LOCAL track there is no vehicle.
///
/// Every sender within reach is judged, validated or not: by its message stream (Claim::finding),
/// by what the sensors see at its place (ClaimedPlace), by its residuals to the LOCAL track it is
/// taken for. Penalties and doubts outlive the identity (Tombstones).
///
/// While the alignment is suspect nobody is validated or accused; claims are still used, through
/// the frozen alignment. While all senders are off in the same way (CommonMode) that shift counts
/// as our own: nobody is accused, and a sender is judged by what is left of its residual.
///
/// Copyable: a copy is a checkpoint. Bounded by max_senders and max_pairs. Events must come in
/// order of time; the same events give the same bits.
class PriorityPerception {
 public:
  PriorityPerception(const PriorityConfig& config, const AlignmentConfig& alignment,
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
  [[nodiscard]] TrustState TrustOf(SenderId sender) const;
  [[nodiscard]] bool IsFollowed(SenderId sender) const { return FindLink(sender) != nullptr; }
  /// The ego's place is in doubt: its GNSS has jumped, or all senders are off alike.
  [[nodiscard]] bool is_ego_gnss_suspect() const {
    return alignment_.is_suspect() || IsShifted(sensed_stamp_);
  }
  /// Appends what the heights say of the ego's receiver.
  void CollectNotices(std::vector<Notice>& notices) const;
  /// Bias of a validated sender; nullopt: nothing learnt. Axes east and north.
  [[nodiscard]] std::optional<BiasEstimate> BiasOf(SenderId sender) const;
  /// Raw sensor-confirmed residuals of the last event, at most one.
  std::vector<BiasResidual> TakeResiduals();
  /// What of the trust in senders outlives a restart; ages as of `now`. See TrustMemory.
  [[nodiscard]] std::vector<TrustMemory> TrustToKeep(Timestamp now) const;
  /// Before the first event: what an earlier run kept.
  void RestoreTrust(std::vector<TrustMemory> memories) {
    restored_ = RestoredTrust(std::move(memories));
  }
  [[nodiscard]] std::size_t vehicle_count() const { return vehicles_.size(); }
  /// Bytes that a copy of this state takes, heap included; what a checkpoint costs.
  [[nodiscard]] std::size_t checkpoint_bytes() const;

 private:
  // Where a vehicle may stand or drive unseen, just before or behind a LOCAL track.
  struct UnseenNeighbours {
    std::uint64_t track_id = 0;
    std::array<std::optional<Eigen::Vector2d>, 2> offsets_O;  // From the track's centre.
  };
  // One sender near a track.
  struct Link {
    SenderId sender = 0;
    CertificateDigest certificate{};
    SenderTrust trust;
    ClaimInOdometry last;  // Of those with a place of use.
    bool has_last = false;
    std::optional<double> length_m;  // As claimed.
    std::optional<double> width_m;
    ClaimedPlace place;
    SharedPlace shared;
    UnseenNeighbours unseen;         // Of the LOCAL track that it may be.
    std::uint64_t withdrawn_id = 0;  // LOCAL track it was relied on with when it was withdrawn.
    std::uint64_t compared_id = 0;   // LOCAL track of the last residual; 0 = none.
    int breaks = 0;                  // Above 0: its messages lately did not continue each other.
    int odd_claims = 0;              // In a row that are not where the sensors see the sender.
    HeightTrack heights;
    std::optional<Timestamp> heights_at;  // Of the last message.
    // Beside the ego's height when last heard: the difference to be expected at its place is from
    // `least` to `most`, less what is common to all.
    std::optional<double> height_difference_m;
    double least_difference_m = 0.0;
    double most_difference_m = 0.0;
    double agreed_m = 0.0;  // Way for which a LOCAL track agreed with it, whatever its height.
    std::optional<BiasEstimate> prior_en;
    std::uint64_t heir_of = 0;  // Vehicle it may continue under this new id; 0 = none.
    int heir_claims = 0;
  };
  // Looks that had but a part of a LOCAL track.
  struct PartialLooks {
    std::uint64_t track_id = 0;
    Timestamp last{};                // The last of them ...
    std::optional<Timestamp> whole;  // ... and the first look since then that had it whole.
  };
  // A LOCAL track as of the newest frame.
  struct Sensed {
    LocalTrack track;      // Known by a part only: with more doubt than LOCAL itself has.
    bool is_sure = false;  // The sensors alone are sure enough for PRIORITY.
    bool is_hit = false;   // Given a measurement in that frame.
    std::optional<PartialLooks> parts{};
    bool is_partial = false;   // A part of it was seen so lately that it may mislead.
    bool is_doubtful = false;  // ... and since then it has not been seen whole for long enough.
  };
  static constexpr double kOnePlace_m = 2.0;       // Centres of two vehicles are never so close.
  static constexpr double kStandingReach_m = 2.0;  // Standing returns so near may be a vehicle.
  static bool IsRecent(const Link& link, Timestamp now);
  struct Settings {
    PriorityConfig priority;
    VehicleConfig vehicle;
  };

  Link* FindLink(SenderId sender);
  [[nodiscard]] const Link* FindLink(SenderId sender) const;
  Link* FollowSender(const Claim& claim, const ClaimInOdometry& here, const EgoState& ego);
  bool TakeTurn(Timestamp now);
  bool MakeRoom(bool for_penalised);
  [[nodiscard]] const Sensed* FindSensed(std::uint64_t local_id) const;
  PriorityVehicle* VehicleOf(SenderId sender);
  [[nodiscard]] bool IsHeld(std::uint64_t local_id) const;
  // Another sender's vehicle in the same place: one that the sensors support, or one that is
  // bridged.
  [[nodiscard]] bool HasAnotherAt(const Eigen::Vector2d& p_O, SenderId but,
                                  bool is_supported) const;
  [[nodiscard]] bool IsHeldByAnother(std::uint64_t local_id, SenderId sender) const;
  [[nodiscard]] bool IsAnothers(std::uint64_t local_id, SenderId sender) const;
  [[nodiscard]] bool IsShifted(Timestamp now) const;
  [[nodiscard]] bool MayAccuse(Timestamp now) const {
    return !alignment_.is_suspect() && !IsShifted(now);
  }
  [[nodiscard]] std::optional<BiasPrior> PriorOf(const Link& link) const;

  // Frame.
  void Remember(const LocalFrame& frame, const VisibilityMap& map);
  [[nodiscard]] std::optional<Occluder> ExpectedFootprint(const LocalTrack& track,
                                                          Timestamp stamp) const;
  void StepVehicle(PriorityVehicle& vehicle, const LocalFrame& frame, const VisibilityMap& map,
                   Outputs& outputs);
  void TakeSensorUpdates(PriorityVehicle& vehicle, const Sensed& sensed, const LocalFrame& frame);
  void LookForReturn(PriorityVehicle& vehicle, Timestamp stamp);
  // Seen again within the last half second, where its sender says.
  [[nodiscard]] bool IsReturning(const PriorityVehicle& vehicle, Timestamp stamp) const;
  [[nodiscard]] bool IsWhereClaimed(const LocalTrack& track, const PriorityVehicle& vehicle,
                                    Timestamp stamp) const;
  std::optional<Finding> Contradiction(PriorityVehicle& vehicle, Timestamp stamp) const;
  void LookAtPlace(PriorityVehicle& vehicle, const LocalFrame& frame, const VisibilityMap& map);

  // Looks at senders that no sensor vouches for, after each frame.
  void LookAtClaims(const LocalFrame& frame, const VisibilityMap& map, Outputs& outputs);
  [[nodiscard]] std::array<ClaimedPlace::Look, ClaimedPlace::kPlaces> LookAround(
      const Link& link, const LocalFrame& frame, const VisibilityMap& map) const;
  [[nodiscard]] bool IsVouchedFor(const Link& link) const;
  [[nodiscard]] bool IsPlaceShared(const Link& link, Timestamp now) const;
  [[nodiscard]] bool IsOnAnotherLevel(const Link& link) const;
  // The vehicle that the sender says it is, at a place.
  static Occluder ClaimedFootprint(const Link& link, const Eigen::Vector2d& centre_O,
                                   double yaw_rad);
  [[nodiscard]] UnseenNeighbours LookBeside(const Link& link, const LocalFrame& frame,
                                            const VisibilityMap& map) const;
  [[nodiscard]] static double MarginOverUnseen(const Link& link, const PairTable::Pair& pair);
  void JudgeCommonMode(Timestamp now);

  // Heights.
  void FollowHeight(Link& link, const Claim& claim, const ClaimInOdometry& here,
                    const EgoState& ego);
  void CountAgreement(Link& link, const ClaimInOdometry& here, double moved_m);
  void JudgeHeights(Timestamp now);

  // Claim.
  bool IsSomebodyElses(Link& link, const PriorityVehicle* vehicle, const ClaimInOdometry& here);
  void JudgeMessages(Link& link, const PriorityVehicle* vehicle, const Claim& claim,
                     const ClaimInOdometry& here);
  [[nodiscard]] std::optional<KinematicState> SensedAt(std::uint64_t local_id,
                                                       Timestamp stamp) const;
  void ObservePairs(Link& link, const ClaimInOdometry& here);
  PriorityVehicle* Inherit(Link& link, const ClaimInOdometry& here, Outputs& outputs);
  void CompareWithSensors(Link& link, PriorityVehicle* vehicle, const ClaimInOdometry& here);
  void UseClaim(Link& link, PriorityVehicle& vehicle, const ClaimInOdometry& here);
  void UseMotion(Link& link, PriorityVehicle& vehicle, const ClaimInOdometry& here);
  void CountMisfits(PriorityVehicle& vehicle, bool fits, bool place_fits, double since_last_s,
                    Timestamp stamp);
  void KeepWithinReach(Link& link, PriorityVehicle& vehicle, Timestamp stamp);
  void TryValidate(Link& link, const ClaimInOdometry& here);

  void EndVehicle(PriorityVehicle& vehicle, Timestamp stamp);
  void Report(Link& link, Timestamp stamp, Outputs& outputs);
  void DropEnded();

  std::shared_ptr<const Settings> settings_;
  Alignment alignment_;
  HeightTrack ego_heights_;
  std::optional<Eigen::Vector2d> ego_heights_at_;  // Place of the last fix.
  HeightOffset height_offset_;
  std::vector<Link> links_;  // By sender.
  double turns_ = 0.0;       // Newcomers that may take another's place.
  std::optional<Timestamp> turns_refilled_;
  std::vector<Sensed> sensed_;  // By LOCAL id; all tracks of the newest frame.
  Timestamp sensed_stamp_{};
  Scratch<std::vector<SenderResidual>> residual_means_;
  Scratch<std::vector<PartialLooks>> parts_;
  PairTable pairs_;
  PairTable pairs_apart_;  // Of senders on another level: they neither take tracks nor rival.
  Scratch<std::vector<HeightWitness>> witnesses_;
  std::vector<PriorityVehicle> vehicles_;  // By id; id 0 = ended in this step.
  Tombstones tombstones_;
  RestoredTrust restored_;  // Of senders not heard since the start.
  CommonMode common_;
  std::optional<Timestamp> shifted_;  // When all senders were last off alike.
  PaperList paper_;
  std::vector<BiasResidual> residuals_;
};

}  // namespace v2vouch
