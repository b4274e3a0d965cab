// SPDX-License-Identifier: Apache-2.0
// The camera half of the tracker: a picture's boxes met with the tracks.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "daemon/common/base/angle.h"
#include "daemon/local/tracking/gate_pair.h"
#include "daemon/local/tracking/tracker.h"

namespace v2vouch {
namespace {

// Clutter of a camera: boxes anywhere in the picture, width and depression spread over these.
constexpr double kBoxWidthSpan_rad = 0.3;
constexpr double kDepressionSpan_rad = 0.2;
// Detection probability of a picture that should show the vehicle.
constexpr double kExpectedInPicture = 0.7;
constexpr std::size_t kMostBoxes = 128;

bool IsFinite(const CameraMeasurement& z) {
  return std::isfinite(z.azimuth_left_rad) && std::isfinite(z.azimuth_right_rad) &&
         std::isfinite(z.depression_rad) && std::isfinite(z.azimuth_sigma_rad) &&
         std::isfinite(z.depression_sigma_rad);
}

}  // namespace

double Cells(const CameraMeasurement& z, const CameraLook& look) {
  const double half_fov_rad = std::atan2(0.5 * look.camera.image_width_px, look.camera.fx_px);
  double cells = 1.0;
  if (!z.left_is_cut || !z.right_is_cut) cells *= 2.0 * half_fov_rad;
  if (!z.left_is_cut && !z.right_is_cut) cells *= kBoxWidthSpan_rad;
  if (!z.bottom_is_cut) cells *= kDepressionSpan_rad;
  return cells;
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
  Associate(measurements.size(), Proof::kRepeated);

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

}  // namespace v2vouch
