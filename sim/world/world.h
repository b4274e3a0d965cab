// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sim/world/actor.h"
#include "sim/world/scenario.h"
#include "sim/world/trajectory.h"

namespace v2vouch::sim {

/// A vehicle at one instant.
struct ActorState {
  const Actor* actor = nullptr;
  Motion motion;

  [[nodiscard]] Box box() const {
    return {motion.centre, motion.yaw_rad, actor->size.length_m, actor->size.width_m};
  }
  /// Velocity of the vehicle's point at `point` in W.
  [[nodiscard]] Vec2 VelocityAt(const Vec2& point) const {
    return motion.velocity + motion.yaw_rate_radps * LeftOf(point - motion.centre);
  }
};

/// The ego car at one instant: the rear axle, where body frame B has its origin.
struct EgoTruth {
  Vec2 axle = Vec2::Zero();
  double yaw_rad = 0.0;
  double speed_mps = 0.0;  ///< Of the axle along yaw.
  double yaw_rate_radps = 0.0;
  double accel_mps2 = 0.0;

  /// A point of the body frame in W, and its velocity.
  [[nodiscard]] Vec2 PointAt(double x_m, double y_m) const;
  [[nodiscard]] Vec2 VelocityAt(const Vec2& point) const;
};

struct Snapshot {
  double time_s = 0.0;
  EgoTruth ego;
  std::vector<ActorState> actors;  ///< Present ones, ordered by id; the ego is not among them.
};

struct Wall {
  std::vector<Vec2> outline;  ///< Closed, counter-clockwise.
  double height_m = 12.0;
};

/// A guard rail as a chain of straight pieces.
struct Rail {
  std::vector<Vec2> points;
};

/// Everything that is really there.
class World {
 public:
  /// Sensors of a family are drawn here (DrawSensors), so scenario() has them.
  /// @return nullptr with `problems` filled when a route cannot be driven or a file is bad.
  static std::unique_ptr<World> Make(const Scenario& given, std::uint64_t seed,
                                     std::vector<std::string>& problems);

  [[nodiscard]] Snapshot At(double time_s) const;
  [[nodiscard]] const Scenario& scenario() const { return scenario_; }
  /// The ego car as it really is: scenario().vehicle with its mounting errors.
  [[nodiscard]] const VehicleConfig& vehicle() const { return vehicle_; }
  [[nodiscard]] const std::vector<Actor>& actors() const { return actors_; }
  [[nodiscard]] const std::vector<Wall>& walls() const { return walls_; }
  [[nodiscard]] const std::vector<Vec2>& poles() const { return poles_; }
  [[nodiscard]] const std::vector<Rail>& rails() const { return rails_; }

 private:
  explicit World(const Scenario& scenario);

  Scenario scenario_;
  VehicleConfig vehicle_;
  Trajectory ego_;  // Of the centre of the ego's footprint.
  std::vector<Actor> actors_;
  std::vector<Wall> walls_;
  std::vector<Vec2> poles_;
  std::vector<Rail> rails_;
};

}  // namespace v2vouch::sim
