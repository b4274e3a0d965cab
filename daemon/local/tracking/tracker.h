// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "daemon/common/assignment/assignment.h"
#include "daemon/common/base/angle.h"
#include "daemon/common/base/reason.h"
#include "daemon/common/base/scratch.h"
#include "daemon/common/base/visit.h"
#include "daemon/common/data/track.h"
#include "daemon/common/data/vehicle.h"
#include "daemon/common/models/ctra.h"
#include "daemon/local/tracking/candidates.h"
#include "daemon/local/tracking/crowd_shape.h"
#include "daemon/local/tracking/existence.h"
#include "daemon/local/tracking/glances.h"
#include "daemon/local/tracking/road_directions.h"
#include "daemon/local/tracking/track_filter.h"

namespace v2vouch {

/// Settings of LOCAL fusion: births, confirmation, existence and what is published.
struct TrackerConfig {
  MotionNoise motion;
  bool point_targets = false;          ///< Detections are of the centre: no extent model.
  double gate_probability = 0.9999;    ///< Of the chi-square gate.
  double birth_per_m2_s = 2e-6;        ///< Density of new vehicles.
  double confirm_existence = 0.95;     ///< Published from here on ...
  double keep_existence = 0.5;         ///< ... until it falls below this.
  double delete_existence = 0.01;      ///< Once published, dropped below this.
  int confirm_hits = 3;                ///< Looks that saw it, all sensors, before it is published.
  double survival_per_s = 0.999;       ///< Probability to still be there after one second.
  double hidden_hold_s = 8.0;          ///< A hidden track is kept at most this long without a hit.
  double max_position_sigma_m = 5.0;   ///< A less certain track is not published anew.
  double list_cutoff_m = 4.0;          ///< c of the rule that ends a coasting track, see Tracker.
  double miss_memory_s = 0.15;         ///< Misses of a published track closer than this are one.
  double camera_birth_range_m = 60.0;  ///< Farther out, boxes alone publish nothing.
  int max_tracks = 512;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("motion", motion);
    a.Field("point_targets", point_targets);
    a.Field("gate_probability", gate_probability, {.above = 0.5, .below = 1.0});
    a.Field("birth_per_m2_s", birth_per_m2_s, {.above = 0.0, .at_most = 1.0});
    a.Field("confirm_existence", confirm_existence, {.above = 0.0, .below = 1.0});
    a.Field("keep_existence", keep_existence, {.above = 0.0, .below = 1.0});
    a.Field("delete_existence", delete_existence, {.above = 0.0, .below = 1.0});
    a.Field("confirm_hits", confirm_hits, {.at_least = 1, .at_most = 100});
    a.Field("survival_per_s", survival_per_s, {.above = 0.0, .at_most = 1.0});
    a.Field("hidden_hold_s", hidden_hold_s, {.above = 0.0, .at_most = 30.0});
    a.Field("max_position_sigma_m", max_position_sigma_m, {.above = 0.1, .at_most = 100.0});
    a.Field("list_cutoff_m", list_cutoff_m, {.above = 0.1, .at_most = 100.0});
    a.Field("miss_memory_s", miss_memory_s, {.at_least = 0.0, .at_most = 5.0});
    a.Field("camera_birth_range_m", camera_birth_range_m, {.at_least = 0.0, .at_most = 200.0});
    a.Field("max_tracks", max_tracks, {.at_least = 1, .at_most = 4096});
  }
};

/// How likely one sensor is to detect a track at this moment, from visibility, in [0, 1], and how
/// the sensors together see it (VisibilityMap::Overall), which the track shows. Asked once per
/// track and frame.
struct Detectability {
  double probability = 0.0;
  Visibility visibility = Visibility::kVisible;
  double visible_share = 1.0;    ///< Of its azimuth span, to this sensor.
  bool left_is_covered = false;  ///< Its left edge is hidden from this sensor or out of its view.
  bool right_is_covered = false;
};
using DetectabilityOf = std::function<Detectability(const LocalTrack&)>;

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

/// Multi-target tracker: Bernoulli existence per track, EKF in O (TrackFilter), association by
/// log-likelihood ratio with exact assignment in gated clusters, existence from marginals, birth
/// from what is left. Copyable: a copy is a checkpoint. Same inputs, same bits.
///
/// - A moving radar cluster starts a track, a camera box too. A stationary
///   cluster starts none; it keeps alive what a camera named or what was seen moving. Nothing is
///   published that was not seen twice by a camera or in motion.
/// - A track is published if that lowers expected squared GOSPA (p = 2): with D the expected
///   squared error cut off at c^2 and m the trace of the position covariance, where its existence r
///
///       r > c^2 / (2 (c^2 - D)),   D = m (1 - exp(-c^2 / m))
///
///   A coasting track that no longer fulfils this ends.
/// - Misses of a published track follow from each other: what the visibility did not know of hides
///   it in the next frame too. A frame after dt counts as min(1, dt / miss_memory_s) of one, which
///   also makes a track's end a matter of time and not of the sensors' rates.
/// - A standing return keeps a track alive but makes its existence no likelier than pictures and
///   motion have: something that is no vehicle and stands there would be seen as well.
/// - A box names a vehicle, but its range is a guess (4 m at 40 m): while no radar has seen the
///   track, it takes that of the nearest standing return inside the box's bearings and three sigma
///   of its range. What is nearer would cover the vehicle, what is farther is covered by it. Where
///   a return there moves, the box waits for a track of that.
/// - Two kinds of tracks without a picture are not published: one that has only ever been at
///   the car itself (water on a radome, a tow bar), and one through which a camera sees another
///   vehicle.
/// - A further cluster inside a tracked vehicle's footprint with its Doppler belongs to
///   that vehicle: it joins the measurement and starts nothing.
/// - Two tracks on one footprint with one velocity are one vehicle: the younger goes. So does
///   one on the axis behind a lorry's or bus's near face, as far as such a vehicle may reach,
///   unless one picture has shown both: the other is lengthened.
class Tracker {
 public:
  /// More tracks than this are not started by one frame.
  static constexpr std::size_t kMostNewcomers = 64;

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
  [[nodiscard]] std::span<const LocalTrack> tracks() const { return tracks_; }
  /// Which measurement each track was given by the last update; clusters of one vehicle as one.
  [[nodiscard]] std::span<const SensorUpdate> updates() const { return updates_; }
  /// Numerical failures, overflow and refused poses since the last Predict.
  [[nodiscard]] std::span<const Reason> failures() const { return failures_; }

  /// Identity of a track, positive in 63 bits and in the order of time: time in units of 512 us,
  /// kind of sensor (2 bits), its index (5) and the index of the detection that started it (12).
  static std::uint64_t PackId(Timestamp stamp, SensorKey sensor, std::size_t index);
  static constexpr std::size_t kMostDetections = 4096;  ///< Of one frame, as an id can hold them.

 private:
  struct Hidden {  // What the rest of the program need not see of a track.
    TrackFilter filter;
    Timestamp last_hit{};
    double proven = 0.0;  // Existence by pictures and motion alone.
    Eigen::Vector2d reflection_O = Eigen::Vector2d::Zero();  // Last cluster it was given,
    Timestamp reflected{};                                   // and when.
    Timestamp borne_out{};    // Last hit by what is no second echo of another.
    int borrowed = 0;         // Clusters out of an older vehicle's box, own ones taken off twice.
    int clear_hits = 0;       // Radar clusters from where the radar can see.
    int not_pictured = 0;     // Pictures that ought to have shown it.
    int moving_hits = 0;      // Radar clusters with a Doppler of their own.
    bool is_certain = false;  // Started by a bench's pose or box: however unlikely, it may stay.
    double overlap_s = 0.0;   // How long an older track has been in the same place.
    double part_s = 0.0;      // How long it could be the far end of a lorry or bus.
    std::array<double, 8> class_votes{};
    Glances glances;        // While its range is a camera's guess,
    bool has_range = true;  // which it no longer is.
    int apart_hits = 0;     // Radar clusters away from the car's own body, less those at it.
    bool is_apart = false;  // It has been away from there.
    int seen_through = 0;   // Pictures that showed a vehicle behind it.
    int moving_there = 0;   // Pictures in a row with something moving where it was guessed.
    bool is_far = false;    // Beyond camera_birth_range_m at its last box.
    bool is_dead = false;
  };
  struct RecentReturn {  // Moving, or standing and of no track.
    Fix fix;
    int radar = 0;
    int scans_ago = 0;
    int returns = 1;
    bool is_moving = false;
    double strength_db = 0.0;  // Of its strongest reflection, as from one metre.
  };
  struct InSight {  // A recent return within the bearings of a track's boxes.
    const RecentReturn* at = nullptr;
    double misfit = 0.0;
    double range_m = 0.0;
  };
  template <class Look, class Measurement>
  void GatePair(std::size_t track, std::size_t measurement, const Look& look, const Measurement& z);
  void AddPair(std::size_t track, std::size_t measurement, const Likelihood& likelihood,
               double log_cells);
  /// What a frame of boxes or poses is measured by.
  struct WholeFrame {
    SensorKey sensor;
    std::optional<Eigen::Vector2d> origin_O{};  // Of a configured sensor.
    double log_point_cells = 0.0;               // AddPair's, for tracks that are points.
    std::size_t most_newcomers = kMostDetections;
    bool is_bench = true;
  };
  void PrepareBoxes(const BoxSensor& sensor, std::span<const BoxMeasurement> boxes);
  void PreparePoses(const PoseSensor& sensor, std::span<const PoseMeasurement> poses);
  /// The frame once its candidates are prepared: associate, update, start.
  template <class Measurement>
  void UpdateWhole(const WholeFrame& frame, std::span<const Measurement> measurements,
                   const DetectabilityOf& detectability);
  template <class Measurement>
  void TakeWhole(const WholeFrame& frame, std::size_t track, const Measurement& raw);
  template <class Measurement>
  void StartWhole(const WholeFrame& frame, std::span<const Measurement> measurements);
  [[nodiscard]] double Crowd(std::size_t detections) const;
  void PrepareRadar(const RadarLook& look, std::span<const RadarMeasurement> measurements);
  void DenyEchoes(const RadarLook& look, std::span<const RadarMeasurement> measurements);
  void PrepareCamera(const CameraLook& look, std::span<const CameraMeasurement> measurements);
  void AskDetectability(SensorKey sensor, const DetectabilityOf& detectability);
  [[nodiscard]] bool IsWorthListing(std::size_t track) const;
  [[nodiscard]] bool IsOverdue(std::size_t track) const;
  /// The measurement as one of this track, with what visibility knows about its edges.
  [[nodiscard]] RadarMeasurement Given(std::size_t track, const RadarMeasurement& z) const;
  [[nodiscard]] CameraMeasurement Given(std::size_t track, const CameraMeasurement& z) const;
  [[nodiscard]] BoxMeasurement Given(std::size_t track, const BoxMeasurement& z) const;
  /// Whether a hit is independent proof: radars and cameras see the same ghosts again and again.
  enum class Proof { kIndependent, kRepeated };
  void Associate(std::size_t measurements, Proof proof);
  void TakeFaces(const RadarLook& look, std::span<const RadarMeasurement> measurements);
  void AbsorbClusters(const RadarLook& look, std::span<const RadarMeasurement> measurements);
  [[nodiscard]] bool Owns(std::size_t track, const RadarLook& look, const RadarMeasurement& z,
                          const Eigen::Vector2d& p_O) const;
  [[nodiscard]] bool SeenAsTwo(std::size_t a, std::size_t b) const;
  [[nodiscard]] bool Covers(std::size_t track, const CameraLook& look, const CameraMeasurement& z,
                            const Fix& fix) const;
  /// Leaves the nearest of the measurements named, in their order. @return whether any had to go.
  static bool KeepNearest(std::span<const RadarMeasurement> measurements, std::size_t most,
                          std::vector<int>& which);
  void KeepReturns(const RadarLook& look, int radar,
                   std::span<const RadarMeasurement> measurements);
  struct Place {  // What the boxes of a track agree on.
    std::optional<Fix> standing;
    bool is_moving = false;
  };
  [[nodiscard]] Place FindPlace(const Glances& glances);
  void LearnRange(std::size_t track, const CameraLook& look, const CameraMeasurement& z);
  void Hit(std::size_t track, SensorKey sensor, bool is_echo = false);
  void Vote(std::size_t track, ObjectClass object_class, double score);
  /// False when the table is full.
  bool Start(const TrackFilter& filter, SensorKey sensor, std::size_t index, double existence);
  void JoinOwned(const RadarLook& look, std::span<const RadarMeasurement> measurements);
  void DropDuplicates(double dt_s);
  [[nodiscard]] bool IsWithin(std::size_t i, std::size_t j) const;
  void JoinParts(double dt_s);
  [[nodiscard]] std::optional<double> LengthWithPart(std::size_t i, std::size_t j) const;
  [[nodiscard]] bool IsAtOwnBody(const RadarLook& look, const Eigen::Vector2d& p_O) const;
  void NotePlace(std::size_t track, const RadarLook& look, const Eigen::Vector2d& p_O);
  [[nodiscard]] bool MayBeOwnBody(std::size_t track) const;
  void LookThrough(const CameraLook& look, std::span<const CameraMeasurement> measurements);
  [[nodiscard]] bool IsTransparent(std::size_t track) const;
  void StartFromRadar(const RadarLook& look, int radar,
                      std::span<const RadarMeasurement> measurements);
  void StartFromCamera(const CameraLook& look, int camera,
                       std::span<const CameraMeasurement> measurements);
  [[nodiscard]] int Hits(std::size_t track) const;
  [[nodiscard]] bool Borrows(std::size_t i, std::size_t j) const;
  [[nodiscard]] bool IsInAnothersBox(std::size_t i, const Eigen::Vector2d& p_O) const;
  [[nodiscard]] bool IsConvincing(std::size_t track) const;
  void LearnRoad(const EgoState& ego);
  void FaceAsTheRoad(std::size_t track);
  void Conclude(double dt_s);
  void DropUnlikely();
  void RemoveDead();

  TrackerConfig config_;
  std::shared_ptr<const VehicleConfig> vehicle_;
  FilterSettings settings_;
  std::array<double, Linearized::kMaxRows + 1> gate_{};
  Timestamp now_{};
  double since_update_s_ = 0.0;
  std::array<Timestamp, kSensorSlots> last_look_{};  // By SlotOf.
  std::vector<LocalTrack> tracks_;
  std::vector<Hidden> hidden_;
  std::vector<RecentReturn> recent_;  // Of each radar's last scans.
  RoadDirections roads_;
  std::vector<SensorUpdate> updates_;
  std::vector<PoseUpdate> pose_updates_;
  std::vector<Reason> failures_;

  // Working memory of one update.
  Scratch<Candidates> candidates_;
  Scratch<CrowdShape> crowd_shape_;
  Scratch<PlaceIndex> places_;
  Scratch<std::vector<RadarMeasurement>> joined_;
  Scratch<std::vector<double>> detection_, missing_, missed_, lone_;
  Scratch<std::vector<Detectability>> seen_;
  Scratch<std::vector<SparsePair>> costs_;
  Scratch<std::vector<GatedPair>> pairs_;
  Scratch<std::vector<int>> assigned_, owner_, newcomers_;
  Scratch<std::vector<InSight>> in_sight_;
  Scratch<ClusteredAssignmentSolver> solver_;
  Scratch<AssociationMarginals> marginals_;
};

}  // namespace v2vouch
