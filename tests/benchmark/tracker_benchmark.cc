// SPDX-License-Identifier: Apache-2.0
// The tracker's hot paths, each with the time we can afford on one ordinary core beside it. Targets
// of the parts add up to those of whole steps (docs/results/peers.md).
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "daemon/common/assignment/assignment.h"
#include "daemon/common/base/random.h"
#include "daemon/local/radar/dbscan.h"
#include "daemon/local/tracking/existence.h"
#include "daemon/local/tracking/place_index.h"
#include "daemon/local/tracking/tracker.h"
#include "daemon/local/visibility/visibility.h"
#include "sim/bench/traffic.h"

namespace v2vouch {
namespace {

const DetectabilityOf kVisible = [](const LocalTrack&) {
  return Detectability{.probability = 0.95};
};

struct PoseFrame {
  Timestamp time{};
  std::vector<PoseMeasurement> poses;
};

PoseMeasurement ToMeasurement(const bench::VehiclePose& p) {
  PoseMeasurement z{.x_m = p.x_m,
                    .y_m = p.y_m,
                    .yaw_rad = p.yaw_rad,
                    .speed_mps = p.speed_mps,
                    .yaw_rate_radps = p.yaw_rate_radps};
  z.covariance.diagonal() << 0.25, 0.25, 0.0025, 0.25, 0.0004;
  return z;
}

// Eight lanes of n vehicles with clutter and misses; a longer road for more vehicles.
std::vector<PoseFrame> Traffic(int vehicles, int frames) {
  std::vector<PoseFrame> out;
  const bench::TrafficSpec spec{
      .vehicles = vehicles, .seed = 1, .frames = frames, .heading_rad = 0.6};
  for (const bench::Frame& frame : bench::GenerateTraffic(spec)) {
    out.push_back({FromMicros(1'700'000'000'000'000) + FromSeconds(frame.time_s), {}});
    for (const auto& p : frame.detections) out.back().poses.push_back(ToMeasurement(p));
  }
  return out;
}

PoseSensor Sensor() {
  return {.clutter_per_m2 = 5e-4,
          .yaw_span_rad = 0.4,
          .speed_span_mps = 10.0,
          .yaw_rate_span_radps = 0.1};
}

constexpr int kWarmUp = 30;
constexpr int kFrames = 60;

Tracker WarmTracker(const std::vector<PoseFrame>& frames) {
  TrackerConfig config;
  config.point_targets = true;
  config.max_tracks = 4096;
  Tracker tracker(config, VehicleConfig{});
  for (std::size_t k = 0; k < kWarmUp; ++k) {
    tracker.Predict(frames[k].time);
    tracker.UpdatePoses(Sensor(), frames[k].poses, kVisible);
  }
  return tracker;
}

// Predict + associate + update of one frame. Can afford 0.1 / 0.5 / 1 / 3 ms at 10 / 50 / 100 / 200
// tracks, and less than the power 1.5 of their number from 100 to 2000 (scripts/measure_growth).
void BM_Step(benchmark::State& state) {
  const auto frames = Traffic(static_cast<int>(state.range(0)), kFrames);
  const Tracker warm = WarmTracker(frames);
  Tracker tracker = warm;
  std::size_t k = kWarmUp;
  for (auto _ : state) {
    if (k == frames.size()) {
      state.PauseTiming();
      tracker = warm;
      k = kWarmUp;
      state.ResumeTiming();
    }
    tracker.Predict(frames[k].time);
    tracker.UpdatePoses(Sensor(), frames[k].poses, kVisible);
    ++k;
  }
  state.counters["tracks"] = static_cast<double>(tracker.tracks().size());
}
BENCHMARK(BM_Step)->Arg(10)->Arg(50)->Arg(100)->Arg(200)->Arg(500)->Arg(1000)->Arg(2000)->Unit(
    benchmark::kMicrosecond);

// All tracks brought 10 ms ahead. Can afford 1 us per track.
void BM_Predict(benchmark::State& state) {
  const auto frames = Traffic(static_cast<int>(state.range(0)), kFrames);
  Tracker tracker = WarmTracker(frames);
  Timestamp time = frames[kWarmUp].time;
  for (auto _ : state) {
    time = time + FromSeconds(1e-4);
    tracker.Predict(time);
    benchmark::DoNotOptimize(tracker.tracks().data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(tracker.tracks().size()));
}
BENCHMARK(BM_Predict)->Arg(200)->Unit(benchmark::kMicrosecond);

TrackFilter SomeVehicle() {
  TrackFilter filter = TrackFilter::FromPose(ToMeasurement({.x_m = 30.0, .speed_mps = 20.0}));
  filter.Predict(0.1, FilterSettings{});
  return filter;
}
const bench::VehiclePose kSeen{.x_m = 32.3, .y_m = 0.2, .speed_mps = 20.4, .yaw_rad = 0.02};

// Gate of one pair, whole poses. Can afford 0.5 us.
void BM_GatePose(benchmark::State& state) {
  const TrackFilter filter = SomeVehicle();
  const PoseMeasurement z = ToMeasurement(kSeen);
  for (auto _ : state) benchmark::DoNotOptimize(filter.Evaluate(z, FilterSettings{}));
}
BENCHMARK(BM_GatePose)->Unit(benchmark::kNanosecond);

RadarMeasurement RadarReturn() {
  RadarMeasurement z{.returns = 4, .range_m = 30.0, .range_rate_mps = 20.0};
  z.covariance.diagonal() << 0.0625, 1e-4, 0.01;
  return z;
}

// Gate of one pair, radar on a vehicle with size. Can afford 1.5 us.
void BM_GateRadar(benchmark::State& state) {
  const TrackFilter filter = SomeVehicle();
  const EgoState ego;
  const VehicleConfig vehicle;
  const RadarLook look{ego, vehicle.radars[0]};
  const RadarMeasurement z = RadarReturn();
  for (auto _ : state) benchmark::DoNotOptimize(filter.Evaluate(look, z, FilterSettings{}));
}
BENCHMARK(BM_GateRadar)->Unit(benchmark::kNanosecond);

// Update of one track, whole pose. Can afford 2 us.
void BM_UpdatePose(benchmark::State& state) {
  const TrackFilter filter = SomeVehicle();
  const PoseMeasurement z = ToMeasurement(kSeen);
  for (auto _ : state) {
    TrackFilter updated = filter;
    benchmark::DoNotOptimize(updated.Update(z));
  }
}
BENCHMARK(BM_UpdatePose)->Unit(benchmark::kNanosecond);

// Update of one track, radar. Can afford 4 us.
void BM_UpdateRadar(benchmark::State& state) {
  const TrackFilter filter = SomeVehicle();
  const EgoState ego;
  const VehicleConfig vehicle;
  const RadarLook look{ego, vehicle.radars[0]};
  const RadarMeasurement z = RadarReturn();
  for (auto _ : state) {
    TrackFilter updated = filter;
    benchmark::DoNotOptimize(updated.Update(look, z, FilterSettings{}));
  }
}
BENCHMARK(BM_UpdateRadar)->Unit(benchmark::kNanosecond);

// Rows and columns along a road: each row has its own column and, every third, a rival's.
std::vector<SparsePair> RoadPairs(int n) {
  std::vector<SparsePair> pairs;
  Random random(1);
  for (int i = 0; i < n; ++i) {
    pairs.push_back({i, i, random.Uniform(-12.0, -2.0)});
    if (i % 3 == 0 && i + 1 < n) pairs.push_back({i, i + 1, random.Uniform(-6.0, 2.0)});
    if (i % 3 == 0 && i > 0) pairs.push_back({i, i - 1, random.Uniform(-6.0, 2.0)});
  }
  return pairs;
}

// Assignment over the gated pairs of n tracks. Can afford 0.5 us per track.
void BM_Assignment(benchmark::State& state) {
  const auto n = static_cast<std::size_t>(state.range(0));
  const auto pairs = RoadPairs(static_cast<int>(n));
  const std::vector<double> lone(n, 0.0);
  ClusteredAssignmentSolver solver;
  for (auto _ : state) benchmark::DoNotOptimize(solver.Solve(pairs, n, n, lone).data());
}
BENCHMARK(BM_Assignment)->Arg(200)->Arg(2000)->Unit(benchmark::kMicrosecond);

// One crowd that cannot be taken apart: every row reaches every column. Can afford 2 ms.
void BM_AssignmentDense(benchmark::State& state) {
  const auto n = static_cast<std::size_t>(state.range(0));
  Random random(1);
  std::vector<double> cost(n * n);
  for (double& c : cost) c = random.Uniform(-10.0, 0.0);
  const std::vector<double> lone(n, 0.0);
  AssignmentSolver solver;
  for (auto _ : state) benchmark::DoNotOptimize(solver.Solve(cost, n, n, lone).data());
}
BENCHMARK(BM_AssignmentDense)->Arg(200)->Unit(benchmark::kMicrosecond);

// Association probabilities of n tracks. Can afford 0.5 us per track.
void BM_Marginals(benchmark::State& state) {
  const auto n = static_cast<std::size_t>(state.range(0));
  std::vector<GatedPair> pairs;
  std::vector<int> assigned(n);
  for (const SparsePair& pair : RoadPairs(static_cast<int>(n))) {
    pairs.push_back({pair.row, pair.column, std::exp(-pair.cost)});
  }
  for (std::size_t i = 0; i < n; ++i) assigned[i] = static_cast<int>(i);
  const std::vector<double> missed(n, 0.05);
  AssociationMarginals marginals;
  for (auto _ : state) {
    marginals.Compute(pairs, missed, assigned, n);
    benchmark::DoNotOptimize(marginals.detected().data());
  }
}
BENCHMARK(BM_Marginals)->Arg(200)->Arg(2000)->Unit(benchmark::kMicrosecond);

// Places of n points, built and each searched once. Can afford 0.3 us per point.
void BM_PlaceIndex(benchmark::State& state) {
  const auto n = static_cast<std::size_t>(state.range(0));
  std::vector<Eigen::Vector2d> points;
  Random random(1);
  for (std::size_t i = 0; i < n; ++i) {
    points.emplace_back(random.Uniform(0.0, 2.3 * static_cast<double>(n)),
                        random.Uniform(-15.0, 15.0));
  }
  PlaceIndex index;
  for (auto _ : state) {
    index.Clear();
    for (std::size_t i = 0; i < n; ++i) index.Add(points[i], i);
    index.Sort();
    std::size_t visits = 0;
    for (const auto& p : points) index.ForEachNear(p, 6.0, [&](std::size_t) { ++visits; });
    benchmark::DoNotOptimize(visits);
  }
}
BENCHMARK(BM_PlaceIndex)->Arg(200)->Arg(2000)->Unit(benchmark::kMicrosecond);

// One question to the visibility map among n tracked boxes. Can afford 10 us among 50.
void BM_VisibilityQuery(benchmark::State& state) {
  VisibilityMap map(VisibilityConfig{}, VehicleConfig{});
  std::vector<Occluder> boxes;
  const int n = static_cast<int>(state.range(0));
  for (int i = 0; i < n; ++i) {
    boxes.push_back({.id = static_cast<std::uint64_t>(i + 1),
                     .centre_O = {12.0 + 14.0 * (i / 5), 3.7 * (i % 5 - 2)}});
  }
  map.SetScene(EgoState{}, boxes);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(map.Ask({SensorKind::kRadar, 0}, boxes[i]));
    i = (i + 1) % boxes.size();
  }
}
BENCHMARK(BM_VisibilityQuery)->Arg(10)->Arg(50)->Unit(benchmark::kNanosecond);

// Clusters of one scan: n reflections of cars and roadside. Can afford 0.2 ms for 300.
void BM_Dbscan(benchmark::State& state) {
  std::vector<Reflection> reflections;
  Random random(1);
  const int n = static_cast<int>(state.range(0));
  for (int i = 0; i < n; ++i) {
    const double x = 5.0 + 150.0 * (i / 4) / (n / 4.0) + random.Normal(0.0, 0.5);
    const double y = 3.7 * (i / 4 % 5 - 2) + random.Normal(0.0, 0.3);
    reflections.push_back({.range_m = std::hypot(x, y),
                           .azimuth_rad = std::atan2(y, x),
                           .x_m = x,
                           .y_m = y,
                           .ground_rate_mps = 5.0 * (i / 4 % 5 - 2)});
  }
  std::sort(reflections.begin(), reflections.end(),
            [](const Reflection& a, const Reflection& b) { return a.range_m < b.range_m; });
  std::vector<int> members;
  Dbscan dbscan;
  for (auto _ : state) {
    members.resize(reflections.size());
    for (int i = 0; i < n; ++i) members[static_cast<std::size_t>(i)] = i;
    benchmark::DoNotOptimize(dbscan.Run(reflections, Neighbourhood{}, members).data());
  }
}
BENCHMARK(BM_Dbscan)->Arg(300)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace v2vouch
