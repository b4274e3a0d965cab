// SPDX-License-Identifier: Apache-2.0
// The radar half of the tracker: a scan's clusters met with the tracks.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "daemon/common/base/angle.h"
#include "daemon/local/tracking/cluster_owner.h"
#include "daemon/local/tracking/gate_pair.h"
#include "daemon/local/tracking/tracker.h"

namespace v2vouch {
namespace {

// Range rates of clutter spread over this much [m/s]: +-30.
constexpr double kDopplerSpan_mps = 60.0;
// Standing returns share a narrow band of ground range rate.
constexpr double kStaticDopplerSpan_mps = 1.2;
// Detection probability of a scan in clear view.
constexpr double kClearLook = 0.4;
// An echo between two vehicles against twice the nearer one's range, bearing and range rate.
constexpr double kEchoRange_m = 2.0;
constexpr double kEchoSigmas = 3.0;
constexpr double kEchoBearing_rad = 0.01;
constexpr double kEchoRate_mps = 0.6;
constexpr double kEchoWeaker_db = 10.0;
// For so long second echoes alone keep a vehicle.
constexpr double kEchoAlone_s = 1.0;

bool IsFinite(const RadarMeasurement& z) {
  return std::isfinite(z.range_m) && std::isfinite(z.azimuth_rad) &&
         std::isfinite(z.range_rate_mps) && z.covariance.allFinite() && z.range_m > 0.0;
}

}  // namespace

void Tracker::PrepareRadar(const RadarLook& look, std::span<const RadarMeasurement> measurements) {
  const RadarConfig& radar = look.radar;
  const double cells = (radar.max_range_m - radar.min_range_m) * 2.0 * radar.half_fov_rad;
  const double births = config_.birth_per_m2_s * radar.period_s * radar.half_fov_rad *
                        radar.max_range_m * radar.max_range_m;
  double standing = 1.0;
  for (const RadarMeasurement& z : measurements) standing += z.is_static ? 1.0 : 0.0;
  const std::size_t moving = measurements.size() + 1 - static_cast<std::size_t>(standing);
  const double crowd = Crowd(moving);
  const bool is_crowded = crowd > radar.clutter_per_scan;
  const double clutter = is_crowded ? crowd : radar.clutter_per_scan;
  if (is_crowded) crowd_shape_.Fill(radar, measurements);
  const double birth_existence = BirthExistence(births, clutter);
  const double moving_density = clutter / (cells * kDopplerSpan_mps);
  const double static_density = standing / (cells * kStaticDopplerSpan_mps);

  candidates_.Clear();
  for (const RadarMeasurement& z : measurements) {
    Candidate candidate;
    if (IsFinite(z)) {
      const Fix fix = FixOf(look, z);
      candidate.p_O = fix.p_O;
      candidate.reach_m = kCoarseSigmas * LargestSigma(fix.covariance) + 1.0;
      candidate.may_start = !z.is_static;
    } else {
      candidate.p_O.setConstant(std::numeric_limits<double>::max() / 4.0);
    }
    candidate.birth_existence = birth_existence;
    double density = z.is_static ? static_density : moving_density;
    if (is_crowded && !z.is_static) density *= crowd_shape_.At(z);
    candidate.log_density = std::log(density / (1.0 - birth_existence));
    candidates_.Add(candidate);
  }
  DenyEchoes(look, measurements);
  candidates_.Sort();
}

// What is reflected between the car and the vehicle before it comes back from twice as far, at
// twice the range rate, in the same direction and weaker: it starts nothing, and by itself it keeps
// nothing alive.
void Tracker::DenyEchoes(const RadarLook& look, std::span<const RadarMeasurement> measurements) {
  const double bearing_rad = kEchoSigmas * look.radar.azimuth_sigma_rad + kEchoBearing_rad;
  for (std::size_t j = 0; j < measurements.size(); ++j) {
    const RadarMeasurement& echo = measurements[j];
    if (!candidates_[j].may_start || echo.outline_count == 0) continue;
    for (const RadarMeasurement& z : measurements) {
      if (z.outline_count == 0 || std::abs(echo.range_m - 2.0 * z.range_m) > kEchoRange_m) continue;
      if (std::abs(AngleDifference(echo.azimuth_rad, z.azimuth_rad)) > bearing_rad) continue;
      if (std::abs(echo.range_rate_mps - 2.0 * z.range_rate_mps) > kEchoRate_mps) continue;
      if (z.outline[0].strength_db < echo.outline[0].strength_db + kEchoWeaker_db) continue;
      candidates_[j].may_start = false;
      candidates_[j].is_echo = true;
      break;
    }
  }
}

void Tracker::UpdateRadar(int radar, const EgoState& ego,
                          std::span<const RadarMeasurement> measurements,
                          const DetectabilityOf& detectability) {
  const RadarLook look{ego, vehicle_->radars[static_cast<std::size_t>(radar)]};
  updates_.clear();
  costs_.clear();
  pairs_.clear();
  PrepareRadar(look, measurements);
  const SensorKey sensor{SensorKind::kRadar, radar};
  AskDetectability(sensor, detectability);
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const double reach_m = kCoarseSigmas * LargestSigma(hidden_[i].filter.position_covariance()) +
                           0.7 * tracks_[i].extent.length_m;
    // Long enough tried, a guess may meet standing returns by itself.
    const bool is_guess = !hidden_[i].has_range;
    if (is_guess && hidden_[i].glances.size() < Glances::kMost) continue;
    const bool takes_standing = tracks_[i].camera_hits() + tracks_[i].object_hits() > 0 ||
                                hidden_[i].moving_hits >= config_.confirm_hits;
    const bool is_echo_alone = ToSeconds(now_ - hidden_[i].borne_out) > kEchoAlone_s;
    candidates_.ForEachNear(hidden_[i].filter.position_O(), reach_m, [&](std::size_t j) {
      if (candidates_[j].is_echo && is_echo_alone) return;
      if (measurements[j].is_static ? takes_standing : !is_guess) {
        GatePair(i, j, look, measurements[j]);
      }
    });
  }
  Associate(measurements.size(), Proof::kRepeated);
  AbsorbClusters(look, measurements);
  TakeFaces(look, measurements);
  JoinOwned(look, measurements);

  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (assigned_[i] < 0) continue;
    RadarMeasurement z = Given(i, joined_[i]);
    const Candidate& given = candidates_[static_cast<std::size_t>(assigned_[i])];
    z.may_be_anothers = hidden_[i].filter.may_move_face() && IsInAnothersBox(i, given.p_O);
    if (!hidden_[i].filter.Update(look, z, settings_)) {
      failures_.push_back(Reason::kTrackNumerics);
      hidden_[i].is_dead = true;
      continue;
    }
    Hit(i, sensor, given.is_echo);
    // A post in the vehicle's place would have been seen as well.
    Hidden& hidden = hidden_[i];
    if (z.is_static) {
      tracks_[i].existence = std::min(tracks_[i].existence, hidden.proven);
    } else {
      hidden.proven = std::max(hidden.proven, tracks_[i].existence);
    }
    // A sensor that tracks by itself has sorted its mirror images out.
    if (z.is_object || detection_[i] >= kClearLook) ++hidden.clear_hits;
    hidden.reflection_O = given.p_O;
    hidden.reflected = now_;
    NotePlace(i, look, hidden.reflection_O);
    hidden.has_range = true;
    if (!z.is_static) ++hidden_[i].moving_hits;
    updates_.push_back({tracks_[i].id, z});
  }
  StartFromRadar(look, radar, measurements);
  KeepReturns(look, radar, measurements);
  LearnRoad(ego);
  Conclude(since_update_s_);
}

bool Tracker::KeepNearest(std::span<const RadarMeasurement> measurements, std::size_t most,
                          std::vector<int>& which) {
  if (which.size() <= most) return false;
  std::ranges::sort(which, {}, [&](int j) {
    return std::pair(measurements[static_cast<std::size_t>(j)].range_m, j);
  });
  which.resize(most);
  std::ranges::sort(which);
  return true;
}

// What no track explains starts one each.
void Tracker::StartFromRadar(const RadarLook& look, int radar,
                             std::span<const RadarMeasurement> measurements) {
  newcomers_.clear();
  for (std::size_t j = 0; j < measurements.size(); ++j) {
    if (candidates_[j].may_start && owner_[j] < 0) newcomers_.push_back(static_cast<int>(j));
  }
  // A scan of interference is no crowd of vehicles: the nearest count.
  if (KeepNearest(measurements, kMostNewcomers, newcomers_)) {
    failures_.push_back(Reason::kTrackTableFull);
  }
  const std::size_t known = tracks_.size();
  for (const int newcomer : newcomers_) {
    const auto j = static_cast<std::size_t>(newcomer);
    // The first cluster of a newcomer swallows the others of the same scan.
    bool is_taken = false;
    for (std::size_t i = known; i < tracks_.size() && !is_taken; ++i) {
      is_taken = Owns(i, look, measurements[j], candidates_[j].p_O);
    }
    if (is_taken) continue;
    const SensorKey sensor{SensorKind::kRadar, radar};
    if (!Start(TrackFilter::FromRadar(look, measurements[j], settings_), sensor, j,
               candidates_[j].birth_existence * (1.0 - marginals_.explained()[j]))) {
      continue;
    }
    hidden_.back().moving_hits = 1;
    hidden_.back().reflection_O = candidates_[j].p_O;
    hidden_.back().reflected = now_;
    NotePlace(tracks_.size() - 1, look, candidates_[j].p_O);
    updates_.push_back({tracks_.back().id, measurements[j]});
  }
}

// What each track was given, with the clusters that belong to it.
void Tracker::JoinOwned(const RadarLook& look, std::span<const RadarMeasurement> measurements) {
  const Eigen::Vector2d v_A_B = AntennaVelocity_B(look.ego, look.radar);
  const Eigen::Matrix2d R_BO = look.ego.X_OB.rotation().transpose();
  const Eigen::Rotation2Dd R_RB(-look.radar.yaw_rad);
  joined_.resize(tracks_.size());
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (assigned_[i] >= 0) joined_[i] = measurements[static_cast<std::size_t>(assigned_[i])];
  }
  for (std::size_t j = 0; j < measurements.size(); ++j) {
    if (owner_[j] < 0) continue;
    const auto owner = static_cast<std::size_t>(owner_[j]);
    if (owner >= tracks_.size() || assigned_[owner] < 0) continue;
    const Eigen::Vector2d v_TA_R = R_RB * (R_BO * hidden_[owner].filter.velocity_O() - v_A_B);
    joined_[owner] = JoinClusters(joined_[owner], measurements[j], v_TA_R);
  }
}

}  // namespace v2vouch
