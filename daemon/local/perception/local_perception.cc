// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/perception/local_perception.h"

#include <algorithm>
#include <cmath>

#include "daemon/local/camera/camera_preprocessing.h"

namespace v2vouch {
namespace {

// A hidden vehicle is detected now and then after all: multipath, gaps, a wrong idea of the scene.
// With r <- r (1 - p) / (1 - r p) a track at r = 0.99 still has 0.95 after 80 misses of p = 0.02.
constexpr double kHiddenDetection = 0.02;
// Where the map cannot say, a miss is weak evidence at most.
constexpr double kUnknownDetection = 0.3;
// Radar and camera fade towards the end of their range from this share on.
constexpr double kFullRangeShare = 0.7;
constexpr double kSilentPeriods = 3.0;
// What a sensor has measured so lately is in view, whatever the map of what may hide it says.
constexpr double kJustSeen_s = 0.15;
constexpr int kSureHits = 3;

double RangeFade(double range_m, double max_range_m) {
  const double share = range_m / max_range_m;
  if (share <= kFullRangeShare) return 1.0;
  return std::clamp((1.0 - share) / (1.0 - kFullRangeShare), 0.0, 1.0);
}

bool IsJustSeen(const LocalTrack& track, Timestamp now) {
  const auto is_fresh = [now](const std::optional<Timestamp>& hit) {
    return hit && ToSeconds(now - *hit) <= kJustSeen_s;
  };
  return is_fresh(track.last_radar) || is_fresh(track.last_camera);
}

Visibility VisibilityOf(View overall) {
  switch (overall) {
    case View::kClear:
    case View::kUnknown:
      return Visibility::kVisible;
    case View::kOccluded:
      return Visibility::kHidden;
    case View::kOutOfView:
      break;
  }
  return Visibility::kOutOfView;
}

double DistanceToSensor(const EgoState& ego, double x_m, double y_m, const LocalTrack& track) {
  const Point<Odometry> p_OS = ego.X_OB * Point<Body>{x_m, y_m};
  return std::hypot(track.state_O.mean[kX] - p_OS.x_m, track.state_O.mean[kY] - p_OS.y_m);
}

}  // namespace

LocalPerception::LocalPerception(const LocalConfig& config)
    : vehicle_(std::make_shared<const VehicleConfig>(config.vehicle)),
      ego_reading_(config.ego_motion),
      radar_preprocessor_(config.radar),
      visibility_(config.visibility, config.vehicle),
      tracker_(config.tracking, config.vehicle),
      last_radar_(config.vehicle.radars.size()),
      last_camera_(config.vehicle.cameras.size()) {}

void LocalPerception::OnEgoMotion(const EgoMotion& sample) {
  const EgoMotion read = ego_reading_.Read(sample);
  odometry_.OnEgoMotion(read, ego_reading_.gyro().offset_radps(), ego_reading_.speed_factor());
}

std::optional<Reason> LocalPerception::OnRadarScan(const RadarScan& scan,
                                                   RadarPreparation& prepared, LocalFrame& frame) {
  const auto radar = static_cast<std::size_t>(scan.radar);
  if (!odometry_.StateAt(scan.stamp)) return Reason::kNoEgoMotion;
  if (const auto since = ego_reading_.OnRadarScan(scan, vehicle_->radars[radar])) {
    OnEgoMotion(EgoMotion(ego_reading_.newest()));
    tracker_.ForgetUnpicturedSince(*since);
  }
  const auto ego = odometry_.StateAt(scan.stamp);
  if (!prepared.is_ready || prepared.ego != *ego) {
    radar_preprocessor_.Process(scan, vehicle_->radars[radar], *ego, prepared.measurements);
    prepared.ego = *ego;
    prepared.is_ready = true;
  }
  tracker_.Predict(scan.stamp);
  Look(*ego);
  tracker_.UpdateRadar(scan.radar, *ego, prepared.measurements, [&](const LocalTrack& track) {
    return DetectabilityOf(Kind::kRadar, scan.radar, *ego, track);
  });
  SeeThrough();
  visibility_.AccumulateStatic(scan.stamp, *ego, prepared.measurements);
  last_radar_[radar] = scan.stamp;
  Finish(*ego, frame);
  return std::nullopt;
}

std::optional<Reason> LocalPerception::OnCameraDetections(const CameraDetections& detections,
                                                          LocalFrame& frame) {
  const auto ego = odometry_.StateAt(detections.stamp);
  if (!ego) return Reason::kNoEgoMotion;
  const auto camera = static_cast<std::size_t>(detections.camera);
  ProcessCamera(detections, vehicle_->cameras[camera], camera_measurements_);
  tracker_.Predict(detections.stamp);
  Look(*ego);
  tracker_.UpdateCamera(detections.camera, *ego, camera_measurements_,
                        [&](const LocalTrack& track) {
                          return DetectabilityOf(Kind::kCamera, detections.camera, *ego, track);
                        });
  last_camera_[camera] = detections.stamp;
  Finish(*ego, frame);
  return std::nullopt;
}

// Only tracks that are believed may hide others: a ghost that hid a real car would make the real
// car's misses look innocent.
void LocalPerception::Look(const EgoState& ego) {
  occluders_.clear();
  for (const LocalTrack& track : tracker_.tracks()) {
    if (track.is_confirmed) occluders_.push_back(FootprintOf(track));
  }
  visibility_.SetScene(ego, occluders_);
}

// Multipath ghosts behind a wall must not make it transparent: a camera has seen the vehicle too.
void LocalPerception::SeeThrough() {
  const auto tracks = tracker_.tracks();
  for (const SensorUpdate& update : tracker_.updates()) {
    const auto* z = std::get_if<RadarMeasurement>(&update.measurement);
    const auto track = std::ranges::lower_bound(tracks, update.track_id, {}, &LocalTrack::id);
    if (z == nullptr || track == tracks.end() || track->id != update.track_id) continue;
    if (track->is_confirmed && track->camera_hits >= kSureHits) visibility_.SeeThrough(*z);
  }
}

Detectability LocalPerception::DetectabilityOf(Kind kind, int sensor, const EgoState& ego,
                                               const LocalTrack& track) const {
  const Occluder footprint = FootprintOf(track);
  const bool is_radar = kind == Kind::kRadar;
  Detectability result;
  SensorView seen;
  if (IsJustSeen(track, ego.stamp)) {  // Then the other sensors need not be asked.
    result.visibility = Visibility::kVisible;
    seen = is_radar ? visibility_.FromRadar(sensor, footprint)
                    : visibility_.FromCamera(sensor, footprint);
  } else {
    const VisibilityMap::Answer answer = is_radar ? visibility_.AskRadar(sensor, footprint)
                                                  : visibility_.AskCamera(sensor, footprint);
    seen = answer.sensor;
    result.visibility = VisibilityOf(answer.overall);
  }

  result.visible_share = seen.uncovered;
  result.left_is_covered = seen.left_is_covered;
  result.right_is_covered = seen.right_is_covered;
  const auto index = static_cast<std::size_t>(sensor);
  if (seen.view == View::kOutOfView) return result;  // With probability 0.
  double full = 0.0;
  if (is_radar) {
    const RadarConfig& radar = vehicle_->radars[index];
    full = radar.detection_probability *
           RangeFade(DistanceToSensor(ego, radar.x_m, radar.y_m, track), radar.max_range_m);
  } else {
    const CameraConfig& camera = vehicle_->cameras[index];
    full = camera.detection_probability *
           RangeFade(DistanceToSensor(ego, camera.x_m, camera.y_m, track), camera.max_range_m);
  }
  switch (seen.view) {
    case View::kClear:
      result.probability = full * seen.uncovered;
      break;
    case View::kUnknown:
      result.probability = std::min(full * seen.uncovered, kUnknownDetection);
      break;
    case View::kOccluded:
      result.probability = std::min(full, kHiddenDetection);
      break;
    case View::kOutOfView:
      break;
  }
  return result;
}

void LocalPerception::Finish(const EgoState& ego, LocalFrame& frame) {
  newest_ = std::max(newest_, ego.stamp);
  frame.stamp = ego.stamp;
  frame.ego = ego;
  frame.tracks.assign(tracker_.tracks().begin(), tracker_.tracks().end());
  frame.updates.assign(tracker_.updates().begin(), tracker_.updates().end());
  radar_alive_.clear();
  camera_alive_.clear();
  for (std::size_t i = 0; i < last_radar_.size(); ++i) {
    radar_alive_.push_back(IsRadarAlive(static_cast<int>(i)) ? 1 : 0);
  }
  for (std::size_t i = 0; i < last_camera_.size(); ++i) {
    camera_alive_.push_back(IsCameraAlive(static_cast<int>(i)) ? 1 : 0);
  }
  frame.sectors = visibility_.Sectors(radar_alive_, camera_alive_);
}

bool LocalPerception::IsRadarAlive(int radar) const {
  const auto index = static_cast<std::size_t>(radar);
  return last_radar_[index] != Timestamp{} &&
         newest_ - last_radar_[index] <=
             FromSeconds(kSilentPeriods * vehicle_->radars[index].period_s);
}

bool LocalPerception::IsCameraAlive(int camera) const {
  const auto index = static_cast<std::size_t>(camera);
  return last_camera_[index] != Timestamp{} &&
         newest_ - last_camera_[index] <=
             FromSeconds(kSilentPeriods * vehicle_->cameras[index].period_s);
}

}  // namespace v2vouch
