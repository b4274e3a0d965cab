// SPDX-License-Identifier: Apache-2.0
#include "sim/attacks/view_timeline.h"

#include <algorithm>
#include <cmath>

#include "sim/sensors/camera.h"
#include "sim/sensors/radar.h"

namespace v2vouch::sim {
namespace {

constexpr double kStep_s = 0.1;
constexpr double kLikely = 0.5;  // Before sensors.detection_scale.
constexpr double kNearest_m = 5.0;
constexpr double kFarthest_m = 100.0;
constexpr double kReach_m = 150.0;
constexpr double kAhead_rad = 35.0 / 180.0 * kPi;
constexpr double kGap_s = 1.5;
constexpr double kViewBefore_s = 2.0;
constexpr double kDriving_mps = 2.0;

struct Look {
  bool by_radar = false;
  bool by_camera = false;
  bool by_any = false;
};

// The ego's sensors, one of each as the vehicle file has them.
class Sensors {
 public:
  Sensors(const World& world, std::uint64_t seed) {
    const VehicleConfig& vehicle = world.vehicle();
    for (std::size_t i = 0; i < vehicle.radars.size(); ++i) {
      radars_.emplace_back(world, static_cast<int>(i), seed);
    }
    for (std::size_t i = 0; i < vehicle.cameras.size(); ++i) {
      cameras_.emplace_back(world, static_cast<int>(i), seed);
    }
  }

  // What each actor of the snapshot is likely to be seen by.
  void Look(const Snapshot& snapshot, double likely, std::vector<struct Look>& looks) {
    looks.assign(snapshot.actors.size(), {});
    for (RadarSimulator& radar : radars_) {
      radar.Look(snapshot, sights_);
      for (std::size_t i = 0; i < looks.size(); ++i) {
        looks[i].by_radar = looks[i].by_radar || sights_[i].detection_probability >= likely;
        looks[i].by_any = looks[i].by_any || sights_[i].detection_probability > 0.0;
      }
    }
    for (CameraSimulator& camera : cameras_) {
      camera.Look(snapshot, sights_);
      for (std::size_t i = 0; i < looks.size(); ++i) {
        looks[i].by_camera = looks[i].by_camera || sights_[i].detection_probability >= likely;
        looks[i].by_any = looks[i].by_any || sights_[i].detection_probability > 0.0;
      }
    }
  }

 private:
  std::vector<RadarSimulator> radars_;
  std::vector<CameraSimulator> cameras_;
  std::vector<Sight> sights_;
};

}  // namespace

ViewTimeline::ViewTimeline(const World& world, std::uint64_t seed) {
  Sensors sensors(world, seed);
  const double likely = kLikely * world.scenario().sensors.detection_scale;
  const std::size_t n = world.actors().size();
  const auto steps = static_cast<std::size_t>(world.scenario().duration_s / kStep_s) + 2;
  cells_.assign(n, std::vector<Cell>(steps));
  longest_.assign(n, {});
  std::vector<double> unseen_s(n, 0.0);
  std::vector<Look> looks;
  for (std::size_t k = 0; k < steps; ++k) {
    const Snapshot snapshot = world.At(static_cast<double>(k) * kStep_s);
    sensors.Look(snapshot, likely, looks);
    if (k > 0) {  // What is not there any more keeps its last cell.
      for (std::size_t a = 0; a < n; ++a) cells_[a][k] = cells_[a][k - 1];
    }
    for (std::size_t i = 0; i < looks.size(); ++i) {
      const ActorState& state = snapshot.actors[i];
      const auto a = static_cast<std::size_t>(state.actor - world.actors().data());
      const Vec2 way = state.motion.centre - snapshot.ego.axle;
      const double range = way.norm();
      const double bearing = AngleDifference(std::atan2(way.y(), way.x()), snapshot.ego.yaw_rad);
      const bool is_seen =
          looks[i].by_radar && looks[i].by_camera && range >= kNearest_m && range <= kFarthest_m;
      const bool is_hidden =
          !looks[i].by_any && range <= kReach_m && std::abs(bearing) <= kAhead_rad;
      Cell& cell = cells_[a][k];
      unseen_s[a] = is_seen ? 0.0 : unseen_s[a] + kStep_s;
      if (is_seen) {
        cell.in_view_s += static_cast<float>(kStep_s);
      } else if (unseen_s[a] > kGap_s && cell.in_view_s > 0.0f) {
        cell.last_view_s = cell.in_view_s;
        cell.in_view_s = 0.0f;
      }
      cell.hidden_s = is_hidden ? cell.hidden_s + static_cast<float>(kStep_s) : 0.0f;
      Longest& longest = longest_[a];
      const auto in_view_s = static_cast<double>(cell.in_view_s);
      longest.in_view_s = std::max(longest.in_view_s, in_view_s);
      if (std::abs(state.motion.speed_mps) < kDriving_mps) continue;
      longest.driving_s = std::max(longest.driving_s, in_view_s);
      if (std::max(cell.in_view_s, cell.last_view_s) >= kViewBefore_s) {
        longest.hidden_s = std::max(longest.hidden_s, static_cast<double>(cell.hidden_s));
      }
    }
  }
}

const ViewTimeline::Cell& ViewTimeline::At(std::size_t actor, double time_s) const {
  const auto& cells = cells_[actor];
  const double step = std::clamp(time_s / kStep_s, 0.0, static_cast<double>(cells.size() - 1));
  return cells[static_cast<std::size_t>(step)];
}

double ViewTimeline::InViewFor(std::size_t actor, double time_s) const {
  return static_cast<double>(At(actor, time_s).in_view_s);
}

double ViewTimeline::HiddenFor(std::size_t actor, double time_s) const {
  return static_cast<double>(At(actor, time_s).hidden_s);
}

double ViewTimeline::LastViewFor(std::size_t actor, double time_s) const {
  const Cell& cell = At(actor, time_s);
  return static_cast<double>(std::max(cell.in_view_s, cell.last_view_s));
}

}  // namespace v2vouch::sim
