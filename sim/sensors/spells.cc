// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/spells.h"

#include <algorithm>
#include <cmath>

namespace v2vouch::sim {
namespace {

double Exponential(double mean, Random& random) { return -mean * std::log(1.0 - random.Uniform()); }

}  // namespace

ErrorBursts::ErrorBursts(const ErrorBurstSpec& spec, const Random& random)
    : spec_(spec), random_(random) {
  DrawNext(0.0);
}

void ErrorBursts::DrawNext(double from_s) {
  begins_s_ = from_s + Exponential(spec_.every_s, random_);
  const double size = random_.Uniform(spec_.low_m, spec_.high_m);
  whole_ = size * Direction(random_.Uniform(-kPi, kPi));
}

Vec2 ErrorBursts::At(double time_s) {
  if (spec_.every_s <= 0.0) return Vec2::Zero();
  const double whole_s = spec_.lasts_s + 2.0 * spec_.rise_s;
  while (time_s >= begins_s_ + whole_s) DrawNext(begins_s_ + whole_s);
  const double since = time_s - begins_s_;
  if (since < 0.0) return Vec2::Zero();
  if (spec_.rise_s <= 0.0) return whole_;
  return std::min({1.0, since / spec_.rise_s, (whole_s - since) / spec_.rise_s}) * whole_;
}

RadioGaps::RadioGaps(const RadioSpec& spec, const Random& random) : spec_(spec), random_(random) {
  DrawNext(0.0);
}

void RadioGaps::DrawNext(double from_s) {
  begins_s_ = from_s + Exponential(spec_.gap_every_s, random_);
  const double u = random_.Uniform();
  ends_s_ = begins_s_ + spec_.gap_max_s * u * u * u * u;
}

bool RadioGaps::IsSilent(double time_s) {
  if (spec_.gap_every_s <= 0.0) return false;
  while (time_s >= ends_s_) DrawNext(ends_s_);
  return time_s >= begins_s_;
}

}  // namespace v2vouch::sim
