// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "daemon/v2v/perception/v2v_view.h"
#include "daemon/v2v/trust/common_mode.h"

namespace v2vouch {

/// Whose fault a finding would be, at this moment.
struct EgoDoubt {
  bool is_suspect = false;  ///< The ego's GNSS has jumped: no validation, no accusation.
  bool is_shifted = false;  ///< All senders are off alike (common mode): no accusation.
  [[nodiscard]] bool may_accuse() const { return !is_suspect && !is_shifted; }
};

/// A claim far from where the sensors see its sender, between others that fit: an id that two
/// devices use. The vehicle goes on by the claims that fit; a lasting departure is the sender's
/// own. Counts such claims in the record.
bool IsFromAnotherDevice(const V2vView& view, SenderRecord& record, const PriorityVehicle* vehicle,
                         const ClaimInOdometry& here);

/// Whether a claim continues the sender's last one: the position where the last would have it now,
/// and a speed that it can have reached. True for a first claim and for one without a position.
bool ContinuesLastClaim(const SenderRecord& record, const Claim& claim,
                        const ClaimInOdometry& here);

/// Judges the message by itself and by the one before. Jumps in the message stream do not count
/// where the sensors see the vehicle just where this claim has it: another device may speak under
/// the id. Claimed speed and heading do count.
void JudgeMessage(SenderRecord& record, const PriorityVehicle* vehicle, const Claim& claim,
                  const ClaimInOdometry& here, bool may_accuse, const TrustConfig& config);

/// A claim beside the LOCAL track that its sender is taken for.
struct Comparison {
  bool is_made = false;  ///< False: there is no such track; hidden vehicles have none.
  /// Sender and track have come apart without blame: the track has switched to another object, or
  /// had only a part of the vehicle. The sender starts from zero.
  bool is_track_switch = false;
  Eigen::Vector2d residual_O = Eigen::Vector2d::Zero();    ///< Claimed minus sensed, raw [m].
  Eigen::Matrix2d covariance_O = Eigen::Matrix2d::Zero();  ///< Of both together [m^2].
};

/// Takes the raw residual and lets the sender's trust judge it.
Comparison CompareWithSensors(const V2vView& view, SenderRecord& record,
                              const PriorityVehicle* vehicle, const ClaimInOdometry& here,
                              const CommonMode& common, const EgoDoubt& doubt);

/// Whether a LOCAL track agrees with the sender, well enough for validation, were heights left out.
bool AgreesButForHeight(const V2vView& view, const PairTable::Pair& pair, Timestamp now);

/// A PRIORITY vehicle where all evidence for the sender is there; nullopt: not yet. Changes the
/// sender's trust where it is. @param yaw_sigma_rad of the alignment.
std::optional<PriorityVehicle> Validate(const V2vView& view, SenderRecord& record,
                                        const ClaimInOdometry& here, bool is_ego_suspect,
                                        double yaw_sigma_rad);

}  // namespace v2vouch
