// SPDX-License-Identifier: Apache-2.0
#include "tests/support/flood.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/random.h"

namespace v2vouch::testing {
namespace {

constexpr SenderId kFirstId = 0x10000000;

}  // namespace

std::vector<Input> FloodOf(FloodKind kind, double rate_hz, double from_s,
                           const SyntheticDrive& drive) {
  std::vector<Input> flood;
  if (kind == FloodKind::kNone) return flood;
  Random random = Random::ForSubject(drive.seed, 5000);
  const int identities = std::max(1, static_cast<int>(rate_hz / 10.0));
  const double reach_m = kind == FloodKind::kCrowd ? 500.0 : 60.0;
  const SyntheticCar model = drive.cars.empty() ? SyntheticCar{} : drive.cars.front();
  std::vector<SyntheticCar> cars;
  for (int i = 0; i < identities; ++i) {
    SyntheticCar car = model;
    car.sender = kFirstId + static_cast<SenderId>(i);
    car.is_real = false;
    const double x = random.Uniform(-reach_m, reach_m);
    const double y = random.Uniform(-reach_m, reach_m);
    car.x_m = (kind == FloodKind::kCrowd ? 0.0 : model.x_m) + x;
    car.y_m = model.y_m + y;
    cars.push_back(car);
  }
  const int messages = static_cast<int>(rate_hz * (drive.duration_s - from_s));
  for (int i = 0; i < messages; ++i) {
    const double t = from_s + i / rate_hz;
    SyntheticCar car = cars[static_cast<std::size_t>(i % identities)];
    int count = i / identities;
    if (kind == FloodKind::kOneId) {
      car = cars.front();
      count = i;
    } else if (kind == FloodKind::kRandom || kind == FloodKind::kRefused) {
      car.sender = kFirstId + static_cast<SenderId>(random.Bits() % 0x7fffffff);
      car.x_m = drive.ego_speed_mps * t + random.Uniform(-300.0, 300.0);
      car.y_m = random.Uniform(-300.0, 300.0);
    }
    Bsm bsm = SpokenAt(car, t, count, random);
    bsm.seq = 1'000'000'000 + i;
    if (kind == FloodKind::kRefused) bsm.speed_mps = 75.0;
    flood.emplace_back(bsm);
  }
  return flood;
}

std::vector<Input> Merged(std::vector<Input> inputs, const std::vector<Input>& more) {
  inputs.insert(inputs.end(), more.begin(), more.end());
  std::ranges::stable_sort(inputs, {}, [](const Input& input) { return HeaderOf(input).stamp; });
  return inputs;
}

}  // namespace v2vouch::testing
