// SPDX-License-Identifier: Apache-2.0
#include "sim/scorecard/scene.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "daemon/common/base/angle.h"
#include "sim/metrics/gospa.h"
#include "sim/scorecard/silhouette.h"

namespace v2vouch::evaluation {
namespace {

using Newest = std::map<Timestamp, const ReceivedList*>;

bool IsRoadUser(int object_class) { return object_class == 6 || object_class == 7; }

class SceneMaker {
 public:
  SceneMaker(const RunLog& log, ListKind kind, const ScorecardSettings& settings)
      : log_(log), kind_(kind), settings_(settings), gospa_({.cutoff_m = settings.cutoff_m}) {
    for (const ReceivedList& list : log.lists[Index(kind)]) newest_[list.stamp] = &list;
    for (const SensorSpec& sensor : log.specs.sensors) {
      (sensor.kind == SensorKind::kCamera ? cameras_ : radars_).push_back(&sensor);
    }
  }

  [[nodiscard]] std::optional<Scene> At(Timestamp instant) {
    Scene scene;
    scene.stamp = instant;
    const auto after = newest_.upper_bound(instant);
    if (after != newest_.begin()) {
      const ReceivedList* list = std::prev(after)->second;
      if (ToSeconds(instant - list->stamp) <= 1.5 * settings_.period_s) {
        scene.list = list;
        scene.stamp = list->stamp;
      }
    }
    const auto ego = log_.truth.ego.At(scene.stamp);
    if (!ego) return std::nullopt;
    scene.ego_W = *ego;
    scene.t_s = ToSeconds(scene.stamp - log_.truth.begin());
    scene.is_scored = scene.t_s + 1e-9 >= settings_.skip_s;
    if (scene.list != nullptr) {
      for (const ListedTrack& track : scene.list->tracks) {
        if (kind_ == ListKind::kLocal && IsRoadUser(track.object_class)) continue;
        scene.tracks.push_back(&track);
      }
    }
    PlaceTruths(scene);
    SetSight(scene);
    Match(scene);
    return scene;
  }

 private:
  void PlaceTruths(Scene& scene) const {
    const Pose<World, Body> X_WB(scene.ego_W.x_m, scene.ego_W.y_m, scene.ego_W.yaw_rad);
    for (std::size_t o = 0; o < log_.truth.objects.size(); ++o) {
      const TruthObject& object = log_.truth.objects[o];
      const auto motion = object.motion.At(scene.stamp);
      if (!motion) continue;
      SceneTruth truth;
      truth.object = o;
      truth.motion_B = *motion;
      const Point<Body> p = X_WB.Inverse() * Point<World>{motion->x_m, motion->y_m};
      truth.motion_B.x_m = p.x_m;
      truth.motion_B.y_m = p.y_m;
      truth.motion_B.yaw_rad = WrapAngle(motion->yaw_rad - scene.ego_W.yaw_rad);
      truth.box_B = {p.vector(), truth.motion_B.yaw_rad, object.length_m, object.width_m};
      truth.range_m = p.vector().norm();
      truth.is_hidden = object.motion.InForce(scene.stamp)->is_hidden;
      truth.is_vehicle = object.is_vehicle();
      truth.is_in_scope = truth.is_vehicle && (kind_ == ListKind::kLocal || object.has_v2v);
      scene.truths.push_back(truth);
    }
  }

  void SetSight(Scene& scene) const {
    bool has_looks = false;
    for (SceneTruth& truth : scene.truths) {
      const TruthSample& sample = *log_.truth.objects[truth.object].motion.InForce(scene.stamp);
      for (const TruthLook& look : sample.looks) {
        has_looks = true;
        if (truth.is_hidden || look.detection_probability <= 0.0) continue;
        double& sight = IsCamera(look.sensor) ? truth.camera_sight : truth.radar_sight;
        sight = std::max(sight, look.visible_fraction);
      }
    }
    if (has_looks) return;
    for (const SensorSpec* radar : radars_) See(*radar, scene, &SceneTruth::radar_sight);
    for (const SensorSpec* camera : cameras_) See(*camera, scene, &SceneTruth::camera_sight);
  }

  // TRUTH names a sensor by its channel or by the channel's end.
  [[nodiscard]] bool IsCamera(const std::string& name) const {
    return std::ranges::any_of(cameras_, [&](const SensorSpec* camera) {
      return camera->channel == name || camera->channel == "CAMERA_" + name;
    });
  }

  void See(const SensorSpec& sensor, Scene& scene, double SceneTruth::*sight) const {
    const Eigen::Vector2d from(sensor.x_m, sensor.y_m);
    std::vector<Silhouette> silhouettes;
    silhouettes.reserve(scene.truths.size());
    for (const SceneTruth& truth : scene.truths) {
      silhouettes.push_back(SilhouetteOf(truth.box_B, from));
    }
    const std::vector<double> shares = UncoveredShares(silhouettes);
    for (std::size_t i = 0; i < scene.truths.size(); ++i) {
      SceneTruth& truth = scene.truths[i];
      if (truth.is_hidden || !sensor.Covers(truth.box_B.centre)) continue;
      truth.*sight = std::max(truth.*sight, shares[i]);
    }
  }

  void Match(Scene& scene) {
    std::vector<Eigen::Vector2d> truths, tracks;
    std::vector<std::size_t> index;
    for (std::size_t i = 0; i < scene.truths.size(); ++i) {
      if (!scene.truths[i].is_in_scope) continue;
      truths.push_back(scene.truths[i].motion_B.position());
      index.push_back(i);
    }
    for (const ListedTrack* track : scene.tracks) tracks.push_back(track->motion_B.position());
    const std::vector<int>& assignment = gospa_.FromPoints(truths, tracks).assignment;
    scene.owner.assign(scene.tracks.size(), -1);
    for (std::size_t i = 0; i < index.size(); ++i) {
      scene.truths[index[i]].track = assignment[i];
      if (assignment[i] < 0) continue;
      scene.owner[static_cast<std::size_t>(assignment[i])] = static_cast<int>(index[i]);
    }
  }

  const RunLog& log_;
  ListKind kind_;
  const ScorecardSettings& settings_;
  Gospa gospa_;
  Newest newest_;
  std::vector<const SensorSpec*> radars_, cameras_;
};

}  // namespace

std::vector<Scene> MakeScenes(const RunLog& log, ListKind kind, const ScorecardSettings& settings) {
  std::vector<Scene> scenes;
  if (log.truth.empty()) return scenes;
  SceneMaker maker(log, kind, settings);
  const Duration period = FromSeconds(settings.period_s);
  for (Timestamp t = log.truth.begin(); t <= log.truth.end(); t += period) {
    if (auto scene = maker.At(t)) scenes.push_back(std::move(*scene));
  }
  return scenes;
}

}  // namespace v2vouch::evaluation
