// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/engine/input_watch.h"

#include <algorithm>

#include "daemon/common/data/input.h"

namespace v2vouch {
namespace {

// A larger step is a sender that started again, not a loss.
constexpr std::int64_t kLargestGap = 100'000;
constexpr double kPeriodsUntilSilent = 3.0;
// Silence worth a notice.
constexpr double kPeriodsUntilNotice = 5.0;
constexpr double kNoticeAtLeast_s = 1.0;

std::optional<NoticeSubject> SubjectOf(const wire::InputChannel& channel) {
  const auto index = static_cast<std::uint32_t>(channel.sensor);
  switch (channel.kind) {
    case wire::InputKind::kRadar:
      return NoticeSubject{NoticeSubject::Kind::kRadar, index};
    case wire::InputKind::kCameraBoxes:
    case wire::InputKind::kCameraImage:
      return NoticeSubject{NoticeSubject::Kind::kCamera, index};
    case wire::InputKind::kObjects:
      return NoticeSubject{NoticeSubject::Kind::kObjects, index};
    case wire::InputKind::kEgoMotion:
      return NoticeSubject{NoticeSubject::Kind::kEgoMotion, 0};
    case wire::InputKind::kGnss:
      return NoticeSubject{NoticeSubject::Kind::kGnss, 0};
    case wire::InputKind::kBsm:  // BSMs are optional.
    case wire::InputKind::kOwnBsm:
      break;
  }
  return std::nullopt;
}

}  // namespace

InputWatch::InputWatch(std::span<const wire::InputChannel> channels) {
  for (const wire::InputChannel& channel : channels) inputs_.push_back({.channel = channel});
}

void InputWatch::AdvanceTo(Timestamp at) {
  if (last_arrival_) {
    elapsed_ += std::clamp(at - *last_arrival_, Duration::zero(), FromSeconds(kLongestLeap_s));
  }
  last_arrival_ = at;
}

void InputWatch::Received(std::size_t channel, Timestamp at) {
  AdvanceTo(at);
  ++inputs_[channel].received;
  inputs_[channel].last_heard = elapsed_;
}

void InputWatch::Accepted(std::size_t channel, Timestamp stamp, std::int64_t seq) {
  Watched& input = inputs_[channel];
  ++accepted_;
  ++input.accepted;
  if (input.newest && stamp <= *input.newest) {
    // Late, not lost.
    if (input.gaps > 0 && input.seq && seq < *input.seq) --input.gaps;
    return;
  }
  // A counter that goes down while time goes on has started again, or counts modulo something.
  if (input.seq && seq > *input.seq) {
    const std::int64_t missing = seq - *input.seq - 1;
    if (missing <= kLargestGap) input.gaps += missing;
  }
  input.seq = seq;
  input.newest = stamp;
}

void InputWatch::Restart() {
  for (Watched& input : inputs_) {
    input.seq.reset();
    input.newest.reset();
  }
}

void InputWatch::Report(std::vector<wire::InputStatus>& reports) {
  reports.clear();
  const double passed_s = last_report_ ? ToSeconds(elapsed_ - *last_report_) : 0.0;
  for (Watched& input : inputs_) {
    if (input.channel.is_optional() && input.received == 0) continue;
    wire::InputStatus report;
    report.channel = input.channel.name;
    report.received = input.received;
    report.accepted = input.accepted;
    report.gaps = input.gaps;
    const auto since = static_cast<double>(input.accepted - input.reported);
    report.rate_hz = passed_s > 0.0 ? since / passed_s : 0.0;
    input.reported = input.accepted;
    report.age_s = input.last_heard ? ToSeconds(elapsed_ - *input.last_heard) : kNaN;
    const double limit_s = kPeriodsUntilSilent * input.channel.period_s;
    report.is_silent = limit_s > 0.0 && !(report.age_s <= limit_s);
    reports.push_back(report);
  }
  last_report_ = elapsed_;
}

void InputWatch::CollectNotices(std::vector<Notice>& notices) const {
  for (const Watched& input : inputs_) {
    const auto subject = SubjectOf(input.channel);
    if (!subject) continue;
    const double age_s = ToSeconds(elapsed_ - input.last_heard.value_or(Duration::zero()));
    if (age_s > std::max(kNoticeAtLeast_s, kPeriodsUntilNotice * input.channel.period_s)) {
      notices.push_back({NoticeKind::kInputSilent, *subject, age_s});
    }
  }
}

}  // namespace v2vouch
