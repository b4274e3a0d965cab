// SPDX-License-Identifier: Apache-2.0
// One step of v2vouch-warn. Time we can afford: 5 ms with 50 tracks.
#include <benchmark/benchmark.h>

#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/warnings/warner.h"

namespace v2vouch::warnings {
namespace {

const Timestamp kStart = FromMicros(1'781'510'400'000'000);

// Vehicles in front of the ego, on three lanes and from both sides, all of them possible conflicts.
TargetList ListOf(int tracks, Timestamp t) {
  TargetList list;
  list.stamp = t;
  list.seq = 1;
  list.sectors = {{-kPi, kPi - 1e-3, 300.0, SectorState::kWatched}};
  for (int i = 0; i < tracks; ++i) {
    Target target;
    target.local_id = i + 1;
    const double row = i / 5;
    const double lane = i % 5;
    const double yaw = lane < 3.0 ? 0.0 : lane < 4.0 ? kPi : -0.5 * kPi;
    target.state_O.mean << 15.0 + 8.0 * row, lane < 4.0 ? 3.5 * (lane - 1.0) : 15.0 + 4.0 * row,
        yaw, 8.0 + row, 0.02, -0.3;
    target.state_O.covariance.setZero();
    target.state_O.covariance.diagonal() << 0.09, 0.09, 0.0025, 0.25, 0.0025, 0.25;
    target.extent = {4.5, 1.8, 0.2, 0.1};
    target.last_own = t;
    list.targets.push_back(target);
  }
  return list;
}

void Step(benchmark::State& state) {
  Warner warner({}, {});
  Timestamp t = kStart;
  for (auto _ : state) {
    t += Duration(50'000);
    warner.OnEgo({t, 13.0, 0.1, 0.0, 0.005, 0.0});
    warner.OnLocal(ListOf(static_cast<int>(state.range(0)), t));
    TargetList nothing = ListOf(0, t);
    benchmark::DoNotOptimize(warner.OnPriority(nothing));
  }
}
BENCHMARK(Step)->Arg(10)->Arg(50)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace v2vouch::warnings
