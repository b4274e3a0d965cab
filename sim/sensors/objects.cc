// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/objects.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/data/object_class.h"
#include "sim/sensors/subject.h"

namespace v2vouch::sim {
namespace {

constexpr double kRay_rad = FromDegrees(0.2);
constexpr double kLeastIdealShare = 0.5;
constexpr double kTurnedByHalf = 0.1;
constexpr double kTurnedByQuarter = 0.02;
constexpr double kOtherClass = 0.03;

double RangeFactor(double range_m, double max_range_m) {
  const double share = range_m / max_range_m;
  if (share > 1.0) return 0.0;
  return share <= 0.6 ? 1.0 : 1.0 - 0.5 * (share - 0.6) / 0.4;
}

object_t Blank() {
  object_t box{};
  box.height_m = kNaN;
  box.velocity_x_mps = box.velocity_y_mps = kNaN;
  box.id = -1;
  return box;
}

}  // namespace

ObjectSimulator::ObjectSimulator(const World& world, int index, std::uint64_t seed)
    : world_(world),
      sensor_(world.vehicle().objects[static_cast<std::size_t>(index)]),
      index_(static_cast<std::uint64_t>(index)),
      seed_(seed),
      skyline_(std::min(kPi, sensor_.half_fov_rad), kRay_rad) {
  sensor_.detection_probability *= world.scenario().sensors.detection_scale;
}

Vec2 ObjectSimulator::Frame::Turned(const Vec2& in_world) const {
  const Vec2 ahead = Direction(yaw_rad);
  return {in_world.dot(ahead), in_world.dot(LeftOf(ahead))};
}

ObjectSimulator::Frame ObjectSimulator::FrameAt(const EgoTruth& ego) const {
  const Vec2 place = ego.PointAt(sensor_.x_m, sensor_.y_m);
  return {place, ego.VelocityAt(place), ego.yaw_rad + sensor_.yaw_rad, ego.yaw_rate_radps};
}

bool ObjectSimulator::Covers(const Vec2& p_S) const {
  const double range_m = p_S.norm();
  return range_m >= sensor_.min_range_m && range_m <= sensor_.max_range_m &&
         std::abs(std::atan2(p_S.y(), p_S.x())) <= sensor_.half_fov_rad;
}

void ObjectSimulator::Look(const Snapshot& snapshot, std::vector<Sight>& sights) {
  const Frame frame = FrameAt(snapshot.ego);
  const std::size_t n = snapshot.actors.size();
  skyline_.Cast(frame.place, frame.yaw_rad, sensor_.max_range_m + 20.0, snapshot, world_.walls());
  std::vector<int> whole(n, 0), open(n, 0);
  for (int ray = 0; ray < skyline_.size(); ++ray) {
    bool is_first = true;
    for (const Skyline::Hit& hit : skyline_.hits(ray)) {
      const auto object = static_cast<std::size_t>(hit.object);
      if (object < n) {
        ++whole[object];
        if (is_first) ++open[object];
      }
      is_first = false;
    }
  }
  const bool ideal = world_.scenario().sensors.mode == SensorMode::kIdealPoints;
  sights.assign(n, {});
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 p_S = frame.Turned(snapshot.actors[i].motion.centre - frame.place);
    if (open[i] == 0 || !Covers(p_S)) continue;
    Sight& sight = sights[i];
    sight.visible_fraction = static_cast<double>(open[i]) / whole[i];
    if (ideal) {
      const bool shows = sight.visible_fraction >= kLeastIdealShare;
      sight.detection_probability = shows ? sensor_.detection_probability : 0.0;
    } else {
      sight.detection_probability = sensor_.detection_probability *
                                    RangeFactor(p_S.norm(), sensor_.max_range_m) *
                                    std::clamp((sight.visible_fraction - 0.1) / 0.4, 0.0, 1.0);
    }
  }
}

void ObjectSimulator::PutVelocity(const ActorState& actor, const Vec2& p_S, const Frame& frame,
                                  Random& random, object_t& box) const {
  const SensorsSpec& spec = world_.scenario().sensors;
  Vec2 velocity = frame.Turned(actor.motion.speed_mps * Direction(actor.motion.yaw_rad));
  if (sensor_.velocity == VelocityReference::kSensor) {
    velocity -= frame.Turned(frame.velocity) + frame.yaw_rate_radps * Vec2(-p_S.y(), p_S.x());
  }
  const double sigma = spec.noise_scale * sensor_.velocity_sigma_mps;
  const Vec2 noise(random.Normal(0.0, sigma), random.Normal(0.0, sigma));
  if (!spec.objects_tell_velocity) return;
  box.velocity_x_mps = velocity.x() + noise.x();
  box.velocity_y_mps = velocity.y() + noise.y();
}

object_t ObjectSimulator::BoxOf(const ActorState& actor, const Sight& sight, const Frame& frame,
                                Random& random) const {
  const SensorsSpec& spec = world_.scenario().sensors;
  const bool ideal = spec.mode == SensorMode::kIdealPoints;
  const double scale = spec.noise_scale;
  Vec2 p_S = frame.Turned(actor.motion.centre - frame.place);
  object_t box = Blank();
  // The hidden part is unknown: the centre is drawn towards the sensor's side.
  const double unseen = ideal ? 0.0 : kPartShare * (1.0 - sight.visible_fraction);
  const Vec2 true_p_S = p_S;
  p_S -= unseen * actor.actor->size.length_m * random.Uniform() * p_S.normalized();
  box.x_m = p_S.x() + random.Normal(0.0, scale * sensor_.position_sigma_m);
  box.y_m = p_S.y() + random.Normal(0.0, scale * sensor_.position_sigma_m);
  double yaw_rad =
      actor.motion.yaw_rad - frame.yaw_rad + random.Normal(0.0, scale * sensor_.yaw_sigma_rad);
  const double turn = random.Uniform();
  if (!ideal && turn < kTurnedByHalf) yaw_rad += kPi;
  if (!ideal && turn > 1.0 - kTurnedByQuarter) yaw_rad += 0.5 * kPi;
  box.yaw_rad = WrapAngle(yaw_rad);
  box.length_m = std::max(
      0.3, actor.actor->size.length_m + random.Normal(0.0, scale * sensor_.length_sigma_m));
  box.width_m =
      std::max(0.3, actor.actor->size.width_m + random.Normal(0.0, scale * sensor_.width_sigma_m));
  box.height_m = actor.actor->size.height_m;
  PutVelocity(actor, true_p_S, frame, random, box);
  if (spec.objects_tell_covariance) {
    const auto put = [&](int i, double sigma) {
      box.covariance[6 * i] = scale * scale * sigma * sigma;
    };
    put(0, sensor_.position_sigma_m);
    put(1, sensor_.position_sigma_m);
    put(2, sensor_.yaw_sigma_rad);
    put(3, sensor_.velocity_sigma_mps);
    put(4, sensor_.velocity_sigma_mps);
  }
  ObjectClass object_class = actor.actor->object_class;
  if (!ideal && random.Bernoulli(kOtherClass)) {
    object_class = object_class == ObjectClass::kCar ? ObjectClass::kVan : ObjectClass::kCar;
  }
  box.class_name = ObjectClassName(object_class);
  box.score = std::clamp(0.5 + 0.45 * sight.visible_fraction + random.Normal(0.0, 0.05),
                         std::min(0.99, sensor_.min_score + 0.02), 0.99);
  if (spec.objects_tell_ids) box.id = actor.actor->id;
  return box;
}

// A hedge, a sign, a heap of reflections that looks like a car.
object_t ObjectSimulator::FalseBox(Random& random) const {
  object_t box = Blank();
  const double most = sensor_.max_range_m * sensor_.max_range_m;
  const double least = sensor_.min_range_m * sensor_.min_range_m;
  const double range_m = std::sqrt(random.Uniform(least, most));
  const double azimuth_rad = random.Uniform(-sensor_.half_fov_rad, sensor_.half_fov_rad);
  box.x_m = range_m * std::cos(azimuth_rad);
  box.y_m = range_m * std::sin(azimuth_rad);
  box.yaw_rad = random.Uniform(-kPi, kPi);
  box.length_m = random.Uniform(3.0, 6.0);
  box.width_m = random.Uniform(1.5, 2.2);
  box.class_name = ObjectClassName(ObjectClass::kCar);
  box.score = std::min(0.99, sensor_.min_score + random.Uniform(0.0, 0.3));
  return box;
}

void ObjectSimulator::Detect(const Snapshot& snapshot, std::int64_t seq, object_list_t& list) {
  const SensorsSpec& spec = world_.scenario().sensors;
  const bool ideal = spec.mode == SensorMode::kIdealPoints;
  list.seq = seq;
  list.sensor = sensor_.name;
  list.objects.clear();
  const auto frame_number = static_cast<std::uint64_t>(seq);
  Look(snapshot, sights_);
  const Frame frame = FrameAt(snapshot.ego);
  for (std::size_t i = 0; i < snapshot.actors.size(); ++i) {
    const ActorState& actor = snapshot.actors[i];
    Random random = SubjectRandom(seed_, "objects", {index_, frame_number, actor.actor->id});
    if (!random.Bernoulli(sights_[i].detection_probability)) continue;
    list.objects.push_back(BoxOf(actor, sights_[i], frame, random));
  }
  if (!ideal) {
    Random random = SubjectRandom(seed_, "objects clutter", {index_, frame_number});
    const int count = random.Poisson(spec.clutter_scale * sensor_.clutter_per_frame);
    for (int k = 0; k < count; ++k) list.objects.push_back(FalseBox(random));
    Random outlier = SubjectRandom(seed_, "objects outlier", {index_, frame_number});
    for (object_t& box : list.objects) {
      if (!outlier.Bernoulli(spec.outlier_share)) continue;
      const double by_m = kOutlierSigmas * outlier.Uniform(-1.0, 1.0) * sensor_.position_sigma_m;
      (outlier.Bernoulli(0.5) ? box.x_m : box.y_m) += by_m;
    }
  }
  list.num_objects = static_cast<std::int32_t>(list.objects.size());
}

}  // namespace v2vouch::sim
