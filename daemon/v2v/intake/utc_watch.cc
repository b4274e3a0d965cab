// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/intake/utc_watch.h"

#include <algorithm>
#include <array>

namespace v2vouch {
namespace {

constexpr int kWindowsThatTell = 2;

}  // namespace

UtcWatch::UtcWatch() { heard_.reserve(kMostSenders); }

void UtcWatch::OnMessage(SenderId sender, Timestamp received, double age_s) {
  if (!since_ || received < *since_) {
    since_ = received;
    heard_.clear();
  }
  if (const double passed_s = ToSeconds(received - *since_); passed_s > kWindow_s) {
    // After a silence of all senders the last word is too old to stand.
    if (passed_s > 3.0 * kWindow_s) heard_.clear();
    EndWindow();
    since_ = received;
  }
  const auto found = std::ranges::find(heard_, sender, &Heard::sender);
  if (found != heard_.end()) {
    found->least_age_s = std::min(found->least_age_s, age_s);
    ++found->messages;
  } else if (heard_.size() < kMostSenders) {
    heard_.push_back({sender, age_s, 1});
  }
}

void UtcWatch::EndWindow() {
  std::array<double, kMostSenders> ages{};
  std::size_t count = 0;
  for (const Heard& heard : heard_) {
    if (heard.messages >= kFewestMessages) ages[count++] = heard.least_age_s;
  }
  heard_.clear();
  // Of an even number the one nearer to 0: what is told is at least so far off.
  std::sort(ages.begin(), ages.begin() + static_cast<std::ptrdiff_t>(count));
  const double low_s = count > 0 ? ages[(count - 1) / 2] : 0.0;
  const double high_s = count > 0 ? ages[count / 2] : 0.0;
  const bool is_out = low_s > kMost_s || high_s < kLeast_s;
  windows_ = is_out ? windows_ + 1 : 0;
  difference_s_ = low_s > kMost_s ? low_s : high_s;
}

std::optional<double> UtcWatch::difference_s() const {
  if (windows_ < kWindowsThatTell) return std::nullopt;
  return difference_s_;
}

}  // namespace v2vouch
