// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "sim/world/path.h"
#include "sim/world/scenario.h"

namespace v2vouch::sim {

/// Truth of one vehicle at one instant, world frame W.
struct Motion {
  Vec2 centre = Vec2::Zero();    ///< Of the footprint.
  Vec2 velocity = Vec2::Zero();  ///< Of that point [m/s].
  double yaw_rad = 0.0;          ///< Continuous in time, not wrapped.
  double speed_mps = 0.0;        ///< Along yaw.
  double yaw_rate_radps = 0.0;
  double accel_mps2 = 0.0;  ///< Along yaw.
};

/// Distance from the rear axle, which follows the path, to the centre of the footprint, as a share
/// of the length. So the centre swings out in a bend as that of a real car does.
inline constexpr double kCentreAheadOfAxle = 0.28;

/// Where `drive` is beside its route, left positive, lane changes included.
double LateralOffset(const DriveSpec& drive, double time_s);

/// A vehicle's motion over time, tabulated every 10 ms and read in between.
class Trajectory {
 public:
  /// Drives `drive` along `path` for `duration_s`.
  /// @param centre_ahead_m from the point that follows the path to the centre of the footprint.
  static Trajectory Drive(const Path& path, const DriveSpec& drive, double length_m,
                          double centre_ahead_m, double duration_s);

  /// Rows of recorded motion of one vehicle, in order of time.
  struct Row {
    double time_s;
    Vec2 centre;
    double yaw_rad;
  };
  /// Cubic through the rows, smoothed over one second (recorded lane-based traffic has kinks).
  /// Yaw is the rows' own, smoothed the same. At least two rows.
  static Trajectory Follow(const std::vector<Row>& rows);

  /// Stands for ever.
  static Trajectory Stand(const Vec2& centre, double yaw_rad);

  [[nodiscard]] Motion At(double time_s) const;
  /// False before the first and after the last recorded row.
  [[nodiscard]] bool Exists(double time_s) const;

 private:
  static constexpr double kStep_s = 0.01;
  // Fills velocity, yaw rate and acceleration from places and yaws.
  void Differentiate();

  double start_s_ = 0.0;
  double end_s_ = 1e18;
  std::vector<Motion> table_;
};

/// Vehicles of a trajectory file.
struct Recorded {
  ObjectClass object_class = ObjectClass::kCar;
  double length_m = 4.5;
  double width_m = 1.8;
  std::vector<Trajectory::Row> rows;
};
bool LoadTrajectories(const std::string& path, std::map<std::uint32_t, Recorded>& vehicles,
                      std::vector<std::string>& problems);

}  // namespace v2vouch::sim
