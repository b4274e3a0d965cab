// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "daemon/common/base/reason.h"
#include "daemon/common/base/scratch.h"
#include "daemon/common/data/track.h"
#include "daemon/local/odometry/ego_reading.h"
#include "daemon/local/odometry/odometry.h"
#include "daemon/local/perception/local_config.h"
#include "daemon/local/radar/radar_preprocessing.h"
#include "daemon/local/tracking/tracker.h"
#include "daemon/local/visibility/visibility.h"

namespace v2vouch {

/// What preprocessing made of a scan, kept beside it: a re-run whose ego motion is the same takes
/// it as it is.
struct RadarPreparation {
  bool is_ready = false;
  EgoState ego;
  std::vector<RadarMeasurement> measurements;
};

/// LOCAL: what the own sensors and the ego's own motion say, and nothing else. No GNSS and no V2V
/// type appears in this interface, which is why no such message can change a bit of the list.
/// Inputs must come in order of time; the timeline restores copies when one is late.
class LocalPerception {
 public:
  explicit LocalPerception(const LocalConfig& config);

  void OnEgoMotion(const EgoMotion& sample);

  /// One frame: preprocess, predict, set the scene, associate, update. `frame` is reused.
  /// @return why the frame could not be used (then `frame` is untouched), or nullopt.
  std::optional<Reason> OnRadarScan(const RadarScan& scan, RadarPreparation& prepared,
                                    LocalFrame& frame);
  std::optional<Reason> OnCameraDetections(const CameraDetections& detections, LocalFrame& frame);
  std::optional<Reason> OnObjectList(const ObjectList& list, LocalFrame& frame);

  [[nodiscard]] const EgoOdometry& odometry() const { return odometry_; }
  /// How EGO_MOTION is read: what was learnt and corrected.
  [[nodiscard]] const EgoReading& ego_reading() const { return ego_reading_; }
  /// What each sensor can see, as of the last frame.
  [[nodiscard]] const VisibilityMap& visibility() const { return visibility_; }
  /// Tracks lost to numerics or overflow in the last frame.
  [[nodiscard]] std::span<const Reason> failures() const { return tracker_.failures(); }

  /// Whether a sensor has spoken within three of its periods, by the newest frame's time.
  [[nodiscard]] bool IsAlive(SensorKey sensor) const;

 private:
  void Look(const EgoState& ego);
  void SeeThrough();
  [[nodiscard]] Detectability DetectabilityOf(SensorKey sensor, const EgoState& ego,
                                              const LocalTrack& track) const;
  void Finish(SensorKey sensor, const EgoState& ego, LocalFrame& frame);

  std::shared_ptr<const VehicleConfig> vehicle_;
  std::shared_ptr<const std::vector<SensorKey>> sensors_;  // AllSensors() of it.
  EgoReading ego_reading_;
  EgoOdometry odometry_;
  RadarPreprocessor radar_preprocessor_;
  VisibilityMap visibility_;
  Tracker tracker_;
  Timestamp newest_{};
  std::vector<Timestamp> last_heard_;  // In the order of `sensors_`.
  // Working memory of one frame.
  Scratch<std::vector<CameraMeasurement>> camera_measurements_;
  Scratch<std::vector<BoxMeasurement>> boxes_;
  Scratch<std::vector<Occluder>> occluders_;
  Scratch<std::vector<char>> alive_;
};

}  // namespace v2vouch
