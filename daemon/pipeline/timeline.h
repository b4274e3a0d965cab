// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "daemon/common/data/bias.h"
#include "daemon/common/data/claim.h"
#include "daemon/common/data/outputs.h"
#include "daemon/local/perception/local_perception.h"
#include "daemon/pipeline/perception_config.h"
#include "daemon/v2v/perception/v2v_perception.h"

namespace v2vouch {

/// Place of an event in the one total order: time of measurement (of reception for a BSM), then
/// kind of source, channel (sender of a BSM) and sequence number.
struct EventKey {
  Timestamp time{};
  int rank = 0;
  std::int64_t channel = 0;
  std::int64_t seq = 0;
  friend auto operator<=>(const EventKey&, const EventKey&) = default;
};

/// An accepted BSM with what the settled bias estimate said of its sender when it arrived.
struct TimedClaim {
  Claim claim;
  std::int64_t seq = 0;
  std::optional<BiasEstimate> bias;
};

using TimelineInput =
    std::variant<EgoMotion, GnssFix, RadarScan, CameraDetections, ObjectList, TimedClaim>;

EventKey KeyOf(const TimelineInput& input);

/// Puts every event in its place. An event later than all before it is stepped at once; an earlier
/// one restores the state after the last frame before its place and re-runs what came since, not
/// one frame more: LOCAL and then the V2V side when it is an own sensor's, the V2V side alone when
/// it is a GNSS fix or a claim. Any order of arrival within the replay buffer ends in the same
/// state, bit for bit.
///
/// Late claims are put in their places at once, but the V2V side is re-run for all of them
/// together, with the next frame or fix: a flood that comes a little late would else cost one
/// re-run, of all claims since, for each of its messages. Until then priority() is without them.
class Timeline {
 public:
  explicit Timeline(const PerceptionConfig& config);

  struct Placement {
    std::optional<Reason> refusal;  ///< Why it was not taken, or is of no use; nullopt: it is.
    bool has_frame = false;         ///< It was a frame, and LOCAL could use it.
    bool is_correction = false;     ///< A frame that later frames of LOCAL had to be re-run for.
    int local_frames = 0;  ///< Frames that LOCAL was stepped through for it, itself included.
    int v2v_events = 0;    ///< Frames, fixes and claims that the V2V side was stepped through.
  };

  /// Refusals and reports go to `outputs` once per event, however often it is re-run. What is taken
  /// of LOCAL's inputs depends on LOCAL's inputs alone.
  ///
  /// Late data may cause `rerun_budget` frames of LOCAL to be run again per second of agreed time;
  /// beyond it late inputs of LOCAL's are refused (kOverBudget). What is not late is always taken.
  /// @param agreed what time it is (SourceClock); what is older than the buffer is refused.
  Placement Insert(TimelineInput input, Timestamp agreed, Outputs& outputs);
  /// The budget is nearly spent.
  [[nodiscard]] bool is_short_of_work() const {
    return budget_ < 0.5 * config_.timeline.rerun_budget;
  }

  [[nodiscard]] const LocalPerception& local() const { return local_; }
  [[nodiscard]] const V2vPerception& priority() const { return priority_; }
  /// The newest frame in order of time; nullptr before the first.
  [[nodiscard]] const LocalFrame* newest_frame() const;
  /// Newest time of any frame or claim.
  [[nodiscard]] Timestamp newest_time() const { return newest_; }

  /// Before the first event: what an earlier run kept of the trust in senders.
  void RestoreTrust(std::vector<TrustMemory> memories) {
    priority_.RestoreTrust(std::move(memories));
    before_->priority = priority_;
  }

  /// Residuals of events that have left the buffer since the last call; they will not change.
  std::vector<BiasResidual> TakeSettled();
  /// Everything up to here is settled.
  [[nodiscard]] Timestamp settled() const { return settled_; }

 private:
  // The state after an event, and what LOCAL made of that event where it is a frame.
  struct Checkpoint {
    LocalPerception local;
    V2vPerception priority;
    LocalFrame frame{};
    RadarPreparation radar{};
  };
  struct Event {
    EventKey key;
    TimelineInput input;
    std::optional<Reason> refusal;  // Why it was of no use in the latest run.
    bool has_frame = false;
    std::unique_ptr<Checkpoint> after;   // Every frame has one; of the others few.
    std::vector<std::uint64_t> emitted;  // Diagnostics that have left already, by hash.
    std::vector<BiasResidual> residuals;
  };

  // A verdict that has left.
  struct Reported {
    Timestamp stamp{};
    SenderId sender = 0;
    Verdict verdict = Verdict::kWithdraw;
  };

  std::unique_ptr<Event> NewEvent(TimelineInput input);
  std::unique_ptr<Checkpoint> NewCheckpoint();
  void Recycle(std::unique_ptr<Checkpoint> checkpoint);
  [[nodiscard]] std::optional<Reason> WhyNot(const TimelineInput& input) const;
  void AdvanceTo(Timestamp agreed);
  [[nodiscard]] bool IsAffordable(const TimelineInput& input);
  [[nodiscard]] bool NeedsCheckpoint(const TimelineInput& input) const;
  /// Both from event `from` to the newest. @return the number of frames / V2V events stepped.
  int RunLocal(std::size_t from, Outputs& outputs);
  int RunPriority(std::size_t from, Outputs& outputs);
  /// A late claim so far back among so many others that it is not worth running them again.
  [[nodiscard]] bool IsTooDeep(const EventKey& claim) const;
  /// Whether the V2V side may wait with event `place`, which was just put in.
  [[nodiscard]] bool MayWait(std::size_t place, bool is_last) const;
  /// First event behind the last checkpoint before event `at`; and the state there.
  [[nodiscard]] std::size_t Restart(std::size_t at) const;
  [[nodiscard]] const Checkpoint& StateAt(std::size_t at) const;
  /// Sets the V2V side back so that event `place` and all that wait can be run. @return from where.
  std::size_t RestorePriority(std::size_t place, bool is_last);
  void EmitOnce(Event& event, const Outputs& step, Outputs& outputs);
  void Trim();

  PerceptionConfig config_;
  LocalPerception local_;
  V2vPerception priority_;
  std::deque<std::unique_ptr<Event>> events_;  // Ordered by key.
  std::size_t settled_events_ = 0;             // The first of them; kept for the next checkpoint.
  std::unique_ptr<Checkpoint> before_;         // The state before the first event.
  // Kept for their allocations: no more than are in use, so that a flood's are given back.
  std::vector<std::unique_ptr<Event>> spare_events_;
  std::vector<std::unique_ptr<Checkpoint>> spare_checkpoints_;
  std::size_t checkpoints_ = 0;  // In events_.
  std::vector<BiasResidual> settled_residuals_;
  std::vector<Reported> reported_;   // Of the buffer's time.
  bool has_local_ = false;           // An input LOCAL reads was taken.
  std::optional<Timestamp> agreed_;  // Never goes back.
  double budget_ = 0.0;              // Frames that may still be run again.
  Timestamp newest_{};               // Of any frame or claim.
  Timestamp settled_{};
  std::optional<EventKey> waiting_;  // The oldest claim that the V2V side has not been run for.
  int waiting_claims_ = 0;
  Outputs step_;
};

}  // namespace v2vouch
