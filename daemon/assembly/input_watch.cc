// SPDX-License-Identifier: Apache-2.0
#include "daemon/assembly/input_watch.h"

#include <algorithm>

#include "daemon/data/input.h"

namespace v2vouch {
namespace {

// A larger step is a sender that started again, not a loss.
constexpr std::int64_t kLargestGap = 100'000;
constexpr double kPeriodsUntilSilent = 3.0;

bool IsOwnSensor(wire::InputKind kind) {
  return kind != wire::InputKind::kGnss && kind != wire::InputKind::kBsm;
}

}  // namespace

InputWatch::InputWatch(std::span<const wire::InputChannel> channels) {
  for (const wire::InputChannel& channel : channels) inputs_.push_back({.channel = channel});
}

void InputWatch::Received(std::size_t channel) { ++inputs_[channel].received; }

void InputWatch::Accepted(std::size_t channel, Timestamp stamp, std::int64_t seq) {
  Watched& input = inputs_[channel];
  ++accepted_;
  ++input.accepted;
  if (input.seq && seq > *input.seq) {
    const std::int64_t missing = seq - *input.seq - 1;
    if (missing <= kLargestGap) input.gaps += missing;
  } else if (input.seq && seq < *input.seq && input.gaps > 0 && *input.seq - seq <= kLargestGap) {
    --input.gaps;  // Late, not lost.
  }
  const bool started_again = input.seq && *input.seq - seq > kLargestGap;
  input.seq = input.seq && !started_again ? std::max(*input.seq, seq) : seq;
  input.newest = input.newest ? std::max(*input.newest, stamp) : stamp;
  if (IsOwnSensor(input.channel.kind)) {
    newest_own_ = newest_own_ ? std::max(*newest_own_, stamp) : stamp;
  }
}

void InputWatch::Restart() {
  newest_own_.reset();
  last_report_.reset();
  for (Watched& input : inputs_) {
    input.seq.reset();
    input.newest.reset();
  }
}

void InputWatch::Report(std::vector<wire::InputStatus>& reports) {
  reports.clear();
  const double elapsed_s =
      newest_own_ && last_report_ ? ToSeconds(*newest_own_ - *last_report_) : 0.0;
  for (Watched& input : inputs_) {
    wire::InputStatus report;
    report.channel = input.channel.name;
    report.received = input.received;
    report.accepted = input.accepted;
    report.gaps = input.gaps;
    const auto since = static_cast<double>(input.accepted - input.reported);
    report.rate_hz = elapsed_s > 0.0 ? since / elapsed_s : 0.0;
    input.reported = input.accepted;
    report.age_s = input.newest && newest_own_ ? ToSeconds(*newest_own_ - *input.newest) : kNaN;
    const double limit_s = kPeriodsUntilSilent * input.channel.period_s;
    report.is_silent = limit_s > 0.0 && !(report.age_s <= limit_s);
    reports.push_back(report);
  }
  last_report_ = newest_own_;
}

}  // namespace v2vouch
