// SPDX-License-Identifier: Apache-2.0
#include "sim/radio/link.h"

#include <algorithm>
#include <cmath>

#include "sim/sensors/subject.h"

namespace v2vouch::sim {
namespace {

constexpr double kShadowTime_s = 1.0;

}  // namespace

double ReceptionProbability(const LinkSpec& spec, double distance_m, bool is_blocked) {
  const double d90 = is_blocked ? spec.blocked_90_m : spec.open_90_m;
  const double d50 = d90 * std::pow(9.0, 1.0 / spec.steepness);
  return 1.0 / (1.0 + std::pow(std::max(distance_m, 0.0) / d50, spec.steepness));
}

Link::Link(const LinkSpec& spec, std::uint64_t seed, std::uint64_t from, std::uint64_t to)
    : spec_(spec),
      seed_(seed),
      from_(from),
      to_(to),
      spells_(SubjectRandom(seed, "radio spells", {from, to})) {}

// Good and bad spells of exponential length, by turns.
bool Link::IsInterfered(std::int64_t utime) {
  if (spec_.burst_every_s <= 0.0) return false;
  const auto spell_us = [&](double mean_s) {
    return std::max<std::int64_t>(std::llround(-std::log1p(-spells_.Uniform()) * mean_s * 1e6), 1);
  };
  if (changes_at_ == 0) changes_at_ = utime + spell_us(spec_.burst_every_s);
  while (utime >= changes_at_) {
    is_bad_ = !is_bad_;
    changes_at_ += spell_us(is_bad_ ? spec_.burst_s : spec_.burst_every_s);
  }
  return is_bad_;
}

Link::Copy Link::DrawCopy(Random& random, double distance_m, bool is_blocked) const {
  double delay_s = spec_.delay_s + random.Uniform(0.0, spec_.delay_spread_s);
  if (random.Bernoulli(spec_.late_share)) delay_s += spec_.late_s;
  const double signal_dbm =
      spec_.signal_10m_dbm -
      10.0 * spec_.signal_exponent * std::log10(std::max(distance_m, 1.0) / 10.0) -
      (is_blocked ? spec_.blocked_db : 0.0) + shadow_db_ + random.Normal(0.0, 1.0);
  return {std::llround(delay_s * 1e6),
          static_cast<int>(std::lround(std::clamp(signal_dbm, -126.0, 0.0)))};
}

Link::Outcome Link::Carry(std::int64_t utime, double distance_m, bool is_blocked) {
  Random random = SubjectRandom(seed_, "radio message", {from_, to_, messages_++});
  const double kept =
      last_utime_ == 0 ? 0.0
                       : std::exp(-std::max(static_cast<double>(utime - last_utime_) * 1e-6, 0.0) /
                                  kShadowTime_s);
  last_utime_ = utime;
  shadow_db_ =
      kept * shadow_db_ + std::sqrt(1.0 - kept * kept) * random.Normal(0.0, spec_.shadowing_db);
  Outcome outcome;
  if (!random.Bernoulli(ReceptionProbability(spec_, distance_m, is_blocked))) {
    outcome.fate = Fate::kTooFar;
    return outcome;
  }
  if (IsInterfered(utime) && random.Bernoulli(spec_.burst_loss)) {
    outcome.fate = Fate::kInterference;
    return outcome;
  }
  outcome.copies.push_back(DrawCopy(random, distance_m, is_blocked));
  if (random.Bernoulli(spec_.duplicate_share)) {
    outcome.copies.push_back(DrawCopy(random, distance_m, is_blocked));
  }
  return outcome;
}

}  // namespace v2vouch::sim
