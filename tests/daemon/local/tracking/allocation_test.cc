// SPDX-License-Identifier: Apache-2.0
// The step of the tracker takes no memory once its buffers have grown.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <new>
#include <vector>

#include "daemon/local/tracking/tracker.h"
#include "sim/bench/traffic.h"
#include "tests/daemon/local/tracking/scene.h"

namespace {
std::size_t allocations = 0;
}  // namespace

// Every way to take memory through operator new ends here. Not inlined: GCC would see malloc meet
// delete, and warn.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  void* const memory = std::malloc(size == 0 ? 1 : size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  ++allocations;
  const auto step = static_cast<std::size_t>(alignment);
  void* const memory = std::aligned_alloc(step, (size + step - 1) / step * step);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}

namespace v2vouch {
namespace {

// One look of one kind, made beforehand.
struct Look {
  Timestamp time{};
  EgoState ego{};
  bool is_picture = false;
  std::vector<RadarMeasurement> scan{};
  std::vector<CameraMeasurement> picture{};
  std::vector<PoseMeasurement> poses{};
};

struct Steps {
  DetectabilityOf detectability = [](const LocalTrack&) {
    return Detectability{.probability = 0.9};
  };
  PoseSensor pose_sensor;

  void operator()(Tracker& tracker, const Look& look) const {
    tracker.Predict(look.time);
    if (!look.poses.empty()) {
      tracker.UpdatePoses(pose_sensor, look.poses, detectability);
    } else if (look.is_picture) {
      tracker.UpdateCamera(0, look.ego, look.picture, detectability);
    } else {
      tracker.UpdateRadar(0, look.ego, look.scan, detectability);
    }
  }
};

// Allocations of the second half of the looks, run again from where the first half had led.
std::size_t CountSecondTime(Tracker& tracker, const std::vector<Look>& looks) {
  const Steps step;
  const std::size_t half = looks.size() / 2;
  for (std::size_t k = 0; k < half; ++k) step(tracker, looks[k]);
  const Tracker checkpoint = tracker;
  for (std::size_t k = half; k < looks.size(); ++k) step(tracker, looks[k]);
  EXPECT_GE(tracker.tracks().size(), 8u);
  tracker = checkpoint;  // Keeps the memory of its buffers.
  const std::size_t before = allocations;
  for (std::size_t k = half; k < looks.size(); ++k) step(tracker, looks[k]);
  return allocations - before;
}

TEST(Allocation, TheCounterCounts) {
  const std::size_t before = allocations;
  const std::vector<int> some(100);
  EXPECT_EQ(allocations - before, 1u);
  EXPECT_EQ(some.size(), 100u);
}

TEST(Allocation, RadarAndCameraStepsTakeNone) {
  Scene scene(11);
  scene.clutter = 2.0;
  scene.standing = 10;
  scene.ego.speed_mps = 10.0;
  for (int i = 0; i < 10; ++i) {
    scene.cars.push_back({.p_W = {15.0 + 12.0 * i, 3.5 * (i % 3 - 1)}, .speed_mps = 10.0});
  }
  std::vector<Look> looks;
  for (int k = 0; k < 120; ++k) {
    scene.Advance(0.05);
    looks.push_back({.time = scene.now(), .ego = scene.ego_state(), .scan = scene.Scan(0)});
    if (k % 2 == 0) continue;
    looks.push_back({.time = scene.now(),
                     .ego = scene.ego_state(),
                     .is_picture = true,
                     .picture = scene.Picture(0)});
  }
  Tracker tracker(TrackerConfig{}, scene.vehicle);
  EXPECT_EQ(CountSecondTime(tracker, looks), 0u);
}

TEST(Allocation, PoseStepsTakeNone) {
  std::vector<Look> looks;
  for (const bench::Frame& frame : bench::GenerateTraffic({.vehicles = 100, .seed = 11})) {
    Look look{.time = FromMicros(1'700'000'000'000'000) + FromSeconds(frame.time_s)};
    for (const bench::VehiclePose& p : frame.detections) {
      look.poses.push_back({.x_m = p.x_m,
                            .y_m = p.y_m,
                            .yaw_rad = p.yaw_rad,
                            .speed_mps = p.speed_mps,
                            .yaw_rate_radps = p.yaw_rate_radps});
      look.poses.back().covariance.diagonal() << 0.25, 0.25, 0.0025, 0.25, 0.0004;
    }
    looks.push_back(look);
  }
  TrackerConfig config;
  config.point_targets = true;
  Tracker tracker(config, VehicleConfig{});
  EXPECT_EQ(CountSecondTime(tracker, looks), 0u);
}

}  // namespace
}  // namespace v2vouch
