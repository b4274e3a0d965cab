// SPDX-License-Identifier: Apache-2.0
#include "calibration/extrinsics/white_noise.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace v2vouch {
namespace {

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace

double WhiteSigma(const std::vector<double>& signal) {
  if (signal.size() < 20) return std::nan("");
  std::vector<double> differences;
  for (std::size_t i = 1; i + 1 < signal.size(); ++i) {
    differences.push_back(std::abs(signal[i + 1] - 2.0 * signal[i] + signal[i - 1]));
  }
  return Median(std::move(differences)) / (0.6745 * std::sqrt(6.0));
}

double WhiteSigmaWithin(const std::vector<double>& signal, std::vector<double> stated,
                        double usual) {
  if (stated.empty()) return usual;
  double most = Median(std::move(stated));
  if (!std::isfinite(most) || most <= 0.0) most = usual;
  const double white = WhiteSigma(signal);
  return std::isfinite(white) ? std::clamp(white, 0.25 * most, most) : most;
}

}  // namespace v2vouch
