// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/trust/claimed_place.h"

#include <algorithm>
#include <cmath>

namespace v2vouch {
namespace {

constexpr double kLeast = 1e-5;  // Of a likelihood, so that doubt can fade again.

// Since when a condition has held without a break.
void KeepSince(bool holds, Timestamp now, std::optional<Timestamp>& since) {
  if (!holds) {
    since.reset();
  } else if (!since) {
    since = now;
  }
}

}  // namespace

const std::array<ClaimedPlace::Place, ClaimedPlace::kPlaces>& ClaimedPlace::Places() {
  constexpr double kOff = 1.7320508;  // sqrt(3): the outer points of the three-point rule.
  constexpr double kMiddle = 2.0 / 3.0;
  constexpr double kOuter = 1.0 / 6.0;
  static constexpr std::array<Place, kPlaces> kAll = {{{0.0, 0.0, kMiddle * kMiddle},
                                                       {kOff, 0.0, kOuter * kMiddle},
                                                       {-kOff, 0.0, kOuter * kMiddle},
                                                       {0.0, kOff, kMiddle * kOuter},
                                                       {0.0, -kOff, kMiddle * kOuter},
                                                       {kOff, kOff, kOuter * kOuter},
                                                       {kOff, -kOff, kOuter * kOuter},
                                                       {-kOff, kOff, kOuter * kOuter},
                                                       {-kOff, -kOff, kOuter * kOuter}}};
  return kAll;
}

bool ClaimedPlace::IsDue(Timestamp stamp, const ClaimedPlaceConfig& config) const {
  return !last_look_ || ToSeconds(stamp - *last_look_) >= config.look_s;
}

void ClaimedPlace::OnLook(Timestamp stamp, std::span<const Look, kPlaces> looks,
                          const ClaimedPlaceConfig& config) {
  const double dt_s = last_look_ ? std::max(0.0, ToSeconds(stamp - *last_look_)) : 0.0;
  last_look_ = stamp;
  const double fade = std::exp(-dt_s / config.recovery_s);
  for (std::size_t i = 0; i < kPlaces; ++i) {
    const double before = static_cast<double>(likelihood_[i]);
    double after = 1.0;
    switch (looks[i].seen) {
      case Seen::kOccupied:
        after = std::pow(before, std::exp(-dt_s / config.occupied_s));
        break;
      case Seen::kUnknown:
        after = std::pow(before, fade);
        break;
      case Seen::kEmpty:
        after = AfterMiss(before, looks[i].detection, config.clear_doubt, config.false_detection);
        break;
    }
    likelihood_[i] = static_cast<float>(std::clamp(after, kLeast, 1.0));
  }
  const double ratio = log_ratio();
  KeepSince(ratio <= config.lasting_log_ratio, stamp, doubted_since_);
  KeepSince(ratio <= config.accuse_log_ratio, stamp, accusable_since_);
}

double ClaimedPlace::log_ratio() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < kPlaces; ++i) {
    sum += Places()[i].weight * static_cast<double>(likelihood_[i]);
  }
  return std::log(sum);
}

std::optional<Finding> ClaimedPlace::Judge(double hold_s, const ClaimedPlaceConfig& config) const {
  const double ratio = log_ratio();
  if (accusable_since_ && ToSeconds(*last_look_ - *accusable_since_) >= hold_s) {
    return Finding{Check::kEmptyPlace, Verdict::kAccuse, "log_ratio", ratio,
                   config.accuse_log_ratio};
  }
  if (ratio <= config.withdraw_log_ratio) {
    return Finding{Check::kEmptyPlace, Verdict::kWithdraw, "log_ratio", ratio,
                   config.withdraw_log_ratio};
  }
  if (doubted_since_ && ToSeconds(*last_look_ - *doubted_since_) >= config.lasting_s) {
    return Finding{Check::kEmptyPlace, Verdict::kWithdraw, "log_ratio", ratio,
                   config.lasting_log_ratio};
  }
  return std::nullopt;
}

}  // namespace v2vouch
