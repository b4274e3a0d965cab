// SPDX-License-Identifier: Apache-2.0
#include "sim/scorecard/summary.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/metrics/scoring.h"

namespace v2vouch::evaluation {

double Sample::Mean() const {
  if (values.empty()) return kNoValue;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double Sample::Rms() const {
  if (values.empty()) return kNoValue;
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

double Sample::Largest() const {
  return values.empty() ? kNoValue : *std::ranges::max_element(values);
}

double Sample::ShareAbove(double limit) const {
  if (values.empty()) return kNoValue;
  const auto above = std::ranges::count_if(values, [&](double value) { return value > limit; });
  return static_cast<double>(above) / static_cast<double>(values.size());
}

double Sample::Quantile(double q) const {
  if (values.empty()) return kNoValue;
  std::vector<double> sorted = values;
  const auto rank = static_cast<std::size_t>(
      std::max(1.0, std::ceil(q * static_cast<double>(sorted.size()) - 1e-9)));
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(rank - 1);
  std::nth_element(sorted.begin(), at, sorted.end());
  return *at;
}

}  // namespace v2vouch::evaluation
