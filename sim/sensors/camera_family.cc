// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/camera_family.h"

#include <algorithm>
#include <cmath>

namespace v2vouch::sim {
namespace {

double Exponential(Random& random, double mean) { return -mean * std::log(1.0 - random.Uniform()); }

// What a detector takes a vehicle for, where it errs.
ObjectClass WrongClass(ObjectClass object_class, Random& random) {
  const double draw = random.Uniform();
  switch (object_class) {
    case ObjectClass::kCar:
      return draw < 0.6 ? ObjectClass::kVan : ObjectClass::kTruck;
    case ObjectClass::kVan:
      return draw < 0.5 ? ObjectClass::kCar : draw < 0.8 ? ObjectClass::kTruck : ObjectClass::kBus;
    case ObjectClass::kTruck:
      return draw < 0.5 ? ObjectClass::kBus : draw < 0.8 ? ObjectClass::kVan : ObjectClass::kCar;
    case ObjectClass::kBus:
      return draw < 0.8 ? ObjectClass::kTruck : ObjectClass::kVan;
    case ObjectClass::kMotorcycle:
      return ObjectClass::kCyclist;
    case ObjectClass::kCyclist:
      return draw < 0.6 ? ObjectClass::kMotorcycle : ObjectClass::kPedestrian;
    default:
      return ObjectClass::kCyclist;
  }
}

}  // namespace

CameraFamily::CameraFamily(const CameraFamilySpec& spec, std::uint64_t index, std::uint64_t seed)
    : spec_(spec), index_(index), seed_(seed) {}

double CameraFamily::Begin(const EgoTruth& ego, double time_s, std::int64_t seq,
                           double half_fov_rad) {
  Random random = SubjectRandom(seed_, "family camera", {index_, static_cast<std::uint64_t>(seq)});
  const double dt = has_begun_ ? time_s - time_s_ : 0.0;
  const double rho = has_begun_ ? std::exp(-dt / spec_.pitch_tau_s) : 0.0;
  pitch_rad_ = rho * pitch_rad_ + random.Normal(0.0, spec_.pitch_rad * std::sqrt(1.0 - rho * rho));
  time_s_ = time_s;
  has_begun_ = true;
  std::erase_if(false_boxes_, [&](const FalseBox& box) { return time_s > box.until_s; });
  if (random.Bernoulli(std::min(1.0, spec_.false_per_s * dt))) {
    const double range = random.Uniform(8.0, 60.0);
    const Vec2 place =
        ego.axle + range * Direction(ego.yaw_rad + random.Uniform(-1.0, 1.0) * half_fov_rad);
    const bool is_big = random.Bernoulli(0.2);
    false_boxes_.push_back({place, is_big ? random.Uniform(2.2, 2.6) : random.Uniform(1.4, 4.0),
                            is_big ? random.Uniform(2.5, 3.5) : random.Uniform(1.2, 1.8),
                            is_big ? ObjectClass::kTruck : ObjectClass::kCar,
                            time_s + Exponential(random, spec_.false_s)});
  }
  return pitch_rad_ - spec_.dive_rad * ego.accel_mps2;  // Braking: the nose goes down.
}

const CameraFamily::Vehicle& CameraFamily::See(const Actor& actor, std::int64_t seq) {
  Random random =
      SubjectRandom(seed_, "family seen", {index_, static_cast<std::uint64_t>(seq), actor.id});
  const auto [found, is_new] = vehicles_.try_emplace(actor.id);
  Vehicle& vehicle = found->second;
  const double dt = is_new ? 0.0 : time_s_ - vehicle.time_s;
  const double rho = is_new ? 0.0 : std::exp(-dt / spec_.edge_tau_s);
  for (double& error : vehicle.edge) {
    error = rho * error + random.Normal(0.0, std::sqrt(1.0 - rho * rho));
  }
  vehicle.time_s = time_s_;
  if (is_new) vehicle.is_amodal = random.Bernoulli(spec_.amodal_share);
  if (is_new || time_s_ >= vehicle.class_until_s) {
    const bool is_wrong = random.Bernoulli(spec_.wrong_class_share);
    vehicle.read_as = is_wrong ? WrongClass(actor.object_class, random) : actor.object_class;
    vehicle.class_until_s = time_s_ + Exponential(random, spec_.class_spell_s);
  }
  if (random.Bernoulli(std::min(1.0, spec_.misses_per_s * dt))) {
    vehicle.missed_until_s = time_s_ + Exponential(random, spec_.miss_s);
  }
  if (actor.size.height_m > 1.9 && random.Bernoulli(std::min(1.0, spec_.split_per_s * dt))) {
    vehicle.split_until_s = time_s_ + Exponential(random, spec_.split_s);
  }
  vehicle.is_missed = time_s_ < vehicle.missed_until_s;
  vehicle.is_split = time_s_ < vehicle.split_until_s;
  return vehicle;
}

}  // namespace v2vouch::sim
