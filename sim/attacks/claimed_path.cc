// SPDX-License-Identifier: Apache-2.0
#include "sim/attacks/claimed_path.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

namespace v2vouch::sim {
namespace {

constexpr double kShadowNoiseTime_s = 5.0;
constexpr Size kCar{};

// Cells round (0, 0), nearest first: (1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), ...
std::pair<int, int> CellOf(int index) {
  std::vector<std::pair<int, int>> cells;
  const int reach = 1 + static_cast<int>(std::ceil(std::sqrt(index + 1.0)));
  for (int i = -reach; i <= reach; ++i) {
    for (int j = -reach; j <= reach; ++j) {
      if (i != 0 || j != 0) cells.emplace_back(i, j);
    }
  }
  const auto key = [](const std::pair<int, int>& c) {
    return std::tuple(c.first * c.first + c.second * c.second, -std::abs(c.first), -c.first,
                      -c.second);
  };
  std::sort(cells.begin(), cells.end(),
            [&](const auto& a, const auto& b) { return key(a) < key(b); });
  return cells[static_cast<std::size_t>(index)];
}

void BecomeNobody(Message& message) {
  message.vehicle = 0;
  message.honest.reset();
}

// A car with nothing but a place, so far.
Statement CarAt(double time_s, double semi_major_m) {
  Statement said;
  said.time_s = time_s;
  said.length_m = kCar.length_m;
  said.width_m = kCar.width_m;
  said.semi_major_m = semi_major_m;
  return said;
}

}  // namespace

Statement TrueStatement(const Actor& actor, double time_s) {
  const Motion motion = actor.trajectory.At(time_s);
  Statement said;
  said.time_s = time_s;
  said.centre = motion.centre;
  said.yaw_rad = motion.yaw_rad;
  said.speed_mps = motion.speed_mps;
  said.yaw_rate_radps = motion.yaw_rate_radps;
  said.accel_mps2 = motion.accel_mps2;
  said.accel_lat_mps2 = motion.speed_mps * motion.yaw_rate_radps;
  said.length_m = actor.size.length_m;
  said.width_m = actor.size.width_m;
  return said;
}

void CarryOn(Statement& said, double dt_s) {
  const double middle_rad = said.yaw_rad + 0.5 * dt_s * said.yaw_rate_radps;
  said.centre += dt_s * said.speed_mps * Direction(middle_rad);
  said.yaw_rad += dt_s * said.yaw_rate_radps;
  said.time_s += dt_s;
}

ClaimedPath::ClaimedPath(const PathSpec& spec, const AttackScene& scene,
                         std::optional<std::size_t> victim, int voice, const Random& random)
    : spec_(spec),
      scene_(scene),
      victim_(victim),
      random_(random),
      noise_east_(spec.shadow ? spec.shadow->noise_m : 0.0, kShadowNoiseTime_s, random_),
      noise_north_(spec.shadow ? spec.shadow->noise_m : 0.0, kShadowNoiseTime_s, random_) {
  if (spec.grid) {
    const auto [along, left] = CellOf(voice);
    const double stretch_along = 1.0 + random_.Uniform(-spec.grid->jitter, spec.grid->jitter);
    const double stretch_left = 1.0 + random_.Uniform(-spec.grid->jitter, spec.grid->jitter);
    cell_ = {along * stretch_along * (spec.grid->along_m + kCar.length_m),
             left * stretch_left * (spec.grid->across_m + kCar.width_m)};
    speed_scale_ = 1.0 + random_.Uniform(-spec.grid->speed_spread, spec.grid->speed_spread);
  }
}

bool ClaimedPath::Rewrite(const Moment& now, Message& message) {
  message.is_attack =
      message.is_attack || spec_.ghost || spec_.shadow || spec_.grid || spec_.behind;
  if (spec_.ghost) return Ghost(*spec_.ghost, now, message);
  if (spec_.shadow) return Shadow(*spec_.shadow, now, message);
  if (spec_.grid) return Grid(*spec_.grid, now, message);
  if (spec_.swap) return Swap(*spec_.swap, now, message);
  if (spec_.behind) return Behind(*spec_.behind, now, message);
  return true;
}

bool ClaimedPath::Ghost(const GhostSpec& spec, const Moment& now, Message& message) {
  const EgoTruth ego = scene_.world.At(now.time_s).ego;
  double ahead = spec.ahead_m;
  if (spec.at_stopping_distance) {
    const double v = ego.speed_mps;
    const double bumpers = 0.5 * (scene_.world.scenario().vehicle.length_m + kCar.length_m);
    ahead = 1.5 * v + v * v / 13.7 - 0.1 + bumpers;
  }
  double place_m = scene_.line.DistanceAt(now.time_s) + ahead;
  if (now.number == 0) anchor_m_ = place_m;
  const bool stands = spec.moves == GhostSpec::Moves::kStands;
  if (stands) place_m = anchor_m_;
  const double closer =
      std::min(spec.closing_m * now.number, std::max(0.0, ahead - spec.nearest_m));
  const EgoLine::Point point = scene_.line.At(place_m - closer);
  const EgoLine::Point next = scene_.line.At(place_m - closer + 1.0);
  Statement said = CarAt(now.time_s, spec.semi_major_m);
  said.centre = point.position + spec.left_m * LeftOf(Direction(point.yaw_rad));
  said.yaw_rad = point.yaw_rad;
  if (!stands) {
    said.speed_mps = ego.speed_mps;
    said.accel_mps2 = ego.accel_mps2;
    said.yaw_rate_radps = ego.speed_mps * AngleDifference(next.yaw_rad, point.yaw_rad);
    said.accel_lat_mps2 = said.speed_mps * said.yaw_rate_radps;
  }
  if (spec.accel_mps2) said.accel_mps2 = *spec.accel_mps2;
  message.said = said;
  BecomeNobody(message);
  return true;
}

bool ClaimedPath::Shadow(const ShadowSpec& spec, const Moment& now, Message& message) {
  if (!victim_) return false;
  const Actor& victim = scene_.world.actors()[*victim_];
  if (!victim.trajectory.Exists(now.time_s - spec.delay_s)) return false;
  const double dt = std::max(1e-3, now.time_s - last_time_s_);
  last_time_s_ = now.time_s;
  const double east = noise_east_.Step(dt, random_);
  const double north = noise_north_.Step(dt, random_);
  message.said = TrueStatement(victim, now.time_s - spec.delay_s);
  message.said.centre += Vec2(east, north);
  message.said.semi_major_m = spec.semi_major_m;
  message.vehicle = victim.id;
  message.honest = TrueStatement(victim, now.time_s);
  message.honest->centre += message.error;
  return true;
}

bool ClaimedPath::Grid(const GridSpec& spec, const Moment& now, Message& message) {
  Statement said = message.said;
  if (spec.round == GridSpec::Round::kVehicle) {
    if (!victim_) return false;
    const Actor& victim = scene_.world.actors()[*victim_];
    if (!victim.trajectory.Exists(now.time_s)) return false;
    said = TrueStatement(victim, now.time_s);
    said.semi_major_m = message.said.semi_major_m;
  }  // Round the ego: a device tells of the ego anyway; a vehicle has to be told.
  if (spec.round == GridSpec::Round::kEgo) {
    const EgoTruth ego = scene_.world.At(now.time_s).ego;
    said.centre = ego.PointAt(scene_.world.scenario().vehicle.centre_x_m, 0.0);
    said.yaw_rad = ego.yaw_rad;
    said.speed_mps = ego.speed_mps;
    said.yaw_rate_radps = ego.yaw_rate_radps;
    said.accel_mps2 = ego.accel_mps2;
    said.accel_lat_mps2 = ego.speed_mps * ego.yaw_rate_radps;
  }
  const Vec2 along = Direction(said.yaw_rad);
  said.centre += cell_.x() * along + cell_.y() * LeftOf(along);
  said.speed_mps *= speed_scale_;
  said.length_m = kCar.length_m;
  said.width_m = kCar.width_m;
  message.said = said;
  BecomeNobody(message);
  return true;
}

void ClaimedPath::PlanSwap(const SwapSpec& spec, const Message& message, double from_s) {
  constexpr double kStep_s = 0.1;
  const auto& actors = scene_.world.actors();
  const auto own = std::find_if(actors.begin(), actors.end(),
                                [&](const Actor& a) { return a.id == message.device; });
  if (own == actors.end()) return;
  double nearest_m = spec.within_m;
  for (double t = from_s; t < scene_.world.scenario().duration_s; t += kStep_s) {
    if (!own->trajectory.Exists(t)) continue;
    const Vec2 place = own->trajectory.At(t).centre;
    for (std::size_t i = 0; i < actors.size(); ++i) {
      if (actors[i].id == own->id || !actors[i].trajectory.Exists(t)) continue;
      const double distance = (actors[i].trajectory.At(t).centre - place).norm();
      if (distance >= nearest_m) continue;
      nearest_m = distance;
      other_ = i;
      swap_at_s_ = t;
    }
  }
}

bool ClaimedPath::Swap(const SwapSpec& spec, const Moment& now, Message& message) {
  if (now.number == 0) PlanSwap(spec, message, now.time_s);
  if (!other_ || now.time_s < swap_at_s_) return true;
  const Actor& other = scene_.world.actors()[*other_];
  if (!other.trajectory.Exists(now.time_s)) return false;
  Statement said = TrueStatement(other, now.time_s);
  said.centre += message.error;
  said.semi_major_m = message.said.semi_major_m;
  message.is_attack = true;
  said.length_m = message.said.length_m;  // The identity's own; a change would give it away.
  said.width_m = message.said.width_m;
  message.said = said;
  return true;
}

std::optional<std::size_t> ClaimedPath::Occluder(double time_s) const {
  constexpr double kNearest_m = 8.0;
  constexpr double kFarthest_m = 80.0;
  constexpr double kTall_m = 2.0;
  constexpr double kAhead_rad = kPi / 5.0;
  std::optional<std::size_t> best;
  double best_m = kFarthest_m;
  const Snapshot snapshot = scene_.world.At(time_s);
  for (const ActorState& state : snapshot.actors) {
    if (state.actor->size.height_m < kTall_m) continue;
    const Vec2 d = state.motion.centre - snapshot.ego.axle;
    const double bearing = AngleDifference(std::atan2(d.y(), d.x()), snapshot.ego.yaw_rad);
    if (d.norm() < kNearest_m || d.norm() >= best_m || std::abs(bearing) > kAhead_rad) continue;
    best_m = d.norm();
    best = static_cast<std::size_t>(state.actor - scene_.world.actors().data());
  }
  return best;
}

Vec2 ClaimedPath::PlaceBehind(const BehindSpec& spec, double time_s, double elapsed_s) const {
  const Actor& occluder = scene_.world.actors()[*occluder_];
  const Vec2 o = occluder.trajectory.At(time_s).centre;
  const Vec2 sight = (o - scene_.world.At(time_s).ego.axle).normalized();
  const double walked =
      std::clamp((elapsed_s - spec.hold_s) * std::abs(spec.across_mps), 0.0, spec.for_m);
  return o + (spec.gap_m + 0.5 * occluder.size.length_m) * sight +
         std::copysign(walked, spec.across_mps) * LeftOf(sight);
}

bool ClaimedPath::Behind(const BehindSpec& spec, const Moment& now, Message& message) {
  constexpr double kHalf_s = 0.05;
  constexpr double kStill_mps = 0.3;
  if (now.number == 0) occluder_.reset();
  if (!occluder_) {
    occluder_ = Occluder(now.time_s);
    began_s_ = now.time_s;
  }
  if (!occluder_) return false;
  const double since = now.time_s - began_s_;
  Statement said = CarAt(now.time_s, spec.semi_major_m);
  said.centre = PlaceBehind(spec, now.time_s, since);
  const Vec2 velocity = (PlaceBehind(spec, now.time_s + kHalf_s, since + kHalf_s) -
                         PlaceBehind(spec, now.time_s - kHalf_s, since - kHalf_s)) /
                        (2.0 * kHalf_s);
  const Vec2 sight = (said.centre - scene_.world.At(now.time_s).ego.axle).normalized();
  const Vec2 across = std::copysign(1.0, spec.across_mps) * LeftOf(sight);
  const bool is_still = velocity.norm() < kStill_mps;
  said.yaw_rad =
      is_still ? std::atan2(across.y(), across.x()) : std::atan2(velocity.y(), velocity.x());
  said.speed_mps = is_still ? 0.0 : velocity.norm();
  message.said = said;
  BecomeNobody(message);
  return true;
}

}  // namespace v2vouch::sim
