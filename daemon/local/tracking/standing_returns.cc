// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/standing_returns.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>

#include "daemon/local/tracking/radar_candidates.h"

namespace v2vouch {
namespace {

// Something moves where a camera's guess is, in so many pictures: the guess is of that vehicle.
constexpr int kMovingPictures = 3;
constexpr std::size_t kLeastGlances = 5;
constexpr double kRangeSigmas = 3.0;
// One place must be this much likelier than any other, as the logarithm of a ratio.
constexpr double kMargin = 3.0;
// Returns of a place are counted over so many scans of each radar.
constexpr int kKeptScans = 4;
// So many of one scan, the nearest: what stands about in a street, several times over.
constexpr std::size_t kMostReturns = 256;
constexpr double kPostReturns = 1.1;
constexpr double kMoreReturns = 0.5;
// Vehicles show several reflections within this depth, posts one: ln of how much likelier.
constexpr double kDepth_m = 3.0;
constexpr double kSeveral = 2.0;
constexpr double kLone = -1.5;
// Each decibel below the strongest return in sight makes a place less likely: ln of a ratio.
constexpr double kPerDecibel = 0.3;
constexpr double kMostWeaker_db = 20.0;

// Strength falls with the fourth power of the range.
double StrengthAtOneMetre(const RadarMeasurement& z) {
  return z.outline[0].strength_db + 40.0 * std::log10(std::max(z.range_m, 1.0));
}

}  // namespace

void StandingReturns::Keep(const RadarLook& look, int radar,
                           std::span<const RadarMeasurement> measurements,
                           const Candidates& candidates, const ClusterOwners& owners) {
  std::erase_if(recent_,
                [radar](Return& at) { return at.radar == radar && ++at.scans_ago >= kKeptScans; });
  kept_.clear();
  for (std::size_t j = 0; j < measurements.size(); ++j) {
    if (measurements[j].is_static && owners.IsOwned(j)) continue;
    if (!candidates[j].p_O.allFinite() || candidates[j].reach_m == 0.0) continue;
    kept_.push_back(j);
  }
  KeepNearest(measurements, kMostReturns, kept_);
  for (const std::size_t j : kept_) {
    const RadarMeasurement& z = measurements[j];
    const Fix fix = point_targets_ ? FixOf(look, z) : ReflectionFixOf(look, z);
    recent_.push_back({fix, radar, 0, z.returns, !z.is_static, StrengthAtOneMetre(z)});
  }
}

void StandingReturns::ForgetMoving() {
  std::erase_if(recent_, [](const Return& at) { return at.is_moving; });
}

void StandingReturns::LearnRange(const CameraLook& look, const CameraMeasurement& z,
                                 TrackEvidence& evidence) {
  evidence.glances.Add(look, z);
  const auto count = static_cast<double>(evidence.glances.size());
  const double most_misfit = count + kRangeSigmas * std::sqrt(2.0 * count);
  const bool is_moving = CollectInSight(evidence.glances, most_misfit);
  if (is_moving) {
    if (++evidence.moving_there >= kMovingPictures) evidence.is_ended = true;
    return;
  }
  evidence.moving_there = 0;
  if (evidence.glances.size() < kLeastGlances) return;
  if (const auto standing = FindStanding(most_misfit)) {
    evidence.filter.TakeStanding(*standing);
    evidence.has_range = true;
  }
}

bool StandingReturns::CollectInSight(const Glances& glances, double most_misfit) {
  in_sight_.clear();
  bool is_moving = false;
  for (const Return& at : recent_) {
    const auto misfit = glances.Misfit(at.fix.p_O);
    if (!misfit) continue;
    in_sight_.push_back({&at, *misfit, glances.RangeTo(at.fix.p_O)});
    is_moving = is_moving || (at.is_moving && at.scans_ago == 0 && !(*misfit > most_misfit));
  }
  return is_moving;
}

// The place of the standing returns that a track's boxes agree on, if there is one such place.
std::optional<Fix> StandingReturns::FindStanding(double most_misfit) const {
  // What a radar sees best there: the face that a vehicle turns to it answers by far the strongest.
  std::array<double, kMostSensorsOfAKind> strongest_db;
  strongest_db.fill(-1e9);
  for (const InSight& seen : in_sight_) {
    if (seen.at->is_moving || seen.misfit > most_misfit) continue;
    double& db = strongest_db[static_cast<std::size_t>(seen.at->radar)];
    db = std::max(db, seen.at->strength_db);
  }
  Choice choice;
  for (const InSight& seen : in_sight_) {
    if (seen.at->is_moving || seen.misfit > most_misfit) continue;
    const double strongest = strongest_db[static_cast<std::size_t>(seen.at->radar)];
    choice.Offer(ScoreOf(seen, strongest), seen.range_m);
  }
  if (!choice.IsClear()) return std::nullopt;
  return MeanBehind(choice.best_m);
}

// Logarithm of how likely a vehicle's near face is there. A post gives one return to a scan, a
// vehicle several.
double StandingReturns::ScoreOf(const InSight& seen, double strongest_db) const {
  int returns = 0;
  std::bitset<std::size_t{kMostSensorsOfAKind} * kKeptScans> scans;
  for (const InSight& other : in_sight_) {
    const double behind_m = other.range_m - seen.range_m;
    if (other.at->is_moving || behind_m < 0.0 || behind_m > kDepth_m) continue;
    returns += other.at->returns;
    scans.set(static_cast<std::size_t>(other.at->radar) * kKeptScans +
              static_cast<std::size_t>(other.at->scans_ago));
  }
  const double per_scan = returns / static_cast<double>(std::max<std::size_t>(scans.count(), 1));
  const double plenty = std::clamp((per_scan - kPostReturns) / kMoreReturns, 0.0, 1.0);
  const double weaker_db = std::min(strongest_db - seen.at->strength_db, kMostWeaker_db);
  return kLone + plenty * (kSeveral - kLone) - 0.5 * seen.misfit - kPerDecibel * weaker_db;
}

// One place shows itself once for each of its returns.
void StandingReturns::Choice::Offer(double score, double range_m) {
  const bool is_elsewhere = std::abs(best_m - range_m) > kDepth_m;
  if (best_m < 0.0 || score > best_score) {
    if (best_m >= 0.0 && is_elsewhere) {
      second_m = best_m;
      second_score = best_score;
    }
    best_m = range_m;
    best_score = score;
  } else if (is_elsewhere && (second_m < 0.0 || score > second_score)) {
    second_m = range_m;
    second_score = score;
  }
}

bool StandingReturns::Choice::IsClear() const {
  return best_m >= 0.0 && !(second_m >= 0.0 && best_score - second_score < kMargin);
}

// The standing returns within a vehicle's depth, weighted by the number of reflections.
Fix StandingReturns::MeanBehind(double range_m) const {
  Fix fix;
  fix.covariance.setZero();
  double sum = 0.0;
  for (const InSight& seen : in_sight_) {
    const Return& at = *seen.at;
    const double behind_m = seen.range_m - range_m;
    if (at.is_moving || behind_m < 0.0 || behind_m > kDepth_m) continue;
    fix.p_O += at.returns * at.fix.p_O;
    fix.covariance += at.returns * at.fix.covariance;
    sum += at.returns;
  }
  fix.p_O /= sum;
  fix.covariance /= sum;
  return fix;
}

}  // namespace v2vouch
