// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>

#include "daemon/local/tracking/tracker.h"

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

// What no track was given of this radar's scan, in place of what was kept of its oldest one.
void Tracker::KeepReturns(const RadarLook& look, int radar,
                          std::span<const RadarMeasurement> measurements) {
  std::erase_if(recent_, [radar](RecentReturn& at) {
    return at.radar == radar && ++at.scans_ago >= kKeptScans;
  });
  newcomers_.clear();
  for (std::size_t j = 0; j < measurements.size(); ++j) {
    if (measurements[j].is_static && owner_[j] >= 0) continue;
    if (!candidates_[j].p_O.allFinite() || candidates_[j].reach_m == 0.0) continue;
    newcomers_.push_back(static_cast<int>(j));
  }
  KeepNearest(measurements, kMostReturns, newcomers_);
  for (const int kept : newcomers_) {
    const auto j = static_cast<std::size_t>(kept);
    const bool is_moving = !measurements[j].is_static;
    const Fix fix = settings_.point_targets ? FixOf(look, measurements[j])
                                            : ReflectionFixOf(look, measurements[j]);
    recent_.push_back(
        {fix, radar, 0, measurements[j].returns, is_moving, StrengthAtOneMetre(measurements[j])});
  }
}

// The place of the standing returns that a track's boxes agree on, if there is one such place.
Tracker::Place Tracker::FindPlace(const Glances& glances) {
  Place place;
  const auto count = static_cast<double>(glances.size());
  const double most = count + kRangeSigmas * std::sqrt(2.0 * count);

  in_sight_.clear();
  for (const RecentReturn& at : recent_) {
    const auto misfit = glances.Misfit(at.fix.p_O);
    if (misfit) in_sight_.push_back({&at, *misfit, glances.RangeTo(at.fix.p_O)});
  }
  // What a radar sees best there: the face that a vehicle turns to it answers by far the strongest.
  std::array<double, kMostSensorsOfAKind> strongest_db;
  strongest_db.fill(-1e9);
  for (const InSight& seen : in_sight_) {
    if (seen.at->is_moving || seen.misfit > most) continue;
    double& db = strongest_db[static_cast<std::size_t>(seen.at->radar)];
    db = std::max(db, seen.at->strength_db);
  }
  double best_score = 0.0;
  double second_score = 0.0;
  double best_m = -1.0;
  double second_m = -1.0;
  for (const InSight& seen : in_sight_) {
    const RecentReturn& at = *seen.at;
    if (seen.misfit > most) continue;
    if (at.is_moving) {
      if (at.scans_ago == 0) place.is_moving = true;
      continue;
    }
    const double range_m = seen.range_m;
    // A post gives one return to a scan, a vehicle several.
    int returns = 0;
    std::bitset<std::size_t{kMostSensorsOfAKind} * kKeptScans> scans;
    for (const InSight& other : in_sight_) {
      const double behind_m = other.range_m - range_m;
      if (other.at->is_moving || behind_m < 0.0 || behind_m > kDepth_m) continue;
      returns += other.at->returns;
      scans.set(static_cast<std::size_t>(other.at->radar) * kKeptScans +
                static_cast<std::size_t>(other.at->scans_ago));
    }
    const double per_scan = returns / static_cast<double>(std::max<std::size_t>(scans.count(), 1));
    const double plenty = std::clamp((per_scan - kPostReturns) / kMoreReturns, 0.0, 1.0);
    const double weaker_db =
        std::min(strongest_db[static_cast<std::size_t>(at.radar)] - at.strength_db, kMostWeaker_db);
    const double score =
        kLone + plenty * (kSeveral - kLone) - 0.5 * seen.misfit - kPerDecibel * weaker_db;
    if (best_m < 0.0 || score > best_score) {
      // One place shows itself once for each of its returns.
      if (best_m >= 0.0 && std::abs(best_m - range_m) > kDepth_m) {
        second_m = best_m;
        second_score = best_score;
      }
      best_m = range_m;
      best_score = score;
    } else if (std::abs(best_m - range_m) > kDepth_m && (second_m < 0.0 || score > second_score)) {
      second_m = range_m;
      second_score = score;
    }
  }
  if (place.is_moving || glances.size() < kLeastGlances || best_m < 0.0) return place;
  if (second_m >= 0.0 && best_score - second_score < kMargin) return place;

  Fix fix;
  fix.covariance.setZero();
  double sum = 0.0;
  for (const InSight& seen : in_sight_) {
    const RecentReturn& at = *seen.at;
    const double behind_m = seen.range_m - best_m;
    if (at.is_moving || behind_m < 0.0 || behind_m > kDepth_m) continue;
    fix.p_O += at.returns * at.fix.p_O;
    fix.covariance += at.returns * at.fix.covariance;
    sum += at.returns;
  }
  fix.p_O /= sum;
  fix.covariance /= sum;
  place.standing = fix;
  return place;
}

// One more box of a track whose range is only guessed.
void Tracker::LearnRange(std::size_t track, const CameraLook& look, const CameraMeasurement& z) {
  Hidden& hidden = hidden_[track];
  hidden.glances.Add(look, z);
  const Place place = FindPlace(hidden.glances);
  hidden.moving_there = place.is_moving ? hidden.moving_there + 1 : 0;
  if (place.standing) {
    hidden.filter.TakeStanding(*place.standing);
    hidden.has_range = true;
  } else if (hidden.moving_there >= kMovingPictures) {
    hidden.is_dead = true;
  }
}

}  // namespace v2vouch
