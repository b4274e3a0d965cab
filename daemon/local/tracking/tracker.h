// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/reason.h"
#include "daemon/common/base/scratch.h"
#include "daemon/common/data/track.h"
#include "daemon/common/data/vehicle.h"
#include "daemon/local/tracking/association.h"
#include "daemon/local/tracking/cluster_owner.h"
#include "daemon/local/tracking/clutter_map.h"
#include "daemon/local/tracking/detectability.h"
#include "daemon/local/tracking/one_vehicle.h"
#include "daemon/local/tracking/road_directions.h"
#include "daemon/local/tracking/standing_returns.h"
#include "daemon/local/tracking/track_table.h"
#include "daemon/local/tracking/tracker_config.h"

namespace v2vouch {

/// What a sensor of whole poses (PoseMeasurement) is like: a simulation's or a bench's.
struct PoseSensor {
  double period_s = 0.1;
  /// False poses per frame and square metre, their speeds, directions and yaw rates spread evenly
  /// over widths of so much.
  double clutter_per_m2 = 1e-5;
  double yaw_span_rad = 2.0 * kPi;
  double speed_span_mps = 30.0;
  double yaw_rate_span_radps = 0.5;
};

/// What a sensor of boxes (BoxMeasurement) is like: a bench's.
struct BoxSensor {
  double period_s = 0.1;
  double clutter_per_m2 = 1e-4;  ///< False boxes per frame and square metre, whatever their score.
};

/// Which pose or box of the last frame a track was given.
struct PoseUpdate {
  std::uint64_t track_id = 0;
  std::size_t pose = 0;
};

/// Multi-target tracker of LOCAL, in the odometry frame O: Bernoulli existence per track, EKF
/// (TrackFilter), association by log-likelihood ratio, birth from what is left. A step is Predict
/// and one update; each update reads as its recipe, and the parts own their state:
///
/// | part | what it owns and decides |
/// |---|---|
/// | TrackTable | the tracks, what is known of each, the time; listing and end (ListingRules) |
/// | Association | who gets which measurement, and existence from it (FrameDetectability) |
/// | ClusterOwners | which further clusters of a scan belong to a tracked vehicle |
/// | StandingReturns | what radars reflected of late; ranges of tracks that only cameras saw |
/// | RoadDirections | which way vehicles drive where; fronts of stationary ones |
/// | OneVehicle | two tracks that are one vehicle: the junior ends |
/// | own_body.h | a part of the ego itself, or what a camera sees through |
///
/// A moving radar cluster starts a track, a camera box too. A stationary cluster starts none; it
/// keeps alive what a camera named or what was seen moving, but makes its existence no likelier
/// than pictures and motion have: something that is no vehicle and stands there would be seen as
/// well. Copyable: a copy is a checkpoint. Same inputs, same bits.
class Tracker {
 public:
  Tracker(const TrackerConfig& config, const VehicleConfig& vehicle);

  /// Brings every track to `stamp` (>= the last one) and drops those that have ended: hidden for
  /// longer than hidden_hold_s, too uncertain, or no longer finite.
  void Predict(Timestamp stamp);

  /// One radar scan: associate, update, start. `detectability` answers for this radar. Measurements
  /// that are not finite are skipped.
  void UpdateRadar(int radar, const EgoState& ego, std::span<const RadarMeasurement> measurements,
                   const DetectabilityOf& detectability);

  /// One picture.
  void UpdateCamera(int camera, const EgoState& ego,
                    std::span<const CameraMeasurement> measurements,
                    const DetectabilityOf& detectability);

  /// One frame of a configured source of objects, in O: boxes update tracks, start and confirm
  /// them, and their absence where the source could have seen a vehicle speaks against it. Refused
  /// boxes (FaultOf) and a crowd that is none of vehicles stand in failures().
  void UpdateObjects(int source, const EgoState& ego, std::span<const BoxMeasurement> boxes,
                     const DetectabilityOf& detectability);

  /// One frame of poses, in O. The likelihood of clutter covers position, speed, yaw and yaw rate;
  /// any pose that no track explains starts one. Poses that FaultOf refuses are skipped, and stand
  /// in failures(). LOCAL only: updates() stays empty, pose_updates() tells who was given what.
  void UpdatePoses(const PoseSensor& sensor, std::span<const PoseMeasurement> poses,
                   const DetectabilityOf& detectability);
  [[nodiscard]] std::span<const PoseUpdate> pose_updates() const { return pose_updates_; }

  /// One frame of boxes, in O. A box's score weighs in by its log_odds. Refused boxes and
  /// pose_updates() as for poses.
  void UpdateBoxes(const BoxSensor& sensor, std::span<const BoxMeasurement> boxes,
                   const DetectabilityOf& detectability);

  /// The ego's own speed was misread since then: what radar alone has started from its Doppler is
  /// void, and standing returns must not keep it alive.
  void ForgetUnpicturedSince(Timestamp since);

  /// All tracks, unconfirmed ones included, ordered by id.
  [[nodiscard]] std::span<const LocalTrack> tracks() const { return table_.tracks(); }
  /// Which measurement each track was given by the last update; clusters of one vehicle as one.
  [[nodiscard]] std::span<const SensorUpdate> updates() const { return updates_; }
  /// Numerical failures, overflow and refused poses since the last Predict.
  [[nodiscard]] std::span<const Reason> failures() const { return table_.faults(); }

 private:
  void Begin(SensorKey sensor, const DetectabilityOf& detectability);
  /// What the frame says of the track by pictures or whole vehicles: proof, or a miss.
  void Prove(std::size_t i);
  void Conclude();

  void CompareClusters(const RadarLook& look, std::span<const RadarMeasurement> measurements);
  void CountEmptyLooks(const RadarLook& look);
  void TakeCluster(const RadarLook& look, SensorKey sensor, std::size_t i);
  void NoteReflection(const RadarLook& look, std::size_t i, const Eigen::Vector2d& p_O);
  void StartFromRadar(const RadarLook& look, SensorKey sensor,
                      std::span<const RadarMeasurement> measurements);

  void CompareCameraBoxes(const CameraLook& look, std::span<const CameraMeasurement> measurements);
  void TakeCameraBox(const CameraLook& look, SensorKey sensor, std::size_t i,
                     const CameraMeasurement& raw);
  void StartFromCamera(const CameraLook& look, SensorKey sensor,
                       std::span<const CameraMeasurement> measurements);

  /// What a frame of boxes or poses, which tell where a whole vehicle is, is measured by.
  struct WholeFrame {
    SensorKey sensor;
    std::optional<Eigen::Vector2d> origin_O{};  // Of a configured sensor.
    double log_point_cells = 0.0;               // AddPair's, for tracks that are points.
    std::size_t most_newcomers = TrackTable::kMostDetections;
    bool is_bench = true;
  };
  /// The frame once it has begun and its candidates stand: associate, update, start.
  template <class Measurement>
  void UpdateWhole(const WholeFrame& frame, std::span<const Measurement> measurements);
  template <class Measurement>
  void CompareWhole(const WholeFrame& frame, std::span<const Measurement> measurements);
  template <class Measurement>
  void TakeWhole(const WholeFrame& frame, std::size_t i, std::size_t j, const Measurement& raw);
  template <class Measurement>
  void StartWhole(const WholeFrame& frame, std::span<const Measurement> measurements);
  template <class Measurement>
  void NoteWhole(const WholeFrame& frame, std::uint64_t id, std::size_t j, const Measurement& z);

  TrackerConfig config_;
  std::shared_ptr<const VehicleConfig> vehicle_;
  double since_frame_s_ = 0.0;  // Since the last update.
  TrackTable table_;
  Association association_;
  ClusterOwners owners_;
  StandingReturns returns_;
  RoadDirections roads_;
  ClutterMap clutter_;
  OneVehicle one_vehicle_;
  std::vector<SensorUpdate> updates_;
  std::vector<PoseUpdate> pose_updates_;
  Scratch<std::vector<std::size_t>> newcomers_;
};

}  // namespace v2vouch
