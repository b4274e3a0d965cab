// SPDX-License-Identifier: Apache-2.0
// Blocks that change where a vehicle is said to be and how it moves.
#include <algorithm>
#include <cmath>

#include "sim/attacks/change.h"

namespace v2vouch::sim {
namespace {

// A vector given along the claimed heading and to the left of it, plus one in W.
Vec2 Turned(const Statement& said, double along, double left, double east, double north) {
  const Vec2 forward = Direction(said.yaw_rad);
  return along * forward + left * LeftOf(forward) + Vec2(east, north);
}

}  // namespace

void Change::Alter(const OffsetSpec& spec, const Moment&, Message& message) {
  if (IsToBeDrawn(spec.draw)) {
    const auto part = [&]() -> double {
      const double length = random_.Uniform(spec.low_m, spec.high_m);
      return random_.Bernoulli(0.5) ? length : -length;
    };
    const double east = part();
    const double north = part();
    drawn_place_ = Vec2(east, north) + spec.distance_m * Direction(random_.Uniform(0.0, 2.0 * kPi));
  }
  message.said.centre +=
      Turned(message.said, spec.along_m, spec.left_m, spec.east_m, spec.north_m) + drawn_place_;
}

void Change::Alter(const DriftSpec& spec, const Moment& now, Message& message) {
  Statement& said = message.said;
  const Vec2 rate = Turned(said, spec.along_mps, spec.left_mps, spec.east_mps, spec.north_mps);
  const double lasts_s =
      spec.limit_m > 0.0 && !rate.isZero() ? spec.limit_m / rate.norm() : now.elapsed_s + 1.0;
  said.centre += std::min(now.elapsed_s, lasts_s) * rate;
  if (!spec.consistent || now.elapsed_s >= lasts_s) return;
  const Vec2 velocity = said.speed_mps * Direction(said.yaw_rad) + rate;
  const bool backs_up = said.speed_mps < 0.0;
  const Vec2 front = backs_up ? Vec2(-velocity) : velocity;
  said.speed_mps = backs_up ? -velocity.norm() : velocity.norm();
  const double yaw = std::atan2(front.y(), front.x());
  said.yaw_rad += AngleDifference(yaw, said.yaw_rad);
}

void Change::Alter(const BrakeSpec& spec, const Moment& now, Message& message) {
  if (now.number == 0) first_ = message.said;
  const double v = std::abs(first_.speed_mps);
  const double stops_s = v / spec.decel_mps2;
  const double braked_s = std::min(now.elapsed_s, stops_s);
  const double way = v * braked_s - 0.5 * spec.decel_mps2 * braked_s * braked_s;
  const double sign = first_.speed_mps < 0.0 ? -1.0 : 1.0;
  Statement& said = message.said;
  said.centre = first_.centre + sign * way * Direction(first_.yaw_rad);
  said.yaw_rad = first_.yaw_rad;
  said.yaw_rate_radps = 0.0;
  said.speed_mps = sign * (v - spec.decel_mps2 * braked_s);
  said.accel_mps2 = now.elapsed_s < stops_s ? -sign * spec.decel_mps2 : 0.0;
  said.accel_lat_mps2 = 0.0;
  said.brakes = Brakes::kOn;
}

void Change::Alter(const FreezeSpec& spec, const Moment& now, Message& message) {
  if (now.number == 0) first_ = message.said;
  if (spec.position) message.said.centre = first_.centre;
  if (spec.speed) message.said.speed_mps = first_.speed_mps;
  if (spec.heading) message.said.yaw_rad = first_.yaw_rad;
}

void Change::Alter(const EventualStopSpec& spec, const Moment& now, Message& message) {
  if (now.number == 0) has_stopped_ = false;
  if (!has_stopped_ && random_.Bernoulli(spec.probability + spec.growth * now.number)) {
    has_stopped_ = true;
    first_ = message.said;
  }
  acts_ = has_stopped_;
  if (!has_stopped_) return;
  message.said.centre = first_.centre;
  message.said.yaw_rad = first_.yaw_rad;
  if (spec.zero_speed) {
    message.said.speed_mps = 0.0;
    message.said.accel_mps2 = 0.0;
    message.said.accel_lat_mps2 = 0.0;
    message.said.yaw_rate_radps = 0.0;
  }
}

void Change::Alter(const MirrorSpec& spec, const Moment& now, Message& message) {
  constexpr double kHalfLane_m = 1.75;
  double to_centre = spec.centre_left_m != 0.0 ? spec.centre_left_m : kHalfLane_m;
  if (spec.centre_left_m == 0.0) {
    for (const Actor& actor : scene_.world.actors()) {
      if (actor.id != message.vehicle) continue;
      for (const RouteSpec& route : scene_.world.scenario().routes) {
        if (route.name != actor.drive.route || route.centre_m == 0.0) continue;
        to_centre = route.centre_m - LateralOffset(actor.drive, now.time_s);
      }
    }
  }
  message.said.centre += 2.0 * to_centre * LeftOf(Direction(message.said.yaw_rad));
}

void Change::Alter(const RotateSpec& spec, const Moment& now, Message& message) {
  const Vec2 ego = scene_.world.At(now.time_s).ego.axle;
  const Vec2 way = message.said.centre - ego;
  const Vec2 turn = Direction(spec.about_ego_rad);
  message.said.centre = ego + turn.x() * way + turn.y() * LeftOf(way);
}

}  // namespace v2vouch::sim
