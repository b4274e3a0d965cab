// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/spoofing/spoof_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "daemon/common/base/angle.h"

namespace v2vouch::evaluation {
namespace {

constexpr std::int64_t kStart_us = 1'781'510'400'000'000;

std::vector<double> TwentyHertz(double length_s) {
  std::vector<double> times;
  for (int k = 0; k <= std::lround(length_s * 20.0); ++k) times.push_back(0.05 * k);
  return times;
}

}  // namespace

SpoofScene::SpoofScene(double length_s) {
  SensorSpec radar;
  radar.channel = "RADAR_FRONT";
  radar.half_fov_rad = FromDegrees(30);
  radar.max_range_m = 100.0;
  SensorSpec camera = radar;
  camera.channel = "CAMERA_FRONT";
  camera.kind = SensorKind::kCamera;
  camera.max_range_m = 120.0;
  log_.specs.is_given = true;
  log_.specs.sensors = {radar, camera};
  for (const double t : TwentyHertz(length_s)) {
    TruthSample ego;
    ego.stamp = At(t);
    log_.truth.ego.Add(ego);
  }
}

Timestamp SpoofScene::At(double t_s) const { return FromMicros(kStart_us) + FromSeconds(t_s); }

void SpoofScene::AddCar(std::int64_t id, const Eigen::Vector2d& p, double speed_mps,
                        std::uint32_t sender) {
  TruthObject car;
  car.id = id;
  car.object_class = 1;
  car.has_v2v = sender != 0;
  car.length_m = 4.0;
  car.width_m = 2.0;
  car.height_m = 1.5;
  for (const TruthSample& ego : log_.truth.ego.samples()) {
    TruthSample sample;
    sample.stamp = ego.stamp;
    sample.motion.x_m = p.x() + speed_mps * ToSeconds(ego.stamp - At(0.0));
    sample.motion.y_m = p.y();
    sample.motion.speed_mps = speed_mps;
    sample.sender = sender;
    sample.looks = {{"RADAR_FRONT", 1.0, 1.0}, {"CAMERA_FRONT", 1.0, 1.0}};
    car.motion.Add(sample);
  }
  log_.truth.objects.push_back(std::move(car));
}

TruthObject& SpoofScene::Car(std::int64_t id) {
  return *std::find_if(log_.truth.objects.begin(), log_.truth.objects.end(),
                       [&](const TruthObject& object) { return object.id == id; });
}

void SpoofScene::Hide(std::int64_t id, double from_s, double to_s) {
  TruthObject& car = Car(id);
  MotionSamples motion;
  for (TruthSample sample : car.motion.samples()) {
    if (sample.stamp >= At(from_s) && sample.stamp < At(to_s)) {
      sample.is_hidden = true;
      for (TruthLook& look : sample.looks) look = {look.sensor, 0.0, 0.0};
    }
    motion.Add(std::move(sample));
  }
  car.motion = std::move(motion);
}

BsmTruth& SpoofScene::Say(double t_s, std::int64_t device, std::uint32_t sender,
                          std::int64_t vehicle, int trust, const std::string& refusal) {
  BsmTruth m;
  m.stamp = At(t_s);
  m.seq = ++seq_;
  m.sender = sender;
  m.vehicle = vehicle;
  m.device = device;
  m.age_s = 0.05;
  if (vehicle != 0) {
    const auto motion = Car(vehicle).motion.At(m.stamp);
    m.honest = {motion->position(), motion->yaw_rad, motion->speed_mps, 0.0, 4.0, 2.0};
    m.claimed = m.honest;
  } else {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    m.honest.p_W = {kNone, kNone};
  }
  log_.bsm_truths.push_back(m);
  log_.bsm_verdicts.push_back({m.stamp, m.seq, sender, refusal.empty() ? trust : 0, refusal});
  log_.bsms.push_back({m.stamp, sender});
  return log_.bsm_truths.back();
}

void SpoofScene::AddTrack(std::int64_t id, std::uint32_t sender, const Eigen::Vector2d& p_W,
                          double budget_s) {
  ListedTrack track;
  track.id = id;
  track.sender = sender;
  track.motion_B.x_m = p_W.x();  // The ego's body frame is W.
  track.motion_B.y_m = p_W.y();
  track.object_class = 1;
  track.bridge_budget_s = budget_s;
  next_.tracks.push_back(track);
}

void SpoofScene::List(double t_s) {
  next_.received = next_.stamp = At(t_s);
  log_.lists[Index(ListKind::kPriority)].push_back(std::move(next_));
  next_ = {};
}

void SpoofScene::Report(double t_s, std::uint32_t sender, bool is_accusation) {
  log_.reports.push_back({At(t_s), sender, "level", is_accusation});
}

void SpoofScene::Look() {
  for (const TruthSample& ego : log_.truth.ego.samples()) {
    for (const std::size_t sensor : {0u, 1u}) log_.looks.push_back({ego.stamp, ego.stamp, sensor});
  }
}

void AtTenHertz(double from_s, double to_s, const std::function<void(double)>& what) {
  for (long k = std::lround(from_s * 10.0); k < std::lround(to_s * 10.0); ++k) {
    what(0.1 * static_cast<double>(k));
  }
}

}  // namespace v2vouch::evaluation
