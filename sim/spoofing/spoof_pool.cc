// SPDX-License-Identifier: Apache-2.0
#include "sim/spoofing/spoof_pool.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/random.h"

namespace v2vouch::evaluation {
namespace {

// Index of the nearest rank of `share` among `count` ordered values.
std::size_t Rank(double share, std::size_t count) {
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(count)));
  return std::clamp<std::size_t>(rank, 1, count) - 1;
}

std::optional<double> Share(int part, int whole) {
  if (whole <= 0) return std::nullopt;
  return static_cast<double>(part) / whole;
}

void AddRun(const SpoofRun& run, AttackFigures& figures) {
  for (const SourceOutcome& source : run.attackers) {
    if (source.false_in_view_s < kSourceInView_s) continue;
    ++figures.sources;
    figures.met += source.met_after_s ? 1 : 0;
    figures.accused += source.accused_after_s ? 1 : 0;
    if (source.met_after_s) {
      figures.met_after.times_s.push_back(*source.met_after_s);
    } else {
      ++figures.met_after.censored;
    }
  }
  const Exposure& e = run.exposure;
  figures.exposure_max_m = std::max(figures.exposure_max_m, e.max_m);
  figures.original_max_m = std::max(figures.original_max_m, e.original_max_m);
  figures.harm_s += e.harm_s;
  figures.lingered_max_s = std::max(figures.lingered_max_s, e.lingered_s);
  figures.ghosts += static_cast<int>(e.ghosts.size());
  figures.ghosts_of_attackers += e.ghosts_of_attackers();
  figures.outnumbered += e.outnumbered;
  figures.doubled += e.doubled;
  figures.honest.Add(run.honest);
  if (figures.curve_m.size() < e.curve_m.size()) figures.curve_m.resize(e.curve_m.size(), 0.0);
  for (std::size_t i = 0; i < e.curve_m.size(); ++i) {
    figures.curve_m[i] = std::max(figures.curve_m[i], e.curve_m[i]);
  }
}

}  // namespace

PooledF1 PoolF1(std::span<const Confusion> runs) {
  PooledF1 pooled;
  for (const Confusion& run : runs) pooled.counts.Add(run);
  pooled.f1 = pooled.counts.f1();
  if (!pooled.f1) return pooled;
  constexpr int kDraws = 1000;
  Random random(20'240'611);
  std::vector<double> drawn;
  drawn.reserve(kDraws);
  for (int draw = 0; draw < kDraws; ++draw) {
    Confusion sum;
    for (std::size_t i = 0; i < runs.size(); ++i) sum.Add(runs[random.Bits() % runs.size()]);
    if (const auto f1 = sum.f1()) drawn.push_back(*f1);
  }
  std::sort(drawn.begin(), drawn.end());
  if (drawn.empty()) return pooled;
  pooled.low = drawn[Rank(0.025, drawn.size())];
  pooled.high = drawn[Rank(0.975, drawn.size())];
  return pooled;
}

std::optional<double> CensoredTimes::Percentile(double share) const {
  if (count() == 0) return std::nullopt;
  const std::size_t rank = Rank(share, static_cast<std::size_t>(count()));
  if (rank >= times_s.size()) return std::nullopt;
  std::vector<double> ordered = times_s;
  std::sort(ordered.begin(), ordered.end());
  return ordered[rank];
}

std::optional<double> AttackFigures::withdraw_rate() const { return Share(met, sources); }
std::optional<double> AttackFigures::accuse_rate() const { return Share(accused, sources); }

std::optional<double> AttackFigures::score() const {
  const auto rate = withdraw_rate();
  if (!rate) return std::nullopt;
  const auto median_s = met_after.Percentile(0.5);
  return 0.4 * *rate + 0.3 * (median_s ? std::exp(-*median_s / 5.0) : 0.0) +
         0.3 * std::exp(-exposure_max_m / 5.0);
}

AttackFigures PoolAttack(std::span<const SpoofRun* const> runs) {
  AttackFigures figures;
  figures.runs = static_cast<int>(runs.size());
  std::vector<Confusion> messages, sources, check_messages, check_sources;
  std::vector<double> exposures;
  for (const SpoofRun* run : runs) {
    AddRun(*run, figures);
    messages.push_back(run->by_message);
    sources.push_back(run->by_source);
    if (run->checks_by_message) check_messages.push_back(*run->checks_by_message);
    if (run->checks_by_source) check_sources.push_back(*run->checks_by_source);
    exposures.push_back(run->exposure.max_m);
  }
  figures.by_message = PoolF1(messages);
  figures.by_source = PoolF1(sources);
  if (!check_messages.empty()) figures.checks_by_message = PoolF1(check_messages);
  if (!check_sources.empty()) figures.checks_by_source = PoolF1(check_sources);
  if (exposures.empty()) return figures;
  figures.harm_s /= static_cast<double>(exposures.size());
  std::sort(exposures.begin(), exposures.end());
  figures.exposure_p95_m = exposures[Rank(0.95, exposures.size())];
  return figures;
}

std::optional<double> CompositeScore(std::optional<double> weakest, const HonestTreatment& honest) {
  if (!weakest || honest.vehicle_s <= 0.0 || honest.in_view <= 0) return std::nullopt;
  const double accusations_per_hour = honest.accusations / (honest.vehicle_s / 3600.0);
  return 100.0 * *weakest * (1.0 - std::min(1.0, accusations_per_hour)) * honest.validated /
         honest.in_view;
}

}  // namespace v2vouch::evaluation
