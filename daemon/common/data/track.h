// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <vector>

#include "daemon/common/base/time.h"
#include "daemon/common/data/ego.h"
#include "daemon/common/data/input.h"
#include "daemon/common/data/measurement.h"
#include "daemon/common/data/sensor.h"

namespace v2vouch {

/// Order of the kinematic state everywhere: centre of the footprint in O, direction, speed along
/// it (negative in reverse), yaw rate, acceleration along it. Over ground, SI, radians.
enum StateIndex { kX = 0, kY = 1, kYaw = 2, kSpeed = 3, kYawRate = 4, kAccel = 5, kStateSize = 6 };
using StateVector = Eigen::Matrix<double, kStateSize, 1>;
using StateMatrix = Eigen::Matrix<double, kStateSize, kStateSize>;

struct KinematicState {
  StateVector mean = StateVector::Zero();
  StateMatrix covariance = StateMatrix::Identity();

  /// Over ground [m/s].
  [[nodiscard]] Eigen::Vector2d velocity() const {
    return mean[kSpeed] * Eigen::Vector2d(std::cos(mean[kYaw]), std::sin(mean[kYaw]));
  }
};

/// Footprint size with standard deviations [m].
struct Extent {
  double length_m = 4.5;
  double width_m = 1.8;
  double length_sigma_m = 1.0;
  double width_sigma_m = 0.3;
};

enum class Visibility : std::int8_t { kVisible = 0, kHidden = 1, kOutOfView = 2 };

/// One LOCAL track as the rest of the program sees it.
struct LocalTrack {
  std::uint64_t id = 0;  ///< TrackId of the detection that started it.
  Timestamp start{};
  KinematicState state_O;
  Extent extent;
  /// d(centre)/d(length) in O [m/m]: how the centre moves where the length turns out to be another
  /// than estimated. Half a length along the vehicle where only its near face was seen, 0 where
  /// both ends were.
  Eigen::Vector2d centre_by_length_O = Eigen::Vector2d::Zero();
  /// Of x and of y, in every list beside those of state_O: errors that are the same in look after
  /// look. Estimates and gates do without: no innovation tells of them.
  double lasting_variance_m2 = 0.0;
  bool is_point = false;  ///< Sensors report its centre: their models know no extent.
  ObjectClass object_class = ObjectClass::kUnknown;
  double existence = 0.0;     ///< Probability that a vehicle is there.
  bool is_confirmed = false;  ///< Published.
  Visibility visibility = Visibility::kVisible;
  SensorSupport support;

  [[nodiscard]] int radar_hits() const { return support.hits(SensorKind::kRadar); }
  [[nodiscard]] int camera_hits() const { return support.hits(SensorKind::kCamera); }
  [[nodiscard]] int object_hits() const { return support.hits(SensorKind::kObjects); }
  /// The extent that models of what sensors report of it must use.
  [[nodiscard]] Extent ModelExtent() const { return is_point ? Extent{0, 0, 0, 0} : extent; }
};

/// How well one sector round the car is watched.
enum class SectorState : std::int8_t { kWatched = 0, kDegraded = 1, kBlind = 2 };
struct SectorHealth {
  double from_rad = 0.0;  ///< Body azimuth; runs counter-clockwise to `to_rad`.
  double to_rad = 0.0;
  double range_m = 0.0;
  SectorState state = SectorState::kBlind;
};

/// What LOCAL knew after one own-sensor frame; all that the V2V side ever sees of it.
struct LocalFrame {
  Timestamp stamp{};
  EgoState ego;
  std::vector<LocalTrack> tracks;     ///< Ordered by id; unconfirmed ones included.
  std::vector<SensorUpdate> updates;  ///< Measurements given to tracks in this frame.
  std::vector<SectorHealth> sectors;
};

}  // namespace v2vouch
