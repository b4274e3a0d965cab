// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/tracker.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "daemon/common/base/angle.h"
#include "daemon/local/tracking/chi_square.h"
#include "daemon/local/tracking/cluster_owner.h"

namespace v2vouch {
namespace {

const double kLog2Pi = std::log(2.0 * kPi);
// Range rates of clutter spread over this much [m/s]: +-30.
constexpr double kDopplerSpan_mps = 60.0;
// Standing returns share a narrow band of ground range rate.
constexpr double kStaticDopplerSpan_mps = 1.2;
// Clutter of a camera: boxes anywhere in the picture, width and depression spread over these.
constexpr double kBoxWidthSpan_rad = 0.3;
constexpr double kDepressionSpan_rad = 0.2;
// Unpublished tracks go below this.
constexpr double kForget = 1e-5;
// For the choice of an assignment a young track counts at least this much, so that its second hit
// reaches it and does not start another track beside it. Existence itself uses the true value.
constexpr double kAssignmentExistence = 0.05;
// A track just outside of a sensor's view may still be seen by it.
constexpr double kMinDetection = 0.02;
constexpr double kSureExistence = 0.9999;
// Most that one frame adds to a listed track's odds of existence. What reflects once shows again
// and again (a wall's echo, a multipath ghost): a hit is no independent proof, and a track that is
// met in one frame of four must go down.
constexpr double kMostGain = 5.0;
// Standard deviations of the coarse gate; the chi-square gate decides.
constexpr double kCoarseSigmas = 4.7;
// Detection probability of a frame in clear view, and of a picture that should show the vehicle.
constexpr double kClearLook = 0.4;
constexpr double kExpectedInPicture = 0.7;
// An echo between two vehicles against twice the nearer one's range, bearing and range rate.
constexpr double kEchoRange_m = 2.0;
constexpr double kEchoSigmas = 3.0;
constexpr double kEchoBearing_rad = 0.01;
constexpr double kEchoRate_mps = 0.6;
constexpr double kEchoWeaker_db = 10.0;
// For so long second echoes alone keep a vehicle.
constexpr double kEchoAlone_s = 1.0;
// How long a hidden track is kept for each second it was known.
constexpr double kHoldPerKnown = 3.0;
constexpr double kLeastHold_s = 0.3;
constexpr double kCoastingSince_s = 0.5;
// In view, a vehicle is missed for no longer than this.
constexpr double kOverdue_s = 0.7;
// What is faster than this drives along its lane; what is shorter than this walks or cycles.
constexpr double kDrives_mps = 3.0;
constexpr double kWalks_m = 2.0;
constexpr std::size_t kMostBoxes = 128;
// More that are not listed are not kept: every one of them costs as much as a vehicle.
constexpr std::size_t kMostGuesses = 128;
// What a vehicle was called is remembered for some twenty pictures: a name that was wrong for a
// while is overcome as fast.
constexpr double kVoteMemory = 0.95;
bool IsFinite(const RadarMeasurement& z) {
  return std::isfinite(z.range_m) && std::isfinite(z.azimuth_rad) &&
         std::isfinite(z.range_rate_mps) && z.covariance.allFinite() && z.range_m > 0.0;
}

bool IsFinite(const CameraMeasurement& z) {
  return std::isfinite(z.azimuth_left_rad) && std::isfinite(z.azimuth_right_rad) &&
         std::isfinite(z.depression_rad) && std::isfinite(z.azimuth_sigma_rad) &&
         std::isfinite(z.depression_sigma_rad);
}

// Size of the space that clutter of a kind spreads over. That of a box has as many dimensions as it
// has usable edges; radar measurements differ in none.
double Cells(const CameraMeasurement& z, const CameraLook& look) {
  const double half_fov_rad = std::atan2(0.5 * look.camera.image_width_px, look.camera.fx_px);
  double cells = 1.0;
  if (!z.left_is_cut || !z.right_is_cut) cells *= 2.0 * half_fov_rad;
  if (!z.left_is_cut && !z.right_is_cut) cells *= kBoxWidthSpan_rad;
  if (!z.bottom_is_cut) cells *= kDepressionSpan_rad;
  return cells;
}
double Cells(const RadarMeasurement&, const RadarLook&) { return 1.0; }

}  // namespace

std::uint64_t Tracker::PackId(Timestamp stamp, SensorKey sensor, std::size_t index) {
  constexpr unsigned kDetectionBits = 12;
  constexpr unsigned kSensorBits = 5;
  constexpr unsigned kKindBits = 2;
  constexpr unsigned kUnit_us_bits = 9;
  static_assert(kMostDetections == std::size_t{1} << kDetectionBits);
  static_assert(kMostSensorsOfAKind <= 1 << kSensorBits && kSensorKinds <= 1U << kKindBits);
  const std::uint64_t time = static_cast<std::uint64_t>(ToMicros(stamp)) >> kUnit_us_bits;
  const std::uint64_t which =
      static_cast<std::uint64_t>(sensor.kind) << kSensorBits | static_cast<unsigned>(sensor.index);
  return (time << (kKindBits + kSensorBits) | which) << kDetectionBits | index;
}

Tracker::Tracker(const TrackerConfig& config, const VehicleConfig& vehicle)
    : config_(config),
      vehicle_(std::make_shared<const VehicleConfig>(vehicle)),
      settings_{config.motion, config.point_targets} {
  for (int rows = 1; rows <= Linearized::kMaxRows; ++rows) {
    gate_[static_cast<std::size_t>(rows)] = ChiSquareQuantile(config.gate_probability, rows);
  }
}

void Tracker::Predict(Timestamp stamp) {
  failures_.clear();
  const double dt_s = tracks_.empty() ? 0.0 : std::max(0.0, ToSeconds(stamp - now_));
  now_ = stamp;
  since_update_s_ += dt_s;
  const double survival = std::pow(config_.survival_per_s, dt_s);
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    Hidden& hidden = hidden_[i];
    LocalTrack& track = tracks_[i];
    hidden.filter.Predict(dt_s, settings_);
    hidden.filter.Show(settings_, track);
    track.existence *= survival;
    if (!track.state_O.mean.allFinite() || !track.state_O.covariance.allFinite()) {
      failures_.push_back(Reason::kTrackNumerics);
      hidden.is_dead = true;
      continue;
    }
    const double silent_s = ToSeconds(now_ - hidden.last_hit);
    // What was seen for a moment only is not waited for.
    const double known_s = ToSeconds(hidden.last_hit - track.start);
    // Boxes alone leave the velocity open.
    const bool has_velocity = track.radar_hits() + track.object_hits() > 0;
    const double hold_s =
        has_velocity ? std::min(config_.hidden_hold_s, kHoldPerKnown * known_s + kLeastHold_s)
                     : kLeastHold_s;
    if (track.visibility != Visibility::kVisible && silent_s > hold_s) {
      hidden.is_dead = true;
    }
    if (silent_s > kCoastingSince_s && !IsWorthListing(i)) hidden.is_dead = true;
  }
  RemoveDead();
}

// Existence must outweigh the error that the cut-off metric would find.
bool Tracker::IsWorthListing(std::size_t track) const {
  const double c2 = config_.list_cutoff_m * config_.list_cutoff_m;
  const double m = hidden_[track].filter.position_covariance().trace();
  const double error = m > 0.0 ? -m * std::expm1(-c2 / m) : 0.0;
  return tracks_[track].existence * 2.0 * (c2 - error) > c2;
}

// Nothing is known to hide it, and no sensor has seen it for a while.
bool Tracker::IsOverdue(std::size_t track) const {
  return tracks_[track].visibility == Visibility::kVisible &&
         ToSeconds(now_ - hidden_[track].last_hit) > kOverdue_s;
}

void Tracker::AskDetectability(SensorKey sensor, const DetectabilityOf& detectability) {
  Timestamp& last = last_look_[SlotOf(sensor)];
  const double since_s = last == Timestamp{} ? 1e9 : ToSeconds(now_ - last);
  last = now_;
  const double share =
      config_.miss_memory_s > 0.0 ? std::clamp(since_s / config_.miss_memory_s, 0.0, 1.0) : 1.0;
  detection_.resize(tracks_.size());
  missing_.resize(tracks_.size());
  missed_.resize(tracks_.size());
  seen_.clear();
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const Detectability answer = detectability(tracks_[i]);
    detection_[i] = std::clamp(answer.probability, 0.0, 0.999);
    tracks_[i].visibility = answer.visibility;
    seen_.push_back(answer);
    missing_[i] =
        tracks_[i].is_confirmed ? 1.0 - std::pow(1.0 - detection_[i], share) : detection_[i];
    // A radar cannot miss what is only guessed to be there.
    if (sensor.kind == SensorKind::kRadar && !hidden_[i].has_range) missing_[i] = 0.0;
    missed_[i] = 1.0 - tracks_[i].existence * missing_[i];
  }
}

RadarMeasurement Tracker::Given(std::size_t track, const RadarMeasurement& z) const {
  RadarMeasurement given = z;
  given.visible_share = seen_[track].visible_share;
  return given;
}

CameraMeasurement Tracker::Given(std::size_t track, const CameraMeasurement& z) const {
  CameraMeasurement given = z;
  // A point has no edges: half a box still tells it more than none.
  if (!hidden_[track].filter.is_vehicle()) return given;
  given.left_is_cut |= seen_[track].left_is_covered;
  given.right_is_cut |= seen_[track].right_is_covered;
  return given;
}

template <class Look, class Measurement>
void Tracker::GatePair(std::size_t track, std::size_t measurement, const Look& look,
                       const Measurement& raw) {
  const Measurement z = Given(track, raw);
  const auto likelihood = hidden_[track].filter.Evaluate(look, z, settings_);
  if (!likelihood) return;
  AddPair(track, measurement, *likelihood, std::log(Cells(raw, look) / Cells(z, look)));
}

// `log_cells`: how much larger the measurement's own space is than the one it was compared in.
void Tracker::AddPair(std::size_t track, std::size_t measurement, const Likelihood& likelihood,
                      double log_cells) {
  if (likelihood.distance_squared > gate_[static_cast<std::size_t>(likelihood.rows)]) return;
  const double log_likelihood =
      -0.5 * (likelihood.distance_squared + likelihood.log_det + likelihood.rows * kLog2Pi);
  const double detection = std::max(detection_[track], kMinDetection);
  const double log_ratio =
      log_likelihood + std::log(detection) - candidates_[measurement].log_density - log_cells;
  const double existence = tracks_[track].existence;
  const double counted = std::max(existence, kAssignmentExistence);
  // Cost against leaving the track alone and calling the measurement clutter or a newcomer.
  const double cost = -(log_ratio + std::log(counted) -
                        std::log(1.0 - counted * std::max(missing_[track], kMinDetection)));
  const int row = static_cast<int>(track);
  const int column = static_cast<int>(measurement);
  costs_.push_back({row, column, cost});
  pairs_.push_back({row, column, existence * std::exp(std::min(log_ratio, 200.0))});
}

void Tracker::Associate(std::size_t measurements) {
  lone_.assign(tracks_.size(), 0.0);
  const auto best = solver_.Solve(costs_, tracks_.size(), measurements, lone_);
  assigned_.assign(best.begin(), best.end());
  marginals_.Compute(pairs_, missed_, assigned_, measurements);
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const double seen = marginals_.detected()[i];
    const double unseen = ExistenceAfterMiss(tracks_[i].existence, missing_[i]);
    double next = std::min(seen + (1.0 - seen) * unseen, kSureExistence);
    if (tracks_[i].is_confirmed) {
      const double odds = kMostGain * tracks_[i].existence / (1.0 - tracks_[i].existence);
      next = std::min(next, odds / (1.0 + odds));
    }
    tracks_[i].existence = next;
  }
}

// What a frame holds beyond the vehicles that are listed and a crowd of new ones is clutter,
// however little the sensor promised: interference would else be published as vehicles everywhere.
double Tracker::Crowd(std::size_t detections) const {
  const auto listed = std::ranges::count_if(tracks_, &LocalTrack::is_confirmed);
  return static_cast<double>(detections) - static_cast<double>(listed) -
         static_cast<double>(kMostNewcomers);
}

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
  Associate(measurements.size());
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

void Tracker::PrepareCamera(const CameraLook& look,
                            std::span<const CameraMeasurement> measurements) {
  const CameraConfig& camera = look.camera;
  const double half_fov_rad = std::atan2(0.5 * camera.image_width_px, camera.fx_px);
  const double reach_m = config_.camera_birth_range_m;
  const double births = config_.birth_per_m2_s * camera.period_s * half_fov_rad * reach_m * reach_m;
  const double clutter =
      std::max(camera.clutter_per_image, Crowd(std::min(measurements.size(), kMostBoxes)));
  const double birth_existence = BirthExistence(births, clutter);
  candidates_.Clear();
  for (const CameraMeasurement& z : measurements) {
    Candidate candidate;
    candidate.birth_existence = birth_existence;
    candidate.log_density = std::log(clutter / Cells(z, look) / (1.0 - birth_existence));
    candidate.may_start = IsFinite(z);
    candidates_.Add(candidate);
  }
  if (measurements.size() <= kMostBoxes) return;
  // No picture has so many vehicles: the surest boxes count.
  failures_.push_back(Reason::kTrackTableFull);
  newcomers_.resize(measurements.size());
  std::iota(newcomers_.begin(), newcomers_.end(), 0);
  std::ranges::sort(newcomers_, {}, [&](int j) {
    const double score = measurements[static_cast<std::size_t>(j)].score;
    return std::pair(score > 0.0 ? -score : 0.0, j);
  });
  for (std::size_t k = kMostBoxes; k < newcomers_.size(); ++k) {
    candidates_[static_cast<std::size_t>(newcomers_[k])].may_start = false;
  }
}

void Tracker::UpdateCamera(int camera, const EgoState& ego,
                           std::span<const CameraMeasurement> measurements,
                           const DetectabilityOf& detectability) {
  const CameraLook look{ego, vehicle_->cameras[static_cast<std::size_t>(camera)]};
  updates_.clear();
  costs_.clear();
  pairs_.clear();
  PrepareCamera(look, measurements);
  const SensorKey sensor{SensorKind::kCamera, camera};
  AskDetectability(sensor, detectability);
  const double axis = ego.X_OB.yaw_rad() + look.camera.yaw_rad;
  const Eigen::Vector2d origin_O = look.origin_O();
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const Eigen::Vector2d line = hidden_[i].filter.position_O() - origin_O;
    const double reach_m = kCoarseSigmas * LargestSigma(hidden_[i].filter.position_covariance()) +
                           0.7 * tracks_[i].extent.length_m;
    const double range_m = line.norm();
    const double reach_rad = reach_m < range_m ? std::asin(reach_m / range_m) : kPi;
    const double bearing = WrapAngle(std::atan2(line.y(), line.x()) - axis);
    for (std::size_t j = 0; j < measurements.size(); ++j) {
      const CameraMeasurement& z = measurements[j];
      if (!candidates_[j].may_start) continue;
      const double middle = 0.5 * (z.azimuth_left_rad + z.azimuth_right_rad);
      const double half =
          0.5 * (z.azimuth_left_rad - z.azimuth_right_rad) + kCoarseSigmas * z.azimuth_sigma_rad;
      // Every track meets every box: no division here. Boxes lie ahead of the camera.
      const double apart = std::abs(middle - bearing);
      if (std::min(apart, 2.0 * kPi - apart) > reach_rad + half) continue;
      GatePair(i, j, look, z);
    }
  }
  Associate(measurements.size());

  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    double& proven = hidden_[i].proven;
    proven = assigned_[i] < 0 ? ExistenceAfterMiss(proven, missing_[i])
                              : std::max(proven, tracks_[i].existence);
    tracks_[i].existence = std::min(tracks_[i].existence, proven);
    if (assigned_[i] < 0) {
      if (detection_[i] >= kExpectedInPicture) ++hidden_[i].not_pictured;
      continue;
    }
    const CameraMeasurement z = Given(i, measurements[static_cast<std::size_t>(assigned_[i])]);
    candidates_[static_cast<std::size_t>(assigned_[i])].may_start = false;
    Vote(i, z.object_class, z.score);
    if (!hidden_[i].filter.Update(look, z, settings_)) {
      failures_.push_back(Reason::kTrackNumerics);
      hidden_[i].is_dead = true;
      continue;
    }
    Hit(i, sensor);
    hidden_[i].is_far =
        (hidden_[i].filter.position_O() - origin_O).norm() > config_.camera_birth_range_m;
    updates_.push_back({tracks_[i].id, z});
    if (!hidden_[i].has_range) LearnRange(i, look, z);
  }
  LookThrough(look, measurements);
  StartFromCamera(look, camera, measurements);
  LearnRoad(ego);
  Conclude(since_update_s_);
}

void Tracker::StartFromCamera(const CameraLook& look, int camera,
                              std::span<const CameraMeasurement> measurements) {
  const std::size_t known = tracks_.size();
  std::size_t started = 0;
  for (std::size_t j = 0; j < measurements.size(); ++j) {
    if (!candidates_[j].may_start) continue;
    const CameraMeasurement& z = measurements[j];
    const auto fix = FixOf(look, z);
    if (!fix) continue;
    if ((fix->p_O - look.origin_O()).norm() > look.camera.max_range_m) continue;
    if (started == kMostNewcomers) {
      failures_.push_back(Reason::kTrackTableFull);
      break;
    }
    bool is_covered = false;
    for (std::size_t i = 0; i < known && !is_covered; ++i) {
      is_covered = assigned_[i] < 0 && Covers(i, look, z, *fix);
    }
    if (is_covered) continue;
    if (!Start(TrackFilter::FromCamera(look, z, *fix), {SensorKind::kCamera, camera}, j,
               candidates_[j].birth_existence * (1.0 - marginals_.explained()[j]))) {
      continue;
    }
    ++started;
    Vote(tracks_.size() - 1, z.object_class, z.score);
    hidden_.back().has_range = settings_.point_targets;
    updates_.push_back({tracks_.back().id, z});
  }
}

void Tracker::Hit(std::size_t track, SensorKey sensor, bool is_echo) {
  hidden_[track].last_hit = now_;
  if (!is_echo) hidden_[track].borne_out = now_;
  tracks_[track].support.Add(sensor, now_);
}

void Tracker::Vote(std::size_t track, ObjectClass object_class, double score) {
  const auto named = static_cast<std::size_t>(object_class);
  Hidden& hidden = hidden_[track];
  if (named == 0 || named >= hidden.class_votes.size()) return;
  for (double& votes : hidden.class_votes) votes *= kVoteMemory;
  hidden.class_votes[named] += std::max(score, 0.05);
  const auto current = static_cast<std::size_t>(tracks_[track].object_class);
  // A name changes only for one that is clearly better supported.
  if (named != current && hidden.class_votes[named] > 1.5 * hidden.class_votes[current]) {
    tracks_[track].object_class = object_class;
    hidden.filter.SetClass(object_class);
  }
}

bool Tracker::Start(const TrackFilter& filter, SensorKey sensor, std::size_t index,
                    double existence) {
  if (index >= kMostDetections) return false;
  std::uint64_t id = PackId(now_, sensor, index);
  // Two messages of one sensor may bear one stamp. Tracks of other times come first in the table.
  const std::uint64_t first = PackId(now_, {}, 0);
  const auto is_taken = [&] {
    for (auto other = tracks_.rbegin(); other != tracks_.rend() && other->id >= first; ++other) {
      if (other->id == id) return true;
    }
    return false;
  };
  while (is_taken()) ++id;
  if (tracks_.size() >= static_cast<std::size_t>(config_.max_tracks)) {
    failures_.push_back(Reason::kTrackTableFull);
    return false;
  }
  LocalTrack track;
  track.id = id;
  track.start = now_;
  track.is_point = settings_.point_targets;
  track.existence = std::max(existence, kMinBirth);
  filter.Show(settings_, track);
  Hidden hidden;
  hidden.proven = track.existence;
  hidden.filter = filter;
  hidden.last_hit = now_;
  tracks_.push_back(track);
  hidden_.push_back(hidden);
  Hit(tracks_.size() - 1, sensor);
  return true;
}

// Ways of those that drive, the ego's among them.
void Tracker::LearnRoad(const EgoState& ego) {
  if (ego.speed_mps > kDrives_mps) {
    roads_.Note(ego.X_OB.origin().vector(), ego.X_OB.yaw_rad());
  }
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const LocalTrack& track = tracks_[i];
    if (!track.is_confirmed || !hidden_[i].filter.has_driven()) continue;
    if (hidden_[i].last_hit != now_ || ClassExtent(track.object_class).length_m < kWalks_m)
      continue;
    const Eigen::Vector2d velocity = hidden_[i].filter.velocity_O();
    if (velocity.norm() < kDrives_mps) continue;
    roads_.Note(hidden_[i].filter.position_O(), std::atan2(velocity.y(), velocity.x()));
  }
}

void Tracker::FaceAsTheRoad(std::size_t track) {
  TrackFilter& filter = hidden_[track].filter;
  if (filter.has_driven() || !filter.is_vehicle() || settings_.point_targets ||
      hidden_[track].last_hit != now_)
    return;
  const double axis_rad = tracks_[track].state_O.mean[kYaw];
  if (const auto yaw = roads_.DirectionAt(filter.position_O(), axis_rad)) {
    filter.FaceTowards(*yaw);
  }
}

// Shows the new states, confirms, ends and puts in order.
void Tracker::Conclude(double dt_s) {
  since_update_s_ = 0.0;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    LocalTrack& track = tracks_[i];
    Hidden& hidden = hidden_[i];
    FaceAsTheRoad(i);
    hidden.filter.Show(settings_, track);
    if (!track.state_O.mean.allFinite() || !track.state_O.covariance.allFinite()) {
      failures_.push_back(Reason::kTrackNumerics);
      hidden.is_dead = true;
      continue;
    }
    const int hits = Hits(i);
    if (!track.is_confirmed && IsConvincing(i)) {
      track.is_confirmed = true;
    } else if (track.is_confirmed && (track.existence < config_.keep_existence ||
                                      !IsWorthListing(i) || IsTransparent(i) || IsOverdue(i))) {
      track.is_confirmed = false;
    }
    const bool was_believed = hits >= config_.confirm_hits;
    if (track.existence < (was_believed ? config_.delete_existence : kForget)) {
      hidden.is_dead = true;
    }
  }
  DropDuplicates(dt_s);
  JoinParts(dt_s);
  DropUnlikely();
  RemoveDead();
  // Births come in order of their index; only two sensors with one stamp can need more than this.
  for (std::size_t i = 1; i < tracks_.size(); ++i) {
    for (std::size_t k = i; k > 0 && tracks_[k].id < tracks_[k - 1].id; --k) {
      std::swap(tracks_[k], tracks_[k - 1]);
      std::swap(hidden_[k], hidden_[k - 1]);
    }
  }
}

// Of many tracks that are not listed the likeliest stay.
void Tracker::DropUnlikely() {
  newcomers_.clear();
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const bool may_go = !tracks_[i].is_confirmed && !hidden_[i].is_certain;
    if (may_go && !hidden_[i].is_dead) newcomers_.push_back(static_cast<int>(i));
  }
  if (newcomers_.size() <= kMostGuesses) return;
  std::ranges::sort(newcomers_, {}, [&](int i) {
    const LocalTrack& track = tracks_[static_cast<std::size_t>(i)];
    return std::pair(-track.existence, track.id);
  });
  for (std::size_t k = kMostGuesses; k < newcomers_.size(); ++k) {
    hidden_[static_cast<std::size_t>(newcomers_[k])].is_dead = true;
  }
  failures_.push_back(Reason::kTrackTableFull);
}

void Tracker::ForgetUnpicturedSince(Timestamp since) {
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (tracks_[i].start < since) continue;
    if (tracks_[i].camera_hits() + tracks_[i].object_hits() == 0) hidden_[i].is_dead = true;
  }
  RemoveDead();
  std::erase_if(recent_, [](const RecentReturn& at) { return at.is_moving; });
}

void Tracker::RemoveDead() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (hidden_[i].is_dead) continue;
    if (kept != i) {
      tracks_[kept] = tracks_[i];
      hidden_[kept] = hidden_[i];
    }
    ++kept;
  }
  tracks_.resize(kept);
  hidden_.resize(kept);
}

}  // namespace v2vouch
