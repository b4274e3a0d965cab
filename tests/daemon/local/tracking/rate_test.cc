// SPDX-License-Identifier: Apache-2.0
// Confirmation and deletion at other rates than the shipped 20 Hz: of one sensor, of several
// sensors, and of frames that look elsewhere.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/daemon/local/tracking/scene.h"

namespace v2vouch {
namespace {

constexpr double kRates_hz[] = {5.0, 10.0, 20.0, 50.0};
constexpr int kSeeds = 20;

/// One radar at `rate_hz`, and a second one that looks backwards and sees nothing of the scene; it
/// makes the tracker step more often without looking more often.
Scene SceneAt(double rate_hz, std::uint64_t seed) {
  Scene scene(seed);
  scene.vehicle.radars[0].period_s = 1.0 / rate_hz;
  RadarConfig rear = scene.vehicle.radars[0];
  rear.x_m = -1.0;
  rear.yaw_rad = kPi;
  scene.vehicle.radars.push_back(rear);
  return scene;
}

/// A frame of the rear radar, which covers no track.
void LookBack(Scene& scene, Tracker& tracker) {
  tracker.Predict(scene.now());
  tracker.UpdateRadar(1, scene.ego_state(), {}, [](const LocalTrack&) {
    return Detectability{0.0, Visibility::kVisible};
  });
}

struct Course {
  double confirm_looks = 0.0;
  double confirm_s = 0.0;
  double delete_s = 0.0;  ///< From the first look that misses to the end of its publication.
  double forget_s = 0.0;  ///< ... to the end of the track.
};

double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
}

/// A car comes towards us, is followed for 3 s and is then gone although the place is in view.
/// Medians over seeds.
/// @param between frames of the rear radar between two looks of the front radar.
Course Follow(double rate_hz, int between) {
  const double period_s = 1.0 / rate_hz;
  std::vector<double> looks, confirm, fall, forget;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Scene scene = SceneAt(rate_hz, seed);
    scene.cars.push_back({.p_W = {70.0, 2.0}, .yaw_rad = kPi, .speed_mps = 8.0});
    Tracker tracker(TrackerConfig{}, scene.vehicle);
    const auto step = [&] {
      for (int i = 0; i < between; ++i) {
        scene.Advance(period_s / (between + 1));
        LookBack(scene, tracker);
      }
      scene.Advance(period_s / (between + 1));
      scene.Radar(tracker);
    };
    int look = 0;
    while (Scene::Confirmed(tracker) == 0 && look < 100) {
      step();
      ++look;
    }
    looks.push_back(look);
    confirm.push_back((look - 1) * period_s);
    while (scene.time_s() < 3.0) step();
    EXPECT_EQ(Scene::Confirmed(tracker), 1) << rate_hz << " Hz, seed " << seed;
    scene.cars[0].is_absent = true;
    const double gone_s = scene.time_s();
    while (Scene::Confirmed(tracker) > 0 && scene.time_s() < gone_s + 10.0) step();
    fall.push_back(scene.time_s() - gone_s);
    while (!tracker.tracks().empty() && scene.time_s() < gone_s + 20.0) step();
    forget.push_back(scene.time_s() - gone_s);
  }
  return {Median(looks), Median(confirm), Median(fall), Median(forget)};
}

TEST(Rates, ConfirmationTakesThreeLooksAtAnyRate) {
  for (const double rate_hz : kRates_hz) {
    const Course course = Follow(rate_hz, 0);
    std::printf(
        "%4.0f Hz: confirmed in %.1f looks, %.2f s; missing: unpublished after %.2f s, "
        "forgotten after %.2f s\n",
        rate_hz, course.confirm_looks, course.confirm_s, course.delete_s, course.forget_s);
    EXPECT_EQ(course.confirm_looks, 3.0) << rate_hz;
  }
}

TEST(Rates, FramesThatLookElsewhereChangeNothing) {
  for (const double rate_hz : {5.0, 20.0}) {
    const Course alone = Follow(rate_hz, 0);
    for (const int between : {1, 4}) {
      const Course course = Follow(rate_hz, between);
      EXPECT_EQ(course.confirm_looks, alone.confirm_looks) << rate_hz << " Hz, " << between;
      EXPECT_NEAR(course.delete_s, alone.delete_s, 0.05 + 1e-9) << rate_hz << " Hz, " << between;
      EXPECT_NEAR(course.forget_s, alone.forget_s, 0.05 + 1e-9) << rate_hz << " Hz, " << between;
    }
  }
}

TEST(Rates, AVisibleButMissingVehicleGoesAfterTheSameTimeAtAnyRate) {
  double mean_s = 0.0;
  for (const double rate_hz : kRates_hz) mean_s += Follow(rate_hz, 0).delete_s / 4.0;
  for (const double rate_hz : kRates_hz) {
    EXPECT_NEAR(Follow(rate_hz, 0).delete_s / mean_s, 1.0, 0.3) << rate_hz << " Hz";
  }
}

}  // namespace
}  // namespace v2vouch
