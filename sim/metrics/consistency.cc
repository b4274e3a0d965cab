// SPDX-License-Identifier: Apache-2.0
#include "sim/metrics/consistency.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace v2vouch::evaluation {
namespace {

using Series = std::vector<double>;  // nees - mean at instants in a row.

std::vector<Series> Stretches(const std::vector<MatchedPair>& pairs, Sighting sighting,
                              double mean) {
  struct Open {
    Series series;
    std::size_t last = 0;
  };
  std::map<std::pair<std::size_t, std::int64_t>, Open> open;
  std::vector<Series> stretches;
  for (const MatchedPair& pair : pairs) {
    if (pair.sighting != sighting || std::isnan(pair.nees)) continue;
    Open& now = open[{pair.object, pair.track}];
    if (!now.series.empty() && pair.instant != now.last + 1) {
      stretches.push_back(std::move(now.series));
      now.series.clear();
    }
    now.series.push_back(pair.nees - mean);
    now.last = pair.instant;
  }
  for (auto& [key, rest] : open) stretches.push_back(std::move(rest.series));
  return stretches;
}

// Mean product of values `lag` apart, as it adds to the variance of a mean over the stretches.
double Covariance(const std::vector<Series>& stretches, std::size_t lag, double samples) {
  double sum = 0.0;
  for (const Series& series : stretches) {
    for (std::size_t i = lag; i < series.size(); ++i) sum += series[i] * series[i - lag];
  }
  return sum / samples;
}

// P(chi-square of 2 n degrees of freedom > x): a Poisson sum, in logarithms against underflow.
double Beyond(double x, int n) {
  const double half = 0.5 * x;
  double sum = 0.0;
  for (int k = 0; k < n; ++k) sum += std::exp(-half + k * std::log(half) - std::lgamma(k + 1.0));
  return sum;
}

}  // namespace

double ChiSquareOfPairs(double p, int pairs) {
  const double degrees = 2.0 * pairs;
  constexpr int kExactPairs = 5000;
  double low = 1e-12;
  double high = degrees + 20.0 * std::sqrt(2.0 * degrees) + 60.0;
  const auto below = [&](double x) {
    if (pairs <= kExactPairs) return 1.0 - Beyond(x, pairs);
    return 0.5 * std::erfc(-(x - degrees) / std::sqrt(2.0 * degrees) / std::sqrt(2.0));
  };
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    (below(middle) < p ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

void SetBand(const std::vector<MatchedPair>& pairs, Sighting sighting, Anees& anees) {
  if (anees.count == 0) return;
  const std::vector<Series> stretches = Stretches(pairs, sighting, anees.mean());
  std::size_t longest = 0;
  for (const Series& series : stretches) longest = std::max(longest, series.size());
  const auto samples = static_cast<double>(anees.count);
  const double variance = Covariance(stretches, 0, samples);
  double tau = 1.0;
  for (std::size_t lag = 1; variance > 0.0 && lag <= longest / 2; ++lag) {
    const double rho = Covariance(stretches, lag, samples) / variance;
    if (rho <= 0.0) break;
    tau += 2.0 * rho;
  }
  anees.independent = std::max(1.0, samples / tau);
  const int n = static_cast<int>(anees.independent);
  anees.low = ChiSquareOfPairs(0.025, n) / n;
  anees.high = ChiSquareOfPairs(0.975, n) / n;
}

}  // namespace v2vouch::evaluation
