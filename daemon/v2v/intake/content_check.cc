// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/intake/content_check.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace v2vouch {
namespace {

constexpr std::uint32_t kLastTen = 0b11'1111'1111;

// The change where it is one; the reference moves along.
std::optional<Finding> Change(std::optional<double>& known_m, std::optional<double> told_m,
                              const MessageCheckConfig& config) {
  if (!told_m) return std::nullopt;
  const std::optional<double> before_m = known_m;
  known_m = told_m;
  if (!before_m) return std::nullopt;
  const double change_m = std::abs(*told_m - *before_m);
  const double limit_m = std::min(config.size_change_m, config.size_change_share * *before_m);
  if (change_m <= limit_m) return std::nullopt;
  return Finding{Check::kSizeChange, Verdict::kWithdraw, "change_m", change_m, limit_m};
}

}  // namespace

std::optional<Finding> DelayCheck::Judge(double age_s, const MessageCheckConfig& config) {
  age_s_[next_] = static_cast<float>(age_s);
  next_ = (next_ + 1) % age_s_.size();
  count_ = std::min(count_ + 1, age_s_.size());
  if (count_ < age_s_.size()) return std::nullopt;
  auto sorted = age_s_;
  const auto middle = sorted.begin() + sorted.size() / 2;
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double median_s = 0.5 * (*middle + *std::max_element(sorted.begin(), middle));
  if (median_s <= config.late_s) return std::nullopt;
  return Finding{Check::kLateMessages, Verdict::kWithdraw, "median_age_s", median_s, config.late_s};
}

std::optional<Finding> SizeCheck::Judge(std::optional<double> length_m,
                                        std::optional<double> width_m,
                                        const MessageCheckConfig& config) {
  const auto of_length = Change(length_m_, length_m, config);
  const auto of_width = Change(width_m_, width_m, config);
  return of_length ? of_length : of_width;
}

void ImplausibleCheck::OnMessage(bool is_implausible) {
  refused_ = ((refused_ << 1U) | (is_implausible ? 1U : 0U)) & kLastTen;
}

std::optional<Finding> ImplausibleCheck::Judge(const MessageCheckConfig& config) const {
  const int refused = std::popcount(refused_);
  if (refused < config.implausible_messages) return std::nullopt;
  return Finding{Check::kImplausible, Verdict::kWithdraw, "refused_of_ten",
                 static_cast<double>(refused), static_cast<double>(config.implausible_messages)};
}

}  // namespace v2vouch
