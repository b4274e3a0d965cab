// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/clock_guard.h"

#include <algorithm>

namespace v2vouch {
namespace {

// A source that fell silent for good must not block a restart for ever.
constexpr int kStepsBackThatSuffice = 20;

}  // namespace

ClockGuard::Source& ClockGuard::Find(int id) {
  const auto found = std::find_if(sources_.begin(), sources_.end(),
                                  [id](const Source& source) { return source.id == id; });
  if (found != sources_.end()) return *found;
  return sources_.emplace_back(Source{.id = id});
}

void ClockGuard::Accept(Source& source, Timestamp stamp) {
  newest_ = newest_ ? std::max(*newest_, stamp) : stamp;
  source.ahead.reset();
  for (Source& other : sources_) other.stepped_back = false;
  steps_back_ = 0;
}

ClockGuard::Ruling ClockGuard::Judge(int id, Timestamp stamp) {
  Source& source = Find(id);
  if (!newest_) {
    Accept(source, stamp);
    return Ruling::kAccept;
  }
  const double ahead_s = ToSeconds(stamp - *newest_);
  if (ahead_s > config_.future_s) {
    source.ahead = stamp;
    const bool is_agreed = std::any_of(sources_.begin(), sources_.end(), [&](const Source& other) {
      return other.id != id && other.ahead &&
             std::abs(ToSeconds(stamp - *other.ahead)) <= config_.future_s;
    });
    if (!is_agreed) return Ruling::kTooFarAhead;
    for (Source& other : sources_) other.ahead.reset();
    Accept(source, stamp);
    return Ruling::kAccept;
  }
  if (ahead_s < -config_.reset_s) {
    source.stepped_back = true;
    ++steps_back_;
    const bool all = std::all_of(sources_.begin(), sources_.end(),
                                 [](const Source& other) { return other.stepped_back; });
    if (!all && steps_back_ < kStepsBackThatSuffice)
      return Ruling::kAccept;  // Too old; refused by age.
    sources_.clear();
    newest_.reset();
    Accept(Find(id), stamp);
    return Ruling::kRestart;
  }
  Accept(source, stamp);
  return Ruling::kAccept;
}

}  // namespace v2vouch
