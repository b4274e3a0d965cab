// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "daemon/common/base/notice.h"
#include "daemon/common/base/result.h"
#include "daemon/common/base/visit.h"
#include "daemon/common/data/claim.h"
#include "daemon/common/data/input.h"
#include "daemon/common/data/track.h"
#include "daemon/common/geodesy/ecef.h"
#include "daemon/v2v/intake/accuracy_watch.h"
#include "daemon/v2v/intake/direction_reading.h"
#include "daemon/v2v/intake/knock_memory.h"
#include "daemon/v2v/intake/message_check_config.h"
#include "daemon/v2v/intake/repeat_memory.h"
#include "daemon/v2v/intake/sender_checks.h"
#include "daemon/v2v/intake/utc_watch.h"

namespace v2vouch {

struct IntakeConfig {
  int max_senders = 2048;
  double max_rate_hz = 12.0;  ///< Sustained messages per sender; bursts of `burst`.
  double burst = 10.0;
  double max_total_rate_hz = 15000.0;
  int max_new_senders_per_s = 64;  ///< New identities admitted per second.
  double max_age_s = 1.5;          ///< Older content is refused.
  double max_future_s = 0.3;
  double default_age_s = 0.15;     ///< Where neither generation time nor secMark is there.
  double max_distance_m = 1000.0;  ///< Farther senders are of no use.
  double repeat_memory_s = 120.0;  ///< How long a message is remembered against replay.
  double own_echo_m = 2.0;         ///< A sender this close to our own place and course is us.
  double sender_timeout_s = 5.0;
  double min_position_sigma_m = 0.5;  ///< Reported accuracy is clamped to this range.
  double max_position_sigma_m = 3.0;
  double usable_position_sigma_m = 6.0;  ///< A worse reported position is neither used nor judged.
  double unknown_position_sigma_m = 2.0;
  bool message_verdicts = false;  ///< Report of every message what became of it.
  std::uint32_t own_id = 0;       ///< Our own TemporaryID where fixed; 0 = unknown.
  MessageCheckConfig checks{};

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
    a.Field("usable_position_sigma_m", usable_position_sigma_m, {.above = 0.0, .at_most = 20.0});
    a.Field("unknown_position_sigma_m", unknown_position_sigma_m, {.above = 0.0, .at_most = 20.0});
    a.Field("message_verdicts", message_verdicts);
    a.Field("checks", checks);
  }
};

/// Where the ego believes to be, for the own-echo and distance checks. Its height does not matter.
struct EgoPlace {
  Eigen::Vector3d p_E = Eigen::Vector3d::Zero();  ///< Centre of the ego's footprint.
  Eigen::Vector3d course_E = Eigen::Vector3d::UnitX();
  double speed_mps = 0.0;
  bool is_known = false;
};

/// One sender as heard. Function of its own messages alone (never of the ego), so it is never
/// rolled back. A sender without a height is at 0; compare positions with HorizontalDistance.
/// State lives in a plane anchored where the sender was first heard, moved along every 2 km.
struct SenderTrack {
  SenderId sender = 0;
  Claim latest;
  LocalPlane plane{Wgs84{}};
  KinematicState state;  ///< CTRA over the claims, in its own plane, at latest.received.
  Eigen::Vector3d p_E = Eigen::Vector3d::Zero();        ///< Filtered position at latest.received.
  Eigen::Vector3d course_E = Eigen::Vector3d::UnitX();  ///< Filtered direction.
  std::uint64_t messages = 0;
  Timestamp first_received{};
  double clean_run = 0.0;  ///< Consecutive messages consistent with the sender's own motion.
  double nis_mean =
      0.0;  ///< Of the last ten or so messages; 4 where consistent (3 without course).
  /// Of the latest message; none where its motion started anew for a jump or a silence.
  std::optional<double> latest_nis;
  int nis_freedom = 4;          ///< Of latest_nis.
  std::uint64_t resets = 0;     ///< Restarts of the motion: jumps, long silences.
  std::uint64_t lost = 0;       ///< Messages missing by msgCnt.
  std::uint64_t over_rate = 0;  ///< Messages refused because the sender speaks too often.
  int msg_count = 0;            ///< Of the latest message.
  /// The same core data was heard under another id too; which is the copy is not known.
  std::uint64_t contested = 0;
  std::optional<Timestamp> last_contested;
};

/// Takes BSMs in. A function of the BSM stream alone but for the ego's place. In this order,
/// cheapest first, each refusal with its reason:
///
/// - invalid signature: kBsmSignature; position or speed unavailable: kBsmUnavailable; not finite:
///   kNotFinite; speed over 70 m/s, acceleration over 12 m/s^2, lateral over 9: kBsmImplausible
/// - age of the content (ClaimedAge): kBsmStale, kBsmFuture
/// - ego's place unknown: kNoGnss; our own message: kBsmOwnEcho; too far: kBsmImplausible
/// - heard before (same id, msgCnt, secMark, place): kBsmRepeat
/// - rates, of the sender and of all: kBsmRate. Once half of the total budget is spent, only known
///   senders are served
/// - new identities beyond their budget, or no room: kBsmTableFull. Once half of that budget is
///   spent a new id is admitted only with its second message within 2 s (KnockMemory), so that a
///   flood of identities that speak once does not keep others out; once the table is half full, the
///   budget binds. A full table evicts the sender unheard for longest, never a protected one, never
///   one heard in the last second
///
/// An accepted claim carries the gravest that the sender's own messages have against it
/// (SenderChecks), refused ones included.
///
/// Cost O(log senders), a fixed filter step and fixed checks; no allocation after construction.
class BsmIntake {
 public:
  explicit BsmIntake(const IntakeConfig& config);

  /// The claim, or why there is none. BSMs come in order of reception.
  Result<Claim> Accept(const Bsm& bsm, const EgoPlace& ego);

  /// Drops senders not heard for the timeout. Cheap to call with every message: it looks twice a
  /// second of `now`.
  void Expire(Timestamp now);

  /// A protected sender is never evicted from a full table while it is heard. No-op when unknown.
  void Pin(SenderId sender, bool is_pinned);

  /// Ordered by sender id.
  [[nodiscard]] std::span<const SenderTrack> senders() const { return senders_; }
  [[nodiscard]] const SenderTrack* Find(SenderId sender) const;

  /// Appends what the senders' time says of this car's clock (UtcWatch).
  void CollectNotices(std::vector<Notice>& notices) const;

 private:
  // Kept beside senders_, same order: what the checks need, small enough to search fast.
  struct Account {
    SenderId sender = 0;
    bool is_pinned = false;
    std::uint32_t slot = 0;  // Of checks_, directions_ and accuracies_.
    double tokens = 0.0;
    Timestamp last{};
  };

  [[nodiscard]] std::size_t IndexOf(SenderId sender) const;
  [[nodiscard]] bool Holds(std::size_t index, SenderId sender) const;
  [[nodiscard]] std::optional<Reason> MakeRoom(SenderId newcomer, Timestamp now);
  void RefillTokens(Timestamp now);
  [[nodiscard]] std::optional<Reason> TakeKnown(std::size_t index, const Bsm& bsm, Claim& claim);
  [[nodiscard]] std::optional<Reason> TakeNew(const Bsm& bsm, Claim& claim);
  void Remove(std::size_t index);
  void Contest(std::uint16_t id_tag, std::size_t copy);

  IntakeConfig config_;
  std::vector<SenderTrack> senders_;
  std::vector<Account> accounts_;
  std::vector<SenderChecks> checks_;  // By slot: they stay where they are when senders come and go.
  std::vector<DirectionReading> directions_;  // By slot too.
  std::vector<AccuracyWatch> accuracies_;     // By slot too.
  std::vector<std::uint32_t> free_slots_;
  RepeatMemory repeats_;
  KnockMemory knocks_;
  UtcWatch utc_;
  double total_tokens_ = 0.0;
  double new_tokens_ = 0.0;
  std::optional<Timestamp> refilled_;
  std::optional<Timestamp> swept_;
};

}  // namespace v2vouch
