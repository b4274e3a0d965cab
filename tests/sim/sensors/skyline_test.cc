// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/skyline.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/sim/sensors/scene.h"

namespace v2vouch::sim {
namespace {

// The raster must agree with casting every ray at every outline by itself.
TEST(Skyline, AgreesWithPlainRayCasting) {
  std::mt19937_64 rng(20240611);
  std::uniform_real_distribution<double> place(-40.0, 40.0);
  std::uniform_real_distribution<double> angle(-kPi, kPi);
  for (int trial = 0; trial < 20; ++trial) {
    Scenario scenario = StandingEgo();
    for (std::uint32_t id = 1; id <= 8; ++id) {
      Vec2 p(place(rng), place(rng));
      if (p.norm() < 6.0) p += Vec2(12.0, 0.0);
      AddVehicle(scenario, id, p.x(), p.y(), angle(rng));
    }
    scenario.buildings.push_back({.x_m = 30, .y_m = 35, .yaw_rad = 0.4});
    const auto world = MakeWorld(scenario);
    const Snapshot snapshot = world->At(0.0);
    const double yaw = angle(rng);
    Skyline skyline(kPi, FromDegrees(0.5));
    skyline.Cast({0, 0}, yaw, 200.0, snapshot, world->walls());
    for (int ray = 0; ray < skyline.size(); ++ray) {
      const Vec2 direction = Direction(yaw + skyline.azimuth_rad(ray));
      double nearest = std::numeric_limits<double>::infinity();
      for (const ActorState& actor : snapshot.actors) {
        const auto corners = actor.box().Corners();
        const auto hit = RayHitsOutline({0, 0}, direction, {corners.begin(), corners.end()});
        if (hit) nearest = std::min(nearest, *hit);
      }
      for (const Wall& wall : world->walls()) {
        const auto hit = RayHitsOutline({0, 0}, direction, wall.outline);
        if (hit) nearest = std::min(nearest, *hit);
      }
      const double got = skyline.FreeRange(skyline.azimuth_rad(ray));
      if (std::isinf(nearest)) {
        EXPECT_TRUE(std::isinf(got));
      } else {
        EXPECT_NEAR(got, nearest, 1e-6) << "ray " << ray;
      }
    }
  }
}

}  // namespace
}  // namespace v2vouch::sim
