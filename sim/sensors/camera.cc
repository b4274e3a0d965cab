// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/camera.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/data/object_class.h"
#include "sim/sensors/subject.h"

namespace v2vouch::sim {
namespace {

constexpr double kRay_rad = FromDegrees(0.05);

// Half of the span the rays must cover: the picture's wider side, and a margin.
double HalfSpan(const CameraConfig& camera) {
  const double side = std::max(camera.cx_px, camera.image_width_px - camera.cx_px);
  return std::min(FromDegrees(85.0), std::atan(side / camera.fx_px) * 1.05);
}

ObjectClass Confused(ObjectClass object_class) {
  switch (object_class) {
    case ObjectClass::kCar:
      return ObjectClass::kVan;
    case ObjectClass::kVan:
      return ObjectClass::kCar;
    case ObjectClass::kTruck:
      return ObjectClass::kBus;
    case ObjectClass::kBus:
      return ObjectClass::kTruck;
    case ObjectClass::kMotorcycle:
      return ObjectClass::kCyclist;
    case ObjectClass::kCyclist:
      return ObjectClass::kMotorcycle;
    default:
      return object_class;
  }
}

Eigen::Vector2d Distorted(const CameraConfig& camera, double x, double y) {
  if (camera.distortion.empty()) return {x, y};
  const auto k = [&](std::size_t i) {
    return i < camera.distortion.size() ? camera.distortion[i] : 0.0;
  };
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k(0) + r2 * (k(1) + r2 * k(4)));
  return {x * radial + 2.0 * k(2) * x * y + k(3) * (r2 + 2.0 * x * x),
          y * radial + k(2) * (r2 + 2.0 * y * y) + 2.0 * k(3) * x * y};
}

void SetClass(ObjectClass object_class, camera_box_t& box) {
  box.class_id = static_cast<std::int32_t>(object_class);
  box.class_name = ObjectClassName(object_class);
}

}  // namespace

std::optional<Eigen::Vector2d> Project(const CameraConfig& camera, const Eigen::Vector3d& p_B,
                                       double extra_pitch_rad) {
  const Eigen::Vector3d d = p_B - Eigen::Vector3d(camera.x_m, camera.y_m, camera.z_m);
  const double cy = std::cos(camera.yaw_rad);
  const double sy = std::sin(camera.yaw_rad);
  const double ahead = cy * d.x() + sy * d.y();
  const double left = -sy * d.x() + cy * d.y();
  const double cp = std::cos(camera.pitch_rad + extra_pitch_rad);
  const double sp = std::sin(camera.pitch_rad + extra_pitch_rad);
  const double forward = cp * ahead - sp * d.z();
  const double up = sp * ahead + cp * d.z();
  const double cr = std::cos(camera.roll_rad);
  const double sr = std::sin(camera.roll_rad);
  const double right_C = cr * -left + sr * -up;  // Right side rolled down.
  const double down_C = cr * -up - sr * -left;
  if (forward < 0.2) return std::nullopt;
  const Eigen::Vector2d ray = Distorted(camera, right_C / forward, down_C / forward);
  return Eigen::Vector2d(camera.cx_px + camera.fx_px * ray.x(),
                         camera.cy_px + camera.fy_px * ray.y());
}

void CameraSimulator::PixelBox::Add(const Eigen::Vector2d& pixel) {
  left = std::min(left, pixel.x());
  right = std::max(right, pixel.x());
  top = std::min(top, pixel.y());
  bottom = std::max(bottom, pixel.y());
  is_empty = false;
}

CameraSimulator::CameraSimulator(const World& world, int index, std::uint64_t seed)
    : world_(world),
      camera_(world.vehicle().cameras[static_cast<std::size_t>(index)]),
      index_(static_cast<std::uint64_t>(index)),
      seed_(seed),
      skyline_(HalfSpan(camera_), kRay_rad) {
  camera_.detection_probability *= world.scenario().sensors.detection_scale;
  if (const auto& family = world.scenario().family) {
    family_.emplace(family->camera, index_, seed_);
  }
}

Eigen::Vector3d CameraSimulator::ToBody(const EgoTruth& ego, const Vec2& point, double z_m) const {
  const Vec2 forward = Direction(ego.yaw_rad);
  const Vec2 d = point - ego.axle;
  return {d.dot(forward), d.dot(LeftOf(forward)), z_m};
}

CameraSimulator::Cover CameraSimulator::CastRays(const Snapshot& snapshot, double extra_pitch_rad,
                                                 std::vector<Seen>& seen) {
  const Vec2 origin = snapshot.ego.PointAt(camera_.x_m, camera_.y_m);
  const double yaw = snapshot.ego.yaw_rad + camera_.yaw_rad;
  const std::size_t n = snapshot.actors.size();
  skyline_.Cast(origin, yaw, camera_.max_range_m + 20.0, snapshot, world_.walls());
  Cover cover{std::vector<double>(n, 0.0), std::vector<double>(n, 0.0)};
  for (int ray = 0; ray < skyline_.size(); ++ray) {
    const Vec2 direction = Direction(yaw + skyline_.azimuth_rad(ray));
    double covered_to = -1e9;  // Tangent of elevation up to which nearer objects cover this ray.
    for (const Skyline::Hit& hit : skyline_.hits(ray)) {
      const double low = -camera_.z_m / hit.range_m;
      const double high = (hit.height_m - camera_.z_m) / hit.range_m;
      const auto object = static_cast<std::size_t>(hit.object);
      if (object < n) {
        cover.whole[object] += high - low;
        const double from = std::max(low, covered_to);
        if (from < high) {
          cover.open[object] += high - from;
          const Vec2 point = origin + hit.range_m * direction;
          for (const double tangent : {from, high}) {
            const auto pixel =
                Project(camera_, ToBody(snapshot.ego, point, camera_.z_m + tangent * hit.range_m),
                        extra_pitch_rad);
            if (pixel) seen[object].box.Add(*pixel);
          }
        }
      }
      covered_to = std::max(covered_to, high);
    }
  }
  return cover;
}

// The exact outline of the cuboid, far roof edges included.
void CameraSimulator::AddOutline(const EgoTruth& ego, const ActorState& actor,
                                 double extra_pitch_rad, PixelBox& box) const {
  const auto corners = actor.box().Corners();
  for (std::size_t k = 0; k < 4; ++k) {
    for (int step = 0; step < 8; ++step) {
      const Vec2 point = corners[k] + (corners[(k + 1) % 4] - corners[k]) * (step / 8.0);
      for (const double z : {0.0, actor.actor->size.height_m}) {
        const auto pixel = Project(camera_, ToBody(ego, point, z), extra_pitch_rad);
        if (pixel) box.Add(*pixel);
      }
    }
  }
}

void CameraSimulator::LookClosely(const Snapshot& snapshot, double extra_pitch_rad,
                                  std::vector<Seen>& seen) {
  const Vec2 origin = snapshot.ego.PointAt(camera_.x_m, camera_.y_m);
  const std::size_t n = snapshot.actors.size();
  seen.assign(n, {});
  const Cover cover = CastRays(snapshot, extra_pitch_rad, seen);
  const bool ideal = world_.scenario().sensors.mode == SensorMode::kIdealPoints;
  for (std::size_t i = 0; i < n; ++i) {
    if (cover.open[i] <= 0.0) continue;
    const ActorState& actor = snapshot.actors[i];
    const double range = (actor.motion.centre - origin).norm();
    Seen& result = seen[i];
    result.sight.visible_fraction = cover.open[i] / cover.whole[i];
    if (result.sight.visible_fraction > 0.98) {
      // Nothing in front: not the rays' steps.
      AddOutline(snapshot.ego, actor, extra_pitch_rad, result.box);
    }
    const double in_picture_px =
        std::min(result.box.right, 1.0 * camera_.image_width_px) - std::max(result.box.left, 0.0);
    if (range > camera_.max_range_m || in_picture_px < 3.0) {
      result.sight = {};
      continue;
    }
    const double height_px = result.box.bottom - result.box.top;
    if (ideal) {
      const auto foot = Project(camera_, ToBody(snapshot.ego, actor.motion.centre, 0.0));
      const bool within = foot && foot->x() > 1.0 && foot->x() < camera_.image_width_px - 1.0 &&
                          foot->y() > 2.0 && foot->y() < camera_.image_height_px;
      if (within && result.sight.visible_fraction >= 0.5) {
        result.sight.detection_probability = camera_.detection_probability;
      }
    } else {
      result.sight.detection_probability =
          camera_.detection_probability * std::clamp((height_px - 5.0) / 7.0, 0.0, 1.0) *
          std::clamp((result.sight.visible_fraction - 0.15) / 0.35, 0.0, 1.0);
    }
  }
}

void CameraSimulator::Look(const Snapshot& snapshot, std::vector<Sight>& sights) {
  LookClosely(snapshot, 0.0, seen_);
  sights.clear();
  for (const Seen& seen : seen_) sights.push_back(seen.sight);
}

double CameraSimulator::sigma_px() const {
  return world_.scenario().sensors.noise_scale * camera_.edge_sigma_px;
}

std::optional<camera_box_t> CameraSimulator::PointBox(const EgoTruth& ego, const ActorState& actor,
                                                      double nod_rad, Random& random) const {
  const auto foot = Project(camera_, ToBody(ego, actor.motion.centre, 0.0), nod_rad);
  if (!foot) return std::nullopt;
  camera_box_t box{};
  box.left_px = foot->x() - 1.0 + random.Normal(0.0, sigma_px());
  box.width_px = 2.0;
  box.top_px = foot->y() - 2.0 + random.Normal(0.0, sigma_px());
  box.height_px = 2.0;
  box.score = 0.9;
  SetClass(actor.actor->object_class, box);
  return box;
}

std::optional<camera_box_t> CameraSimulator::VehicleBox(const Seen& seen, ObjectClass object_class,
                                                        Random& random) const {
  const double sigma = sigma_px();
  const double width = camera_.image_width_px;
  const double height = camera_.image_height_px;
  camera_box_t box{};
  const auto edge = [&](double exact, double low, double high) {
    const double noise = random.Normal(0.0, sigma);  // Drawn always: order stays fixed.
    if (exact <= low) return low;
    if (exact >= high) return high;
    return std::clamp(exact + noise, low, high);
  };
  box.left_px = edge(seen.box.left, 0.0, width);
  box.top_px = edge(seen.box.top, 0.0, height);
  box.width_px = edge(seen.box.right, 0.0, width) - box.left_px;
  box.height_px = edge(seen.box.bottom, 0.0, height) - box.top_px;
  const double size = std::clamp(box.height_px / 60.0, 0.0, 1.0);
  box.score =
      std::clamp(0.5 + 0.25 * size + 0.2 * seen.sight.visible_fraction + random.Normal(0.0, 0.05),
                 std::min(0.99, camera_.min_score + 0.02), 0.99);
  if (random.Bernoulli(0.03 + 0.07 * (1.0 - size))) object_class = Confused(object_class);
  if (box.width_px < 3.0 || box.height_px < 4.0) return std::nullopt;
  SetClass(object_class, box);
  return box;
}

// Posters, shadows, bins: near the horizon, vehicle-shaped.
camera_box_t CameraSimulator::ClutterBox(Random& random) const {
  const double width = camera_.image_width_px;
  const double height = camera_.image_height_px;
  camera_box_t box{};
  box.height_px = random.Uniform(12.0, 0.12 * height);
  box.width_px = box.height_px * random.Uniform(0.8, 2.0);
  box.left_px = random.Uniform(0.0, width - box.width_px);
  box.top_px =
      std::clamp(camera_.cy_px + random.Uniform(-0.05, 0.1) * height, 0.0, height - box.height_px);
  box.score = std::min(0.99, camera_.min_score + random.Uniform(0.0, 0.3));
  SetClass(ObjectClass::kCar, box);
  return box;
}

void CameraSimulator::Shoot(const Snapshot& snapshot, std::int64_t seq,
                            camera_detections_t& picture) {
  const SensorsSpec& sensors = world_.scenario().sensors;
  const bool ideal = sensors.mode == SensorMode::kIdealPoints;
  picture.seq = seq;
  picture.sensor = camera_.name;
  picture.image_width_px = camera_.image_width_px;
  picture.image_height_px = camera_.image_height_px;
  picture.boxes.clear();
  if (family_) return ShootFamily(snapshot, seq, picture);
  Random common = SubjectRandom(seed_, "camera", {index_, static_cast<std::uint64_t>(seq)});
  const double nod = common.Normal(0.0, sensors.noise_scale * camera_.pitch_sigma_rad);
  LookClosely(snapshot, nod, seen_);

  for (std::size_t i = 0; i < snapshot.actors.size(); ++i) {
    const Seen& seen = seen_[i];
    const ActorState& actor = snapshot.actors[i];
    if (seen.sight.detection_probability <= 0.0) continue;
    Random random = SubjectRandom(seed_, "camera vehicle",
                                  {index_, static_cast<std::uint64_t>(seq), actor.actor->id});
    if (!random.Bernoulli(seen.sight.detection_probability)) continue;
    const auto box = ideal ? PointBox(snapshot.ego, actor, nod, random)
                           : VehicleBox(seen, actor.actor->object_class, random);
    if (box) picture.boxes.push_back(*box);
  }

  if (!ideal) {
    const int count =
        common.Poisson(std::min(40.0, camera_.clutter_per_image * sensors.clutter_scale));
    for (int i = 0; i < count; ++i) picture.boxes.push_back(ClutterBox(common));
  }
  if (sensors.outlier_share > 0.0) Spoil(seq, picture);
  picture.num_boxes = static_cast<std::int32_t>(picture.boxes.size());
}

// One box, or two side by side where the vehicle is split, and now and then one of them twice.
void CameraSimulator::AddFamilyBoxes(const PixelBox& exact, const CameraFamily::Vehicle& vehicle,
                                     ObjectClass object_class, Random& random,
                                     camera_detections_t& picture) const {
  const CameraFamilySpec& spec = world_.scenario().family->camera;
  const double scale = world_.scenario().sensors.noise_scale;
  const double size_px = std::max(exact.right - exact.left, exact.bottom - exact.top);
  const double slow_px = std::hypot(spec.edge_markov_px, spec.edge_markov_share * size_px);
  const auto add = [&](const std::array<double, 4>& edges) {
    std::array<double, 4> noisy = edges;
    for (std::size_t k = 0; k < 4; ++k) {
      const double far = k % 2 == 0 ? camera_.image_width_px : camera_.image_height_px;
      const double error = slow_px * vehicle.edge[k] + random.Normal(0.0, spec.edge_white_px);
      const bool is_cut = edges[k] <= 0.0 || edges[k] >= far;
      noisy[k] = std::clamp(edges[k] + (is_cut ? 0.0 : scale * error), 0.0, far);
    }
    camera_box_t box{};
    box.left_px = noisy[0];
    box.top_px = noisy[1];
    box.width_px = noisy[2] - noisy[0];
    box.height_px = noisy[3] - noisy[1];
    if (box.width_px < 3.0 || box.height_px < 4.0) return;
    box.score =
        std::clamp(0.5 + 0.4 * std::min(1.0, box.height_px / 60.0) + random.Normal(0.0, 0.08),
                   std::min(0.99, camera_.min_score + 0.02), 0.99);
    SetClass(object_class, box);
    picture.boxes.push_back(box);
  };
  if (!vehicle.is_split) {
    add({exact.left, exact.top, exact.right, exact.bottom});
  } else {
    const double cut = exact.left + (exact.right - exact.left) * random.Uniform(0.4, 0.6);
    add({exact.left, exact.top, cut, exact.bottom});
    add({cut, exact.top, exact.right, exact.bottom});
  }
  if (random.Bernoulli(spec.duplicate_share)) {
    const double by = 0.1 * (exact.right - exact.left);
    add({exact.left + by, exact.top + 0.5 * by, exact.right + 0.5 * by, exact.bottom});
  }
}

void CameraSimulator::ShootFamily(const Snapshot& snapshot, std::int64_t seq,
                                  camera_detections_t& picture) {
  const double nod = family_->Begin(snapshot.ego, snapshot.time_s, seq, HalfSpan(camera_));
  LookClosely(snapshot, nod, seen_);
  for (std::size_t i = 0; i < snapshot.actors.size(); ++i) {
    const Seen& seen = seen_[i];
    const ActorState& actor = snapshot.actors[i];
    if (seen.sight.detection_probability <= 0.0) continue;
    const CameraFamily::Vehicle& vehicle = family_->See(*actor.actor, seq);
    Random random = SubjectRandom(seed_, "camera vehicle",
                                  {index_, static_cast<std::uint64_t>(seq), actor.actor->id});
    if (!random.Bernoulli(seen.sight.detection_probability) || vehicle.is_missed) continue;
    PixelBox exact = seen.box;
    if (vehicle.is_amodal) AddOutline(snapshot.ego, actor, nod, exact);
    AddFamilyBoxes(exact, vehicle, vehicle.read_as, random, picture);
  }
  Random random =
      SubjectRandom(seed_, "family false box", {index_, static_cast<std::uint64_t>(seq)});
  for (const CameraFamily::FalseBox& box : family_->false_boxes()) {
    const Vec2 across = LeftOf((box.place - snapshot.ego.axle).normalized()) * 0.5 * box.width_m;
    PixelBox exact;
    for (const double side : {1.0, -1.0}) {
      for (const double z : {0.0, box.height_m}) {
        const auto pixel =
            Project(camera_, ToBody(snapshot.ego, box.place + side * across, z), nod);
        if (pixel) exact.Add(*pixel);
      }
    }
    if (exact.is_empty || exact.right < 3.0 || exact.left > camera_.image_width_px - 3.0) continue;
    AddFamilyBoxes(exact, {}, box.object_class, random, picture);
  }
  picture.num_boxes = static_cast<std::int32_t>(picture.boxes.size());
}

void CameraSimulator::Spoil(std::int64_t seq, camera_detections_t& picture) const {
  Random random = SubjectRandom(seed_, "camera outlier", {index_, static_cast<std::uint64_t>(seq)});
  for (camera_box_t& box : picture.boxes) {
    if (!random.Bernoulli(world_.scenario().sensors.outlier_share)) continue;
    const double by_px = kOutlierSigmas * random.Uniform(-1.0, 1.0) * camera_.edge_sigma_px;
    (random.Bernoulli(0.5) ? box.left_px : box.top_px) += by_px;
  }
}

}  // namespace v2vouch::sim
