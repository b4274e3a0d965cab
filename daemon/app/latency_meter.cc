// SPDX-License-Identifier: Apache-2.0
#include "daemon/app/latency_meter.h"

#include <algorithm>
#include <cmath>

namespace v2vouch {

void LatencyMeter::Add(std::chrono::steady_clock::duration duration) {
  constexpr std::size_t kMost = 100'000;  // A second at the highest rate there can be.
  if (samples_us_.size() < kMost) {
    samples_us_.push_back(std::chrono::duration<double, std::micro>(duration).count());
  }
}

wire::StageLatency LatencyMeter::Report() {
  wire::StageLatency latency;
  latency.stage = stage_;
  if (!samples_us_.empty()) {
    std::sort(samples_us_.begin(), samples_us_.end());
    const auto rank = [this](double share) {
      const auto count = static_cast<double>(samples_us_.size());
      return samples_us_[static_cast<std::size_t>(std::ceil(share * count)) - 1];
    };
    latency.p50_us = rank(0.50);
    latency.p99_us = rank(0.99);
    latency.max_us = samples_us_.back();
  }
  samples_us_.clear();
  return latency;
}

}  // namespace v2vouch
