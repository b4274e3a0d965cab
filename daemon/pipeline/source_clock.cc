// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/source_clock.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace v2vouch {
namespace {

// In halves, so that ego motion breaks a tie: one and a half against one.
constexpr int kEgoWeight = 3;
constexpr int kWeight = 2;
// A leap of a source's own stamps is no time that has passed.
constexpr double kLongestStride_s = 0.5;
// What old stamps count as time that has passed: sensors behind one gateway may deliver seconds of
// backlog at once while nobody else speaks. Not nothing, or a step back in which most sources end
// at the same moment would never be taken.
constexpr double kShareOfOldWay = 0.1;
// So many rulings of one kind in a row are a condition, not an accident.
constexpr int kRunThatTells = 3;
// Later than that against the agreed time, ten times in a row, is worth telling: a network's delay
// is less.
constexpr double kLate_s = 0.5;
constexpr double kLateEgo_s = 0.25;
constexpr int kRunOfLate = 10;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
// Rising stamps in a row, well before the newest, that are no reordering any more.
constexpr int kRunBackOfEgo = 6;
constexpr int kRunBack = 3;
// Accepted messages of one source within kRateWindow_s before and after: far above any sensor (200
// Hz of ego motion, 100 Hz of frames), so that only a fault meets it.
constexpr double kRateWindow_s = 0.1;
constexpr std::size_t kMostEgoInWindow = 20;
constexpr std::size_t kMostFramesInWindow = 10;

bool IsEgo(const NoticeSubject& subject) { return subject.kind == NoticeSubject::Kind::kEgoMotion; }

int WeightOf(const NoticeSubject& subject) { return IsEgo(subject) ? kEgoWeight : kWeight; }

}  // namespace

SourceClock::Source& SourceClock::Find(const NoticeSubject& subject, bool is_guest) {
  const auto found = std::ranges::find(sources_, subject, &Source::subject);
  if (found != sources_.end()) return *found;
  sources_.push_back({.subject = subject, .is_guest = is_guest});
  return sources_.back();
}

// Its claim, and how far everybody has come by then.
void SourceClock::Hear(Source& source, Timestamp stamp) {
  source.is_behind = agreed_ && stamp < *agreed_ - FromSeconds(config_.replay_buffer_s);
  if (!source.others_travelled.empty()) {
    source.equal_stamps = stamp == source.claim ? source.equal_stamps + 1 : 0;
    const double way_s = std::clamp(ToSeconds(stamp - source.claim), 0.0, kLongestStride_s);
    source.travelled_s += source.is_behind ? kShareOfOldWay * way_s : way_s;
  }
  const bool is_back = source.has_accepted &&
                       stamp < source.newest_accepted - FromSeconds(kStepBack_s) &&
                       (source.run_back == 0 || stamp > source.claim);
  source.run_back = is_back ? source.run_back + 1 : 0;
  source.claim = stamp;
  source.others_travelled.resize(sources_.size());
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    source.others_travelled[i] = sources_[i].travelled_s;
  }
}

// Whether no two others have moved on by `window_s` since it spoke.
bool SourceClock::HasSpokenWithin(std::size_t index, double window_s) const {
  const Source& source = sources_[index];
  int others = 0;
  int moved_on = 0;
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    if (i == index || sources_[i].is_guest) continue;
    ++others;
    const double then_s = i < source.others_travelled.size() ? source.others_travelled[i] : 0.0;
    if (sources_[i].travelled_s - then_s > window_s) ++moved_on;
  }
  return others == 0 || moved_on < std::min(2, others);
}

// The newest stamp that more than half of the weight of the speaking sources has reached.
std::optional<Timestamp> SourceClock::Median() const {
  std::vector<const Source*> speaking;
  int total = 0;
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    if (sources_[i].is_guest || !HasSpokenWithin(i, kSilent_s)) continue;
    speaking.push_back(&sources_[i]);
    total += WeightOf(sources_[i].subject);
  }
  std::ranges::stable_sort(speaking, std::ranges::greater{}, &Source::claim);
  int weight = 0;
  for (const Source* source : speaking) {
    weight += WeightOf(source->subject);
    if (2 * weight > total) return source->claim;
  }
  return std::nullopt;
}

template <class Says>
bool SourceClock::MostAgree(const Says& says) const {
  int total = 0;
  int agree = 0;
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    if (sources_[i].is_guest || !HasSpokenWithin(i, kForgotten_s)) continue;
    const int weight = WeightOf(sources_[i].subject);
    total += weight;
    if (says(sources_[i])) agree += weight;
  }
  return 2 * agree > total;
}

// @return whether the common clock was set, so that all has to start again.
bool SourceClock::FollowSteps() {
  const auto median = Median();
  if (!median) return false;
  if (!agreed_) {
    agreed_ = median;
    return false;
  }
  const Timestamp before = *agreed_;
  const Timestamp end = before + FromSeconds(config_.replay_buffer_s);
  const auto is_beyond = [end](const Source& source) { return source.claim > end; };
  const auto is_behind = [](const Source& source) { return source.is_behind; };
  const auto went_back = [](const Source& source) {
    return source.run_back >= (IsEgo(source.subject) ? kRunBackOfEgo : kRunBack);
  };
  if (MostAgree(is_behind) || MostAgree(went_back)) {
    agreed_ = median;
    return true;
  }
  if (*median <= before) return false;
  if (*median > end && !MostAgree(is_beyond)) return false;
  agreed_ = median;
  return ToSeconds(*agreed_ - before) > config_.reset_s;
}

// A clock that is right is never ahead of what the others have reached, but by their delays.
bool SourceClock::IsSupported(const Source& source) const {
  int total = 0;
  int support = 0;
  int others = 0;
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const Source& other = sources_[i];
    if (&other == &source || other.is_guest || !HasSpokenWithin(i, kRecent_s)) continue;
    ++others;
    total += WeightOf(other.subject);
    if (other.claim >= source.claim - FromSeconds(kSupported_s)) {
      support += WeightOf(other.subject);
    }
  }
  return others < 2 || 4 * support >= total;
}

// Once it had no support for half a second of its time, until three frames in a row had.
bool SourceClock::IsOut(Source& source) {
  if (IsSupported(source)) {
    source.unsupported_since_s = -1.0;
    if (++source.run_supported >= kRunThatTells) source.is_out = false;
    return source.is_out;
  }
  source.run_supported = 0;
  if (source.unsupported_since_s < 0.0) source.unsupported_since_s = source.travelled_s;
  if (source.travelled_s - source.unsupported_since_s >= kUnsupportedFor_s) source.is_out = true;
  return source.is_out;
}

bool SourceClock::IsOverRate(Source& source, Timestamp stamp) {
  const std::size_t most = IsEgo(source.subject) ? kMostEgoInWindow : kMostFramesInWindow;
  const Duration half = FromSeconds(kRateWindow_s);
  const auto near = std::ranges::count_if(source.taken, [&](Timestamp other) {
    return other >= stamp - half && other <= stamp + half;
  });
  return static_cast<std::size_t>(near) >= most;
}

SourceClock::Ruling SourceClock::Rule(Source& source, Timestamp stamp) {
  if (source.equal_stamps >= kMostEqualStamps) return Ruling::kStuck;
  const Duration buffer = FromSeconds(config_.replay_buffer_s);
  if (stamp > *agreed_ + buffer) return Ruling::kAhead;
  if (stamp < *agreed_ - buffer) return Ruling::kBehind;
  // Nothing works without ego motion, and a sample that is early hurts no frame.
  const bool is_out = IsOut(source);
  if (!IsEgo(source.subject)) {
    if (is_out) return Ruling::kAhead;
    if (is_strict_ && stamp > *agreed_ + FromSeconds(kSupported_s)) return Ruling::kAhead;
  }
  return IsOverRate(source, stamp) ? Ruling::kOverRate : Ruling::kAccept;
}

SourceClock::Judgement SourceClock::Judge(const NoticeSubject& subject, Timestamp stamp) {
  Source& source = Find(subject, false);
  Hear(source, stamp);
  const bool is_restart = FollowSteps();
  if (is_restart) Restart();
  const Ruling ruling = Rule(source, stamp);
  if (ruling == Ruling::kAccept) {
    source.newest_accepted = source.has_accepted ? std::max(source.newest_accepted, stamp) : stamp;
    source.has_accepted = true;
    const std::size_t held = 2 * kMostEgoInWindow;
    if (source.taken.size() < held) {
      source.taken.push_back(stamp);
    } else {
      source.taken[source.next_taken++ % held] = stamp;
    }
  }
  Note(source, ruling, ToSeconds(stamp - *agreed_));
  return {ruling, is_restart};
}

SourceClock::Ruling SourceClock::JudgeGuest(const NoticeSubject& subject, Timestamp stamp) {
  Source& source = Find(subject, true);
  if (!agreed_) return Ruling::kAccept;
  const double off_s = ToSeconds(stamp - *agreed_);
  Ruling ruling = Ruling::kAccept;
  if (off_s > config_.future_s) ruling = Ruling::kAhead;
  if (off_s < -config_.replay_buffer_s) ruling = Ruling::kBehind;
  Note(source, ruling, off_s);
  return ruling == Ruling::kAhead ? Ruling::kAhead : Ruling::kAccept;
}

void SourceClock::Note(Source& source, Ruling ruling, double off_s) {
  source.run = ruling == source.last ? source.run + 1 : 1;
  source.last = ruling;
  source.off_s = off_s;
  const double late_s = IsEgo(source.subject) ? kLateEgo_s : kLate_s;
  source.run_late = off_s < -late_s ? source.run_late + 1 : 0;
}

// Claims stand, or the sources that have not spoken yet would be asked as if they agreed.
void SourceClock::Restart() {
  for (Source& source : sources_) {
    source.has_accepted = false;
    source.run_back = 0;
    source.is_behind = false;
    source.taken.clear();
    source.next_taken = 0;
    source.is_out = false;
    source.unsupported_since_s = -1.0;
  }
}

std::optional<NoticeKind> SourceClock::NoticeOf(const Source& source) {
  if (source.run >= kRunThatTells) {
    switch (source.last) {
      case Ruling::kAhead:
        return NoticeKind::kClockAhead;
      case Ruling::kBehind:
        return NoticeKind::kClockBehind;
      case Ruling::kStuck:
        return NoticeKind::kClockStuck;
      case Ruling::kOverRate:
        return NoticeKind::kOverRate;
      case Ruling::kAccept:
        break;
    }
  }
  if (source.run_late >= kRunOfLate) return NoticeKind::kClockBehind;
  if (source.is_out) return NoticeKind::kClockAhead;
  return std::nullopt;
}

void SourceClock::CollectNotices(std::vector<Notice>& notices) const {
  for (const Source& source : sources_) {
    const auto kind = NoticeOf(source);
    if (!kind) continue;
    const bool is_ahead = *kind == NoticeKind::kClockAhead;
    const double off_s = is_ahead ? source.off_s : std::abs(source.off_s);
    notices.push_back({*kind, source.subject, *kind == NoticeKind::kOverRate ? kNaN : off_s});
  }
}

std::optional<Reason> RefusalOf(SourceClock::Ruling ruling) {
  switch (ruling) {
    case SourceClock::Ruling::kAccept:
      return std::nullopt;
    case SourceClock::Ruling::kAhead:
      return Reason::kFutureStamp;
    case SourceClock::Ruling::kBehind:
      return Reason::kTooOld;
    case SourceClock::Ruling::kStuck:
      return Reason::kStuckStamp;
    case SourceClock::Ruling::kOverRate:
      return Reason::kOverRate;
  }
  return std::nullopt;
}

}  // namespace v2vouch
