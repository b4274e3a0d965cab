// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "daemon/base/result.h"
#include "daemon/base/visit.h"
#include "daemon/data/claim.h"
#include "daemon/data/input.h"
#include "daemon/data/track.h"
#include "daemon/models/ctra.h"

namespace v2vouch {

struct IntakeConfig {
  int max_senders = 2048;
  double max_rate_hz = 12.0;            ///< Sustained messages per sender; bursts of `burst`.
  double burst = 10.0;
  double max_total_rate_hz = 15000.0;
  int max_new_senders_per_s = 64;       ///< New identities admitted per second once half full.
  double max_age_s = 1.5;               ///< Older content is refused.
  double max_future_s = 0.3;
  double default_age_s = 0.15;          ///< Where neither generation time nor secMark is there.
  double max_distance_m = 1000.0;       ///< Farther senders are of no use.
  double repeat_memory_s = 120.0;       ///< How long a message is remembered against replay.
  double own_echo_m = 2.0;              ///< A sender this close to our own place and course is us.
  double sender_timeout_s = 5.0;
  double min_position_sigma_m = 0.5;    ///< Reported accuracy is clamped to this range.
  double max_position_sigma_m = 3.0;
  double unknown_position_sigma_m = 2.0;
  std::uint32_t own_id = 0;             ///< Our own TemporaryID where fixed; 0 = unknown.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("max_senders", max_senders, {.at_least = 16, .at_most = 65536});
    a.Field("max_rate_hz", max_rate_hz, {.above = 0.5, .at_most = 1000.0});
    a.Field("burst", burst, {.at_least = 1.0, .at_most = 1000.0});
    a.Field("max_total_rate_hz", max_total_rate_hz, {.above = 1.0, .at_most = 1e6});
    a.Field("max_new_senders_per_s", max_new_senders_per_s, {.at_least = 1, .at_most = 10000});
    a.Field("max_age_s", max_age_s, {.above = 0.1, .at_most = 10.0});
    a.Field("max_future_s", max_future_s, {.at_least = 0.0, .at_most = 5.0});
    a.Field("default_age_s", default_age_s, {.at_least = 0.0, .at_most = 1.0});
    a.Field("max_distance_m", max_distance_m, {.above = 10.0, .at_most = 10000.0});
    a.Field("repeat_memory_s", repeat_memory_s, {.at_least = 1.0, .at_most = 600.0});
    a.Field("own_echo_m", own_echo_m, {.at_least = 0.0, .at_most = 10.0});
    a.Field("sender_timeout_s", sender_timeout_s, {.above = 0.5, .at_most = 60.0});
    a.Field("min_position_sigma_m", min_position_sigma_m, {.above = 0.0, .at_most = 10.0});
    a.Field("max_position_sigma_m", max_position_sigma_m, {.above = 0.0, .at_most = 20.0});
    a.Field("unknown_position_sigma_m", unknown_position_sigma_m, {.above = 0.0, .at_most = 20.0});
  }
};

/// Where the ego believes to be, for the own-echo and distance checks.
struct EgoPlace {
  Eigen::Vector3d p_E = Eigen::Vector3d::Zero();  ///< Centre of the ego's footprint.
  Eigen::Vector3d course_E = Eigen::Vector3d::UnitX();
  double speed_mps = 0.0;
  bool is_known = false;
};

/// One sender as heard. Function of its own messages alone (never of the ego), so it is never
/// rolled back. State lives in a plane anchored where the sender was first heard.
struct SenderTrack {
  SenderId sender = 0;
  Claim latest;
  KinematicState state;       ///< CTRA over the claims, in its own plane, at latest.received.
  Eigen::Vector3d p_E = Eigen::Vector3d::Zero();       ///< Filtered position at latest.received.
  Eigen::Vector3d course_E = Eigen::Vector3d::UnitX(); ///< Filtered direction.
  std::uint64_t messages = 0;
  Timestamp first_received{};
  double clean_run = 0.0;     ///< Consecutive messages consistent with the sender's own motion.
};

/// Takes BSMs in: J2735 range and plausibility checks, freshness, own echo, repeats (temporary id,
/// msgCnt, secMark and place), per-sender and total rate, bounded sender table (DESIGN 5.6,
/// notes/spoofing.md C1-C4). A function of the BSM stream alone but for the ego's place.
class BsmIntake {
 public:
  explicit BsmIntake(const IntakeConfig& config);

  /// The claim, or why there is none. Cost O(1), no allocation in the steady state.
  Result<Claim> Accept(const Bsm& bsm, const EgoPlace& ego);

  /// Drops senders not heard for the timeout.
  void Expire(Timestamp now);

  /// Ordered by sender id.
  [[nodiscard]] std::span<const SenderTrack> senders() const { return senders_; }
  [[nodiscard]] const SenderTrack* Find(SenderId sender) const;

 private:
  IntakeConfig config_;
  std::vector<SenderTrack> senders_;
};

}  // namespace v2vouch
