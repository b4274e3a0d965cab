// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "daemon/common/base/random.h"
#include "daemon/common/data/measurement.h"
#include "daemon/common/data/track.h"
#include "daemon/common/data/vehicle.h"
#include "daemon/local/tracking/tracker.h"

namespace v2vouch {

/// A vehicle of the test world: a bicycle without slip, driven by acceleration and yaw rate.
struct Car {
  Eigen::Vector2d p_W = Eigen::Vector2d::Zero();
  double yaw_rad = 0.0;
  double speed_mps = 0.0;
  double accel_mps2 = 0.0;
  double yaw_rate_radps = 0.0;
  double length_m = 4.5;
  double width_m = 1.8;
  ObjectClass object_class = ObjectClass::kCar;
  bool is_hidden = false;  ///< No sensor sees it, and visibility says so.
  bool is_absent = false;  ///< No sensor sees it, though visibility says it should.
};

/// A small world with truth, an ego and its sensors, for tests of the tracker alone: measurements
/// are made as the preprocessing rooms would, from reflections on visible faces, by code that
/// shares nothing with the models.
class Scene {
 public:
  explicit Scene(std::uint64_t seed);

  std::vector<Car> cars;
  Car ego;
  VehicleConfig vehicle;
  bool extended = true;  ///< Reflections on faces; false: of the centre.
  double clutter = 0.0;  ///< False moving clusters per scan.
  int standing = 0;      ///< Standing clusters per scan, at fixed places beside the road.
  double detection_probability = 0.95;
  int split = 1;  ///< Clusters that one car falls into.

  /// Moves everything on.
  void Advance(double dt_s);
  [[nodiscard]] EgoState ego_state() const;
  [[nodiscard]] Timestamp now() const { return FromMicros(start_us_ + time_us_); }
  [[nodiscard]] double time_s() const { return static_cast<double>(time_us_) * 1e-6; }

  std::vector<RadarMeasurement> Scan(int radar);
  std::vector<CameraMeasurement> Picture(int camera);

  /// Predict and update with one scan / picture.
  void Radar(Tracker& tracker, int radar = 0);
  /// The same with a scan of it that was edited.
  void Radar(Tracker& tracker, const std::vector<RadarMeasurement>& scan, int radar = 0);
  void Camera(Tracker& tracker, int camera = 0);
  void Camera(Tracker& tracker, const std::vector<CameraMeasurement>& picture, int camera = 0);
  /// What visibility would answer: nominal probability, hidden and out-of-view cars.
  [[nodiscard]] Detectability Answer(const LocalTrack& track, double nominal, double half_fov_rad,
                                     const Eigen::Vector2d& sensor_B) const;

  /// Confirmed track nearest to the car within `reach_m`, or null.
  [[nodiscard]] static const LocalTrack* Find(const Tracker& tracker, const Car& car,
                                              double reach_m = 4.0);
  [[nodiscard]] static int Confirmed(const Tracker& tracker);

 private:
  [[nodiscard]] bool IsCovered(const Car& car) const;

  static constexpr std::int64_t start_us_ = 1'700'000'000'000'000;
  Random random_;
  std::int64_t time_us_ = 0;
  std::vector<Eigen::Vector2d> poles_;
};

/// One front radar (20 Hz; 0.25 m, 0.5 deg, 0.1 m/s) and one camera: the assumptions of the bounds
/// that the accuracy tests compare with.
VehicleConfig OneRadarOneCamera();

}  // namespace v2vouch
