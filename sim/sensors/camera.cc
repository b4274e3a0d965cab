// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/camera.h"

#include <algorithm>
#include <cmath>

#include "sim/sensors/subject.h"

namespace v2vouch::sim {
namespace {

constexpr double kRay_rad = FromDegrees(0.05);

}  // namespace

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
                           : VehicleBox(camera_, sigma_px(), seen.box, seen.sight.visible_fraction,
                                        actor.actor->object_class, random);
    if (box) picture.boxes.push_back(*box);
  }

  if (!ideal) {
    const int count =
        common.Poisson(std::min(40.0, camera_.clutter_per_image * sensors.clutter_scale));
    for (int i = 0; i < count; ++i) picture.boxes.push_back(ClutterBox(camera_, common));
  }
  if (sensors.outlier_share > 0.0) Spoil(seq, picture);
  picture.num_boxes = static_cast<std::int32_t>(picture.boxes.size());
}

void CameraSimulator::ShootFamily(const Snapshot& snapshot, std::int64_t seq,
                                  camera_detections_t& picture) {
  const CameraFamilySpec& spec = world_.scenario().family->camera;
  const double noise_scale = world_.scenario().sensors.noise_scale;
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
    AddFamilyBoxes(camera_, spec, noise_scale, exact, vehicle, vehicle.read_as, random, picture);
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
    AddFamilyBoxes(camera_, spec, noise_scale, exact, {}, box.object_class, random, picture);
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
