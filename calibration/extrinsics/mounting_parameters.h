// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "daemon/common/data/vehicle.h"

namespace v2vouch {

/// How well the mounting is known before the drive: 1 sigma of a tape measure and a spirit level.
struct MountingPriors {
  double place_m = 0.05;                ///< Radar x, y; camera x, y, z.
  double angle_rad = FromDegrees(1.0);  ///< Radar yaw; camera yaw, pitch, roll.
  double antenna_m = 0.3;               ///< GNSS lever arm.
  double heading_bias_rad = FromDegrees(0.7);
  double speed_scale = 0.02;
  double yaw_rate_bias_radps = FromDegrees(0.3);
  double odometer_y_m = 0.02;  ///< Where the odometer's speed holds: the one anchor across the car.
  double slip_s2pm = 5e-4;     ///< Rear-axle slip k: lateral speed = -k v^2 yaw rate.
};

/// All quantities of stage A as one vector, in SI and radians:
///
///     radar k:  x, y, yaw            camera c:  x, y, z, yaw, pitch, roll
///     ego:  antenna x, antenna y, heading bias, speed scale, yaw rate bias, odometer y, slip
///
/// Measured speed = scale (v - odometer_y omega); measured yaw rate = omega + bias; measured
/// heading = yaw + heading bias, counter-clockwise positive. Frames and signs of the mounting:
/// data/vehicle.h.
class MountingParameters {
 public:
  static constexpr int kPerRadar = 3;
  static constexpr int kPerCamera = 6;
  static constexpr int kEgo = 7;
  enum Ego { kAntennaX, kAntennaY, kHeadingBias, kSpeedScale, kYawRateBias, kOdometerY, kSlip };

  /// @param knows_camera_places whether targets are points: else how far reflections lie from where
  ///        a box's foot is shifts a camera's x and y more than the tape measure's doubt.
  MountingParameters(const VehicleConfig& vehicle, const MountingPriors& priors,
                     bool knows_camera_places = true);

  struct Description {
    std::string name;    ///< radar_front.yaw_deg
    std::string sensor;  ///< radar_front
    double prior = 0.0;  ///< SI, radians, as the values.
    double prior_std = 1.0;
    double to_unit = 1.0;    ///< From SI to the unit the name ends with.
    bool is_anchor = false;  ///< Physics says what the data need not: its prior counts as data.
    /// Held at the prior, its doubt passed on to the others: what the data say of it is not it.
    bool is_considered = false;

    /// Sigma of the prior as an equation: what is considered only is as good as fixed.
    [[nodiscard]] double equation_std() const {
      constexpr double kHeld = 1e-3;
      return is_considered ? kHeld * prior_std : prior_std;
    }
  };
  [[nodiscard]] const std::vector<Description>& descriptions() const { return descriptions_; }
  [[nodiscard]] int size() const { return static_cast<int>(values_.size()); }
  [[nodiscard]] int radars() const { return radars_; }
  [[nodiscard]] int cameras() const { return cameras_; }

  [[nodiscard]] int RadarAt(int radar) const { return kPerRadar * radar; }
  [[nodiscard]] int CameraAt(int camera) const { return kPerRadar * radars_ + kPerCamera * camera; }
  [[nodiscard]] int EgoAt() const { return kPerRadar * radars_ + kPerCamera * cameras_; }

  std::vector<double>& values() { return values_; }
  [[nodiscard]] const std::vector<double>& values() const { return values_; }
  double* Radar(int radar) { return values_.data() + RadarAt(radar); }
  double* Camera(int camera) { return values_.data() + CameraAt(camera); }
  double* Ego() { return values_.data() + EgoAt(); }
  [[nodiscard]] const double* Radar(int radar) const { return values_.data() + RadarAt(radar); }
  [[nodiscard]] const double* Camera(int camera) const { return values_.data() + CameraAt(camera); }
  [[nodiscard]] const double* Ego() const { return values_.data() + EgoAt(); }

 private:
  int radars_;
  int cameras_;
  std::vector<double> values_;
  std::vector<Description> descriptions_;
};

}  // namespace v2vouch
