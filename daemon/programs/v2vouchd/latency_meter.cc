// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/v2vouchd/latency_meter.h"

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
    // Not sorted: in a flood that would hold up a frame each second.
    const auto rank = [this](double share) {
      const auto count = static_cast<double>(samples_us_.size());
      const auto at =
          samples_us_.begin() + static_cast<std::ptrdiff_t>(std::ceil(share * count)) - 1;
      std::nth_element(samples_us_.begin(), at, samples_us_.end());
      return *at;
    };
    latency.p50_us = rank(0.50);
    latency.p99_us = rank(0.99);
    latency.max_us = *std::max_element(samples_us_.begin(), samples_us_.end());
  }
  samples_us_.clear();
  return latency;
}

}  // namespace v2vouch
