// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace v2vouch::evaluation {

/// A sample of figures; every statistic is kNoValue over nothing.
struct Sample {
  std::vector<double> values;

  void Add(double value) { values.push_back(value); }
  [[nodiscard]] std::int64_t count() const { return static_cast<std::int64_t>(values.size()); }
  [[nodiscard]] double Mean() const;
  [[nodiscard]] double Rms() const;
  [[nodiscard]] double Largest() const;
  [[nodiscard]] double ShareAbove(double limit) const;
  /// The smallest value that a share `q` of the sample does not exceed (nearest rank).
  [[nodiscard]] double Quantile(double q) const;
  [[nodiscard]] double Median() const { return Quantile(0.5); }
};

}  // namespace v2vouch::evaluation
