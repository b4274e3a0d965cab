// SPDX-License-Identifier: Apache-2.0
#include "sim/spoofing/joint_view.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace v2vouch::evaluation {

std::vector<TrueBox> TrueBoxes(const Truth& truth, Timestamp t) {
  std::vector<TrueBox> boxes;
  for (std::size_t o = 0; o < truth.objects.size(); ++o) {
    const TruthObject& object = truth.objects[o];
    if (!object.is_vehicle()) continue;
    const auto motion = object.motion.At(t);
    if (!motion) continue;
    boxes.push_back({o, {motion->position(), motion->yaw_rad, object.length_m, object.width_m}});
  }
  return boxes;
}

void JointView::MoveTo(Timestamp t) {
  constexpr std::int64_t kTick_us = 10'000;
  const std::int64_t tick = ToMicros(t) / kTick_us;
  if (tick == tick_) return;
  tick_ = tick;
  X_WB_ = log_.truth.EgoPose(t);
  boxes_ = TrueBoxes(log_.truth, t);
}

bool JointView::IsClear(const Eigen::Vector2d& from_W, const Eigen::Vector2d& place_W,
                        std::int64_t own_vehicle) const {
  for (const auto& outline : log_.specs.buildings) {
    if (LineMeets(from_W, place_W, outline)) return false;
  }
  for (const TrueBox& true_box : boxes_) {
    const bool is_own = log_.truth.objects[true_box.object].id == own_vehicle;
    if (true_box.box.DistanceTo(place_W) <= (is_own ? kOwnBox_m : 0.0)) continue;
    if (LineMeets(from_W, place_W, true_box.box)) return false;
  }
  return true;
}

bool JointView::Sees(Timestamp t, const Eigen::Vector2d& place_W, std::int64_t own_vehicle) {
  MoveTo(t);
  if (!X_WB_ || !place_W.allFinite()) return false;
  const Eigen::Vector2d p_B = (X_WB_->Inverse() * Point<World>{place_W.x(), place_W.y()}).vector();
  if (p_B.norm() < kNearest_m || p_B.norm() > kFarthest_m) return false;
  std::array<bool, kSensorKinds> sees{};
  for (const SensorSpec& sensor : log_.specs.sensors) {
    bool& by_kind = sees[static_cast<std::size_t>(sensor.kind)];
    if (by_kind) continue;
    if (!sensor.Covers(p_B)) continue;
    const Eigen::Vector2d from_W = (*X_WB_ * Point<Body>{sensor.x_m, sensor.y_m}).vector();
    if (!IsClear(from_W, place_W, own_vehicle)) continue;
    by_kind = true;
  }
  return std::ranges::count(sees, true) >= log_.specs.KindsThatCheck();
}

}  // namespace v2vouch::evaluation
