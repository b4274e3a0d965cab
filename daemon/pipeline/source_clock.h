// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "daemon/common/base/notice.h"
#include "daemon/common/base/reason.h"
#include "daemon/common/base/time.h"
#include "daemon/pipeline/timeline_config.h"

namespace v2vouch {

/// What time it is, by what most own sensors agree on. No single source is the
/// clock: one that is ahead, behind, drifting, stuck or the first to be heard costs only itself.
/// Reads the stamps in order of arrival and nothing else, so a log gives the same rulings at any
/// replay speed.
///
/// Each source's newest stamp is its claim. The agreed time T is the weighted median of the claims
/// of all sources that still speak: the newest stamp that more than half of them have reached. Ego
/// motion, which nothing works without, weighs 1.5 times a radar or camera and so breaks ties. A
/// source has stopped speaking when two others (the other one, where there is but one) have moved
/// on by `kSilent_s` of their own time since its last message; so the backlog of one source makes
/// no other source count as silent. Stamps older than the replay buffer count a tenth there, so
/// that neither does the backlog of several.
///
/// T follows the median while that moves by no more than the replay buffer, never backwards.
/// A larger step, or any step back of more than kStepBack_s, needs more than half of the weight of
/// all sources heard within kForgotten_s: then the common clock was set. After a step back, or
/// forward by more than `reset_s`, everything starts again; a shorter step forward is a gap.
///
/// Two sources that disagree give no majority: the clock is then that of ego motion.
class SourceClock {
 public:
  explicit SourceClock(const TimelineConfig& config) : config_(config) {}

  enum class Ruling {
    kAccept,
    kAhead,     ///< Beyond the replay buffer ahead of T, or out of what the others support.
    kBehind,    ///< Older than T less the replay buffer.
    kStuck,     ///< One stamp over and over.
    kOverRate,  ///< More messages in a stretch of message time than any such sensor sends.
  };
  struct Judgement {
    Ruling ruling = Ruling::kAccept;
    bool is_restart = false;  ///< The common clock was set: state before it means nothing now.
  };

  /// An own sensor's or the ego motion's message, which has a say in what time it is.
  Judgement Judge(const NoticeSubject& source, Timestamp stamp);
  /// A GNSS fix or BSM: judged, not asked. Only kAccept or kAhead: what is too old for them depends
  /// on the buffer.
  Ruling JudgeGuest(const NoticeSubject& source, Timestamp stamp);

  /// T; nullopt before the first message.
  [[nodiscard]] std::optional<Timestamp> agreed() const { return agreed_; }
  /// While work is short: frames ahead of T by more than kSupported_s are refused from every
  /// source, because every other frame would have to be put in before them.
  void SetStrict(bool is_strict) { is_strict_ = is_strict; }

  /// Sources whose clock is off, with how far: those that are refused for it, and those that are
  /// taken though they are always more than half a second late (ego motion: a quarter, or ahead).
  void CollectNotices(std::vector<Notice>& notices) const;

  static constexpr double kSilent_s = 0.4;  ///< No say in T from then on.
  /// A source silent for so long, in the same sense, cannot contradict a source that is ahead.
  static constexpr double kRecent_s = 0.15;
  static constexpr double kForgotten_s = 2.0;  ///< No say in steps from then on.
  /// Reordering never puts a row of rising stamps (six of ego motion, three of a sensor) so far
  /// back; shorter steps back of all sources count as reordering.
  static constexpr double kStepBack_s = 0.1;
  /// A frame may be so far ahead of the newest stamp of a quarter of the others.
  static constexpr double kSupported_s = 0.25;
  /// ... if it always is, over this much of its time: reordered messages are not.
  static constexpr double kUnsupportedFor_s = 0.5;
  static constexpr int kMostEqualStamps = 4;  ///< Messages with one stamp; more: stuck.

 private:
  struct Source {
    NoticeSubject subject;
    bool is_guest = false;
    Timestamp claim{};
    double travelled_s = 0.0;                // By its own stamps, without its leaps; old ones less.
    std::vector<double> others_travelled{};  // Theirs, when it spoke last.
    Timestamp newest_accepted{};
    bool has_accepted = false;
    bool is_behind = false;             // When it spoke last: older than the buffer.
    int run_back = 0;                   // Rising stamps in a row well before newest_accepted.
    int equal_stamps = 0;               // Messages in a row that repeat the claim.
    double unsupported_since_s = -1.0;  // On `travelled_s`; < 0: it is supported.
    int run_supported = 0;              // Three in a row take it back.
    bool is_out = false;
    std::vector<Timestamp> taken{};  // Ring of accepted stamps.
    std::size_t next_taken = 0;
    // For notices: rulings in a row of one kind, and how far off the last one was.
    Ruling last = Ruling::kAccept;
    int run = 0;
    int run_late = 0;  // Accepted or not: so late that it is worth telling.
    double off_s = 0.0;
  };

  Source& Find(const NoticeSubject& subject, bool is_guest);
  void Hear(Source& source, Timestamp stamp);
  [[nodiscard]] bool HasSpokenWithin(std::size_t index, double window_s) const;
  [[nodiscard]] std::optional<Timestamp> Median() const;
  template <class Says>
  [[nodiscard]] bool MostAgree(const Says& says) const;
  bool FollowSteps();
  [[nodiscard]] bool IsSupported(const Source& source) const;
  [[nodiscard]] bool IsOut(Source& source);
  bool IsOverRate(Source& source, Timestamp stamp);
  Ruling Rule(Source& source, Timestamp stamp);
  static void Note(Source& source, Ruling ruling, double off_s);
  static std::optional<NoticeKind> NoticeOf(const Source& source);
  void Restart();

  TimelineConfig config_;
  std::optional<Timestamp> agreed_;
  std::vector<Source> sources_;
  bool is_strict_ = false;
};

/// Why a ruling refuses its message; nullopt where it does not.
std::optional<Reason> RefusalOf(SourceClock::Ruling ruling);

}  // namespace v2vouch
