// SPDX-License-Identifier: Apache-2.0
// Errors that are the same in look after look: none of them averages out, so that no list may be
// surer of a place with every look.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cstdio>

#include "daemon/common/base/angle.h"
#include "daemon/local/tracking/track_filter.h"
#include "tests/daemon/local/tracking/scene.h"

namespace v2vouch {
namespace {

constexpr double kStep_s = 0.05;
constexpr double kMountSigma_rad = 0.02;  // Of each sensor, as it is found in cars.

struct Honesty {
  double nees = 0.0;  // Mean; 2 where the covariance is honest.
  int lists = 0;
};

// Cars in view of sensors that are mounted otherwise than the configuration says. The ego stands,
// or follows them.
Honesty Watch(double speed_mps) {
  Honesty out;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Scene scene(seed);
    Random random(seed + 500);
    scene.vehicle = OneRadarOneCamera();
    const VehicleConfig configured = scene.vehicle;
    scene.vehicle.radars[0].yaw_rad += random.Normal(0.0, kMountSigma_rad);
    scene.vehicle.cameras[0].yaw_rad += random.Normal(0.0, kMountSigma_rad);
    scene.ego.speed_mps = speed_mps;
    const bool drives = speed_mps > 0.0;
    scene.cars.push_back({.p_W = {18.0 + random.Uniform(0.0, 20.0), random.Uniform(-6.0, 6.0)},
                          .yaw_rad = drives ? 0.0 : random.Uniform(-kPi, kPi),
                          .speed_mps = speed_mps,
                          .length_m = random.Uniform(4.0, 5.4)});
    Tracker tracker(TrackerConfig{}, configured);
    for (int step = 0; step < 400; ++step) {
      scene.Advance(kStep_s);
      scene.Radar(tracker);
      if (step % 2 == 1) scene.Camera(tracker);
      const LocalTrack* track = Scene::Find(tracker, scene.cars[0], 6.0);
      if (step < 100 || track == nullptr) continue;
      const Eigen::Vector2d error = track->state_O.mean.head<2>() - scene.cars[0].p_W;
      const Eigen::Matrix2d P = track->state_O.covariance.topLeftCorner<2, 2>() +
                                track->lasting_variance_m2 * Eigen::Matrix2d::Identity();
      out.nees += error.dot(P.inverse() * error);
      ++out.lists;
    }
  }
  out.nees /= out.lists;
  return out;
}

void ExpectHonest(const char* who, double speed_mps, double most_nees) {
  const Honesty seen = Watch(speed_mps);
  std::printf("%s: ANEES %.2f in %d lists\n", who, seen.nees, seen.lists);
  ASSERT_GT(seen.lists, 5000);
  EXPECT_LT(seen.nees, most_nees);
  EXPECT_GT(seen.nees, 0.5);
}

TEST(LastingError, OfACarThatStandsIsPartOfItsCovariance) { ExpectHonest("standing", 0.0, 4.0); }

TEST(LastingError, OfACarThatIsFollowedIsPartOfItsCovariance) {
  ExpectHonest("followed", 8.0, 8.0);
}

// A detector that measures whole boxes tells how well it does.
TEST(LastingError, IsNotAddedToAMeasuredBox) {
  BoxMeasurement z;
  z.x_m = 20.0;
  z.length_m = 4.5;
  z.width_m = 1.8;
  z.position_covariance = 0.01 * Eigen::Matrix2d::Identity();
  z.yaw_sigma_rad = 0.05;
  z.length_sigma_m = z.width_sigma_m = 0.2;
  LocalTrack track;
  TrackFilter::FromBox(z).Show(FilterSettings{}, track);
  EXPECT_EQ(track.lasting_variance_m2, 0.0);
  EXPECT_LT(track.state_O.covariance(kX, kX), 0.03);
  EXPECT_LT(track.state_O.covariance(kY, kY), 0.03);
}

}  // namespace
}  // namespace v2vouch
