// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "daemon/rim/wire/status.h"

namespace v2vouch {

/// Wall time of one stage: quantiles over what came since the last report.
class LatencyMeter {
 public:
  explicit LatencyMeter(std::string stage) : stage_(std::move(stage)) {}

  void Add(std::chrono::steady_clock::duration duration);
  /// Nearest-rank quantiles, all zero where nothing came; starts again.
  wire::StageLatency Report();

 private:
  std::string stage_;
  std::vector<double> samples_us_;
};

}  // namespace v2vouch
