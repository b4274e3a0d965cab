// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "daemon/common/base/time.h"
#include "daemon/common/frames/pose.h"

namespace v2vouch::evaluation {

/// Motion of one point of the plane: world frame W unless said otherwise.
struct PlanarMotion {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
  double speed_mps = 0.0;  ///< Along yaw, negative in reverse.
  double yaw_rate_radps = 0.0;
  double accel_mps2 = 0.0;  ///< Along yaw.

  [[nodiscard]] Eigen::Vector2d position() const { return {x_m, y_m}; }
  [[nodiscard]] Eigen::Vector2d direction() const { return {std::cos(yaw_rad), std::sin(yaw_rad)}; }
};

/// `motion` after `dt_s` (may be negative) at constant turn rate and constant acceleration; it does
/// not roll backwards out of a braking to rest. The evaluator's own: it shares nothing with the
/// filters it judges.
PlanarMotion Predict(const PlanarMotion& motion, double dt_s);

/// What one sensor could know of a true object at one sample.
struct TruthLook {
  std::string sensor;  ///< As the log names it.
  double detection_probability = 0.0;
  double visible_fraction = 0.0;
};

struct TruthSample {
  Timestamp stamp{};
  PlanarMotion motion;
  bool is_hidden = false;
  std::uint32_t sender = 0;  ///< TemporaryID in use; 0 = none.
  std::vector<TruthLook> looks;
};

/// Motion sampled at about 20 Hz, read at any time between its samples:
///
///     position  cubic Hermite through both samples' positions and velocities
///     yaw       cubic Hermite through both samples' yaws and yaw rates
///     others    linear
///
/// Error for a car at 20 Hz: below 1 mm. Nothing is extrapolated, and nothing is read across a gap
/// of more than `kMaxGap`.
class MotionSamples {
 public:
  static constexpr Duration kMaxGap{250'000};

  /// Stamps must rise; a sample that does not is passed over.
  void Add(TruthSample sample);
  [[nodiscard]] std::optional<PlanarMotion> At(Timestamp t) const;
  /// The sample in force at `t`: the newest not after it. Null where At() has nothing.
  [[nodiscard]] const TruthSample* InForce(Timestamp t) const;
  [[nodiscard]] const std::vector<TruthSample>& samples() const { return samples_; }

 private:
  [[nodiscard]] std::optional<std::size_t> IndexAt(Timestamp t) const;
  std::vector<TruthSample> samples_;
};

struct TruthObject {
  std::int64_t id = 0;
  int object_class = 0;  ///< Constants of track_t.
  bool has_v2v = false;  ///< At any time.
  double length_m = 0.0;
  double width_m = 0.0;
  double height_m = 0.0;
  MotionSamples motion;

  /// Pedestrians and cyclists are no vehicles.
  [[nodiscard]] bool is_vehicle() const { return object_class != 6 && object_class != 7; }
};

/// The truth of a run. The ego's motion is that of its rear axle.
struct Truth {
  MotionSamples ego;
  std::vector<TruthObject> objects;  ///< By id.

  [[nodiscard]] bool empty() const { return ego.samples().empty(); }
  [[nodiscard]] Timestamp begin() const { return ego.samples().front().stamp; }
  [[nodiscard]] Timestamp end() const { return ego.samples().back().stamp; }
  [[nodiscard]] std::optional<Pose<World, Body>> EgoPose(Timestamp t) const;
};

}  // namespace v2vouch::evaluation
