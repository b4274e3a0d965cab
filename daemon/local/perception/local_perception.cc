// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/perception/local_perception.h"

#include <algorithm>
#include <cmath>

#include "daemon/local/camera/camera_preprocessing.h"
#include "daemon/local/objects/object_preprocessing.h"

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
  const Timestamp last = track.support.last();
  return last != Timestamp{} && ToSeconds(now - last) <= kJustSeen_s;
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

// In clear view, at the track's distance.
template <class Sensor>
double FullDetection(const Sensor& sensor, const EgoState& ego, const LocalTrack& track) {
  const Point<Odometry> p_OS = ego.X_OB * Point<Body>{sensor.x_m, sensor.y_m};
  const double distance_m =
      std::hypot(track.state_O.mean[kX] - p_OS.x_m, track.state_O.mean[kY] - p_OS.y_m);
  return sensor.detection_probability * RangeFade(distance_m, sensor.max_range_m);
}

double FullDetection(const VehicleConfig& vehicle, SensorKey sensor, const EgoState& ego,
                     const LocalTrack& track) {
  const auto index = static_cast<std::size_t>(sensor.index);
  switch (sensor.kind) {
    case SensorKind::kRadar:
      return FullDetection(vehicle.radars[index], ego, track);
    case SensorKind::kCamera:
      return FullDetection(vehicle.cameras[index], ego, track);
    case SensorKind::kObjects:
      break;
  }
  return FullDetection(vehicle.objects[index], ego, track);
}

}  // namespace

LocalPerception::LocalPerception(const LocalConfig& config)
    : vehicle_(std::make_shared<const VehicleConfig>(config.vehicle)),
      sensors_(std::make_shared<const std::vector<SensorKey>>(vehicle_->AllSensors())),
      ego_reading_(config.ego_motion),
      radar_preprocessor_(config.radar),
      visibility_(config.visibility, config.vehicle),
      tracker_(config.tracking, config.vehicle),
      last_heard_(sensors_->size()) {}

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
    return DetectabilityOf({SensorKind::kRadar, scan.radar}, *ego, track);
  });
  SeeThrough();
  visibility_.AccumulateStatic(scan.stamp, *ego, prepared.measurements);
  Finish({SensorKind::kRadar, scan.radar}, *ego, frame);
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
  const SensorKey sensor{SensorKind::kCamera, detections.camera};
  tracker_.UpdateCamera(
      detections.camera, *ego, camera_measurements_,
      [&](const LocalTrack& track) { return DetectabilityOf(sensor, *ego, track); });
  Finish(sensor, *ego, frame);
  return std::nullopt;
}

std::optional<Reason> LocalPerception::OnObjectList(const ObjectList& list, LocalFrame& frame) {
  const auto ego = odometry_.StateAt(list.stamp);
  if (!ego) return Reason::kNoEgoMotion;
  const SensorKey sensor{SensorKind::kObjects, list.sensor};
  ProcessObjects(list, *vehicle_, *ego, boxes_);
  tracker_.Predict(list.stamp);
  Look(*ego);
  tracker_.UpdateObjects(list.sensor, *ego, boxes_, [&](const LocalTrack& track) {
    return DetectabilityOf(sensor, *ego, track);
  });
  Finish(sensor, *ego, frame);
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

// Multipath ghosts behind a wall must not make it transparent: a camera or a detector of boxes has
// seen the vehicle too.
void LocalPerception::SeeThrough() {
  const auto tracks = tracker_.tracks();
  for (const SensorUpdate& update : tracker_.updates()) {
    const auto* z = std::get_if<RadarMeasurement>(&update.measurement);
    const auto track = std::ranges::lower_bound(tracks, update.track_id, {}, &LocalTrack::id);
    if (z == nullptr || track == tracks.end() || track->id != update.track_id) continue;
    const int whole_hits = track->camera_hits() + track->object_hits();
    if (track->is_confirmed && whole_hits >= kSureHits) visibility_.SeeThrough(*z);
  }
}

Detectability LocalPerception::DetectabilityOf(SensorKey sensor, const EgoState& ego,
                                               const LocalTrack& track) const {
  const Occluder footprint = FootprintOf(track);
  Detectability result;
  SensorView seen;
  if (IsJustSeen(track, ego.stamp)) {  // Then the other sensors need not be asked.
    result.visibility = Visibility::kVisible;
    seen = visibility_.From(sensor, footprint);
  } else {
    const VisibilityMap::Answer answer = visibility_.Ask(sensor, footprint);
    seen = answer.sensor;
    result.visibility = VisibilityOf(answer.overall);
  }

  result.visible_share = seen.uncovered;
  result.left_is_covered = seen.left_is_covered;
  result.right_is_covered = seen.right_is_covered;
  if (seen.view == View::kOutOfView) return result;  // With probability 0.
  const double full = FullDetection(*vehicle_, sensor, ego, track);
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

void LocalPerception::Finish(SensorKey sensor, const EgoState& ego, LocalFrame& frame) {
  const auto heard = std::ranges::find(*sensors_, sensor) - sensors_->begin();
  last_heard_[static_cast<std::size_t>(heard)] = ego.stamp;
  newest_ = std::max(newest_, ego.stamp);
  frame.stamp = ego.stamp;
  frame.ego = ego;
  frame.tracks.assign(tracker_.tracks().begin(), tracker_.tracks().end());
  frame.updates.assign(tracker_.updates().begin(), tracker_.updates().end());
  alive_.clear();
  for (const SensorKey each : *sensors_) alive_.push_back(IsAlive(each) ? 1 : 0);
  frame.sectors = visibility_.Sectors(alive_);
}

bool LocalPerception::IsAlive(SensorKey sensor) const {
  const auto at = std::ranges::find(*sensors_, sensor);
  if (at == sensors_->end()) return false;
  const Timestamp last = last_heard_[static_cast<std::size_t>(at - sensors_->begin())];
  return last != Timestamp{} &&
         newest_ - last <= FromSeconds(kSilentPeriods * vehicle_->PeriodOf(sensor));
}

}  // namespace v2vouch
