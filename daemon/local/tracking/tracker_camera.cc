// SPDX-License-Identifier: Apache-2.0
// The camera half of the tracker: a picture's boxes met with the tracks.
#include <algorithm>
#include <cmath>
#include <utility>

#include "daemon/common/base/angle.h"
#include "daemon/local/tracking/own_body.h"
#include "daemon/local/tracking/tracker.h"

namespace v2vouch {
namespace {

// Clutter of a camera: boxes anywhere in the picture, width and depression spread over these.
constexpr double kBoxWidthSpan_rad = 0.3;
constexpr double kDepressionSpan_rad = 0.2;
// False boxes are of what is far; of those right before the car so few are.
constexpr double kFalseNear = 0.02;
// Detection probability of a picture that should show the vehicle.
constexpr double kExpectedInPicture = 0.7;
constexpr std::size_t kMostBoxes = 128;
// So long after a reflection its place is the near face's.
constexpr double kFreshRange_s = 0.3;

bool IsFinite(const CameraMeasurement& z) {
  return std::isfinite(z.azimuth_left_rad) && std::isfinite(z.azimuth_right_rad) &&
         std::isfinite(z.depression_rad) && std::isfinite(z.azimuth_sigma_rad) &&
         std::isfinite(z.depression_sigma_rad);
}

double HalfViewOf(const CameraConfig& camera) {
  return std::atan2(0.5 * camera.image_width_px, camera.fx_px);
}

// On the ground straight ahead of the car and near, with both its sides in the picture: beside the
// road near boxes are parts of a row, and which of its cars is another question.
bool IsRightBefore(const CameraConfig& camera, const CameraMeasurement& z) {
  return z.depression_rad > kRightBefore_rad && !z.left_is_cut && !z.right_is_cut &&
         z.azimuth_left_rad > -camera.yaw_rad && z.azimuth_right_rad < -camera.yaw_rad;
}

// The boxes of one picture. One that is not finite meets nothing and starts nothing.
void AddCandidates(const CameraLook& look, std::span<const CameraMeasurement> measurements,
                   const TrackerConfig& config, TrackTable& table, Candidates& candidates) {
  const CameraConfig& camera = look.camera;
  const double reach_m = config.camera_birth_range_m;
  const double births =
      config.birth_per_m2_s * camera.period_s * HalfViewOf(camera) * reach_m * reach_m;
  const double clutter =
      std::max(camera.clutter_per_image, table.CrowdOf(std::min(measurements.size(), kMostBoxes)));
  for (const CameraMeasurement& z : measurements) {
    const double false_share = IsRightBefore(camera, z) ? kFalseNear : 1.0;
    Candidate candidate;
    candidate.birth_existence = BirthExistence(births, clutter * false_share);
    candidate.log_density =
        std::log(clutter * false_share / Cells(z, look) / (1.0 - candidate.birth_existence));
    candidate.may_start = IsFinite(z);
    candidates.Add(candidate);
  }
  // No picture has more vehicles: the surest boxes count.
  const bool is_crowded = candidates.KeepFirst(kMostBoxes, [&](std::size_t j) {
    const double score = measurements[j].score;
    return std::pair(score > 0.0 ? -score : 0.0, j);
  });
  if (is_crowded) table.AddFault(Reason::kTrackTableFull);
}

}  // namespace

double Cells(const CameraMeasurement& z, const CameraLook& look) {
  double cells = 1.0;
  if (!z.left_is_cut || !z.right_is_cut) cells *= 2.0 * HalfViewOf(look.camera);
  if (!z.left_is_cut && !z.right_is_cut) cells *= kBoxWidthSpan_rad;
  if (!z.bottom_is_cut) cells *= kDepressionSpan_rad;
  return cells;
}

void Tracker::UpdateCamera(int camera, const EgoState& ego,
                           std::span<const CameraMeasurement> measurements,
                           const DetectabilityOf& detectability) {
  const CameraLook look{ego, vehicle_->cameras[static_cast<std::size_t>(camera)]};
  const SensorKey sensor{SensorKind::kCamera, camera};
  Begin(sensor, detectability);
  AddCandidates(look, measurements, config_, table_, association_.candidates());
  CompareCameraBoxes(look, measurements);
  association_.Solve(measurements.size(), Proof::kRepeated, table_);
  for (std::size_t i = 0; i < table_.size(); ++i) {
    Prove(i);
    const auto [track, evidence] = table_[i];
    track.existence = std::min(track.existence, evidence.proven);
    if (const auto j = association_.GivenTo(i)) {
      association_.candidates()[*j].may_start = false;
      TakeCameraBox(look, sensor, i, measurements[*j]);
    } else if (association_.expected().detection(i) >= kExpectedInPicture) {
      ++evidence.not_pictured;
    }
  }
  CountSeenThrough(look, measurements, association_, table_);
  StartFromCamera(look, sensor, measurements);
  roads_.Learn(ego, table_);
  Conclude();
}

void Tracker::CompareCameraBoxes(const CameraLook& look,
                                 std::span<const CameraMeasurement> measurements) {
  const double axis = look.ego.X_OB.yaw_rad() + look.camera.yaw_rad;
  for (std::size_t i = 0; i < table_.size(); ++i) {
    const auto [track, evidence] = table_[i];
    const Eigen::Vector2d line = evidence.filter.position_O() - look.origin_O();
    const double reach_m =
        CoarseReach(evidence.filter.position_covariance(), track.extent.length_m);
    const double range_m = line.norm();
    const double reach_rad = reach_m < range_m ? std::asin(reach_m / range_m) : kPi;
    const double bearing = WrapAngle(std::atan2(line.y(), line.x()) - axis);
    for (std::size_t j = 0; j < measurements.size(); ++j) {
      const CameraMeasurement& z = measurements[j];
      if (!association_.candidates()[j].may_start) continue;
      if (IsBeyondCut(look, z, range_m - 0.5 * track.extent.length_m)) continue;
      const double middle = 0.5 * (z.azimuth_left_rad + z.azimuth_right_rad);
      const double half =
          0.5 * (z.azimuth_left_rad - z.azimuth_right_rad) + kCoarseSigmas * z.azimuth_sigma_rad;
      // Every track meets every box: no division here. Boxes lie ahead of the camera.
      const double apart = std::abs(middle - bearing);
      if (std::min(apart, 2.0 * kPi - apart) > reach_rad + half) continue;
      association_.Compare(table_, i, j, look, z);
    }
  }
}

void Tracker::TakeCameraBox(const CameraLook& look, SensorKey sensor, std::size_t i,
                            const CameraMeasurement& raw) {
  const auto [track, evidence] = table_[i];
  const CameraMeasurement z = association_.expected().Given(i, table_, raw);
  if (ToSeconds(table_.now() - evidence.reflected) < kFreshRange_s) {
    evidence.height.Add(look, z, (evidence.reflection_O - look.origin_O()).norm());
  }
  table_.NoteClass(i, z.object_class, z.score);
  if (!evidence.filter.Update(look, z, table_.settings())) return table_.Fail(i);
  table_.NoteHit(i, sensor);
  evidence.is_far =
      (evidence.filter.position_O() - look.origin_O()).norm() > config_.camera_birth_range_m;
  updates_.push_back({track.id, z});
  if (!evidence.has_range) returns_.LearnRange(look, z, evidence);
}

void Tracker::StartFromCamera(const CameraLook& look, SensorKey sensor,
                              std::span<const CameraMeasurement> measurements) {
  const std::size_t known = table_.size();
  for (std::size_t j = 0; j < measurements.size(); ++j) {
    if (!association_.candidates()[j].may_start) continue;
    const CameraMeasurement& z = measurements[j];
    const auto fix = FixOf(look, z);
    if (!fix) continue;
    if ((fix->p_O - look.origin_O()).norm() > look.camera.max_range_m) continue;
    if (table_.size() == known + TrackTable::kMostNewcomers) {
      return table_.AddFault(Reason::kTrackTableFull);
    }
    bool is_covered = false;
    for (std::size_t i = 0; i < known && !is_covered; ++i) {
      is_covered = !association_.GivenTo(i) && IsPartOf(table_[i].track, look, z, *fix);
    }
    if (is_covered) continue;
    const TrackFilter filter = TrackFilter::FromCamera(look, z, *fix);
    if (!table_.Start(filter, sensor, j, association_.BirthExistence(j))) continue;
    table_.NoteClass(table_.size() - 1, z.object_class, z.score);
    const auto [track, evidence] = table_.back();
    evidence.has_range = table_.settings().point_targets;
    updates_.push_back({track.id, z});
  }
}

}  // namespace v2vouch
