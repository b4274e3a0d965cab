// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/truth.h"

#include <algorithm>

#include "sim/sensors/bsm.h"

namespace v2vouch::sim {
namespace {

constexpr double kReach_m = 150.0;

}  // namespace

TruthWriter::TruthWriter(const World& world, std::uint64_t seed) : world_(world), seed_(seed) {
  const VehicleConfig& vehicle = world.vehicle();
  for (std::size_t i = 0; i < vehicle.radars.size(); ++i) {
    radars_.emplace_back(world, static_cast<int>(i), seed);
    // Full channel names: sensors of two kinds may share one name.
    names_.push_back("RADAR_" + vehicle.radars[i].name);
  }
  for (std::size_t i = 0; i < vehicle.cameras.size(); ++i) {
    cameras_.emplace_back(world, static_cast<int>(i), seed);
    names_.push_back("CAMERA_" + vehicle.cameras[i].name);
  }
  for (std::size_t i = 0; i < vehicle.objects.size(); ++i) {
    objects_.emplace_back(world, static_cast<int>(i), seed);
    names_.push_back("OBJECTS_" + vehicle.objects[i].name);
  }
  sights_.resize(names_.size());
}

void TruthWriter::Write(const Snapshot& snapshot, std::int64_t seq, truth_list_t& truth) {
  const Scenario& scenario = world_.scenario();
  truth.seq = seq;
  truth.origin_latitude_rad = scenario.origin.latitude_rad;
  truth.origin_longitude_rad = scenario.origin.longitude_rad;
  truth.ego_x_m = snapshot.ego.axle.x();
  truth.ego_y_m = snapshot.ego.axle.y();
  truth.ego_yaw_rad = WrapAngle(snapshot.ego.yaw_rad);
  truth.ego_speed_mps = snapshot.ego.speed_mps;
  truth.ego_yaw_rate_radps = snapshot.ego.yaw_rate_radps;
  truth.ego_accel_mps2 = snapshot.ego.accel_mps2;
  for (std::size_t i = 0; i < radars_.size(); ++i) radars_[i].Look(snapshot, sights_[i]);
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    cameras_[i].Look(snapshot, sights_[radars_.size() + i]);
  }
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    objects_[i].Look(snapshot, sights_[radars_.size() + cameras_.size() + i]);
  }
  truth.objects.clear();
  for (std::size_t i = 0; i < snapshot.actors.size(); ++i) {
    const ActorState& actor = snapshot.actors[i];
    if ((actor.motion.centre - snapshot.ego.axle).norm() > kReach_m) continue;
    truth_object_t object{};
    object.id = actor.actor->id;
    object.object_class = static_cast<std::int8_t>(actor.actor->object_class);
    object.has_v2v = actor.actor->has_v2v ? 1 : 0;
    if (actor.actor->has_v2v) {
      const Identity identity =
          IdentityOf(seed_, actor.actor->id, IdentityNumber(actor.actor->sender, snapshot.time_s));
      std::copy(identity.id.begin(), identity.id.end(), std::begin(object.v2v_id));
    }
    object.x_m = actor.motion.centre.x();
    object.y_m = actor.motion.centre.y();
    object.yaw_rad = WrapAngle(actor.motion.yaw_rad);
    object.speed_mps = actor.motion.speed_mps;
    object.yaw_rate_radps = actor.motion.yaw_rate_radps;
    object.accel_mps2 = actor.motion.accel_mps2;
    object.length_m = actor.actor->size.length_m;
    object.width_m = actor.actor->size.width_m;
    object.height_m = actor.actor->size.height_m;
    object.is_hidden = 1;
    for (std::size_t s = 0; s < sights_.size(); ++s) {
      truth_sensor_t sensor{};
      sensor.sensor = names_[s];
      sensor.detection_probability = sights_[s][i].detection_probability;
      sensor.visible_fraction = sights_[s][i].visible_fraction;
      if (sensor.detection_probability > 0.0) object.is_hidden = 0;
      object.sensors.push_back(sensor);
    }
    object.num_sensors = static_cast<std::int32_t>(object.sensors.size());
    truth.objects.push_back(object);
  }
  truth.num_objects = static_cast<std::int32_t>(truth.objects.size());
}

}  // namespace v2vouch::sim
