// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "daemon/common/base/angle.h"
#include "daemon/common/data/measurement.h"
#include "daemon/local/tracking/tracker.h"

namespace v2vouch {
namespace {

constexpr double kPeriod_s = 0.1;

BoxMeasurement At(double x, double y, double yaw) {
  BoxMeasurement z{.x_m = x, .y_m = y, .yaw_rad = yaw};
  z.position_covariance = 0.04 * Eigen::Matrix2d::Identity();
  z.log_odds = 2.0;
  return z;
}

struct Stand {
  void Step(const std::vector<BoxMeasurement>& boxes) {
    time = time + FromSeconds(kPeriod_s);
    tracker.Predict(time);
    tracker.UpdateBoxes(BoxSensor{}, boxes,
                        [](const LocalTrack&) { return Detectability{.probability = 0.9}; });
  }
  static TrackerConfig PointTargets() {
    TrackerConfig config;
    config.point_targets = true;
    return config;
  }

  Tracker tracker{PointTargets(), VehicleConfig{}};
  Timestamp time = FromMicros(1'700'000'000'000'000);
};

TEST(BoxTracking, LearnsTheSpeedThatNoBoxTells) {
  Stand stand;
  for (int k = 0; k < 20; ++k) stand.Step({At(10.0 + 2.0 * k, 3.0, 0.0)});
  ASSERT_EQ(stand.tracker.tracks().size(), 1u);
  const LocalTrack& track = stand.tracker.tracks()[0];
  EXPECT_TRUE(track.is_confirmed);
  EXPECT_NEAR(track.state_O.mean[kSpeed], 20.0, 0.2);
  EXPECT_NEAR(track.extent.length_m, 4.0, 1e-6);
}

TEST(BoxTracking, ABoxTurnedByAQuarterTearsNoTrack) {
  Stand stand;
  for (int k = 0; k < 20; ++k) stand.Step({At(10.0 + k, 3.0, k == 15 ? 0.5 * kPi : 0.0)});
  ASSERT_EQ(stand.tracker.tracks().size(), 1u);
  EXPECT_NEAR(std::abs(std::sin(stand.tracker.tracks()[0].state_O.mean[kYaw])), 0.0, 0.02);
}

TEST(BoxTracking, FrontAndRearMayBeConfused) {
  Stand stand;
  for (int k = 0; k < 20; ++k) stand.Step({At(10.0 + k, 3.0, k % 2 == 0 ? kPi : 0.0)});
  ASSERT_EQ(stand.tracker.tracks().size(), 1u);
  const KinematicState& state = stand.tracker.tracks()[0].state_O;
  EXPECT_NEAR(state.velocity().x(), 10.0, 0.2);
  EXPECT_GT(state.mean[kSpeed], 0.0);  // The motion decides.
}

TEST(BoxTracking, TheScoreDecidesHowFastATrackIsBelieved) {
  Stand sure, doubtful;
  for (int k = 0; k < 2; ++k) {
    BoxMeasurement z = At(10.0, 3.0, 0.0);
    sure.Step({z});
    z.log_odds = -9.0;
    doubtful.Step({z});
  }
  EXPECT_GT(sure.tracker.tracks()[0].existence, 0.9);
  EXPECT_LT(doubtful.tracker.tracks()[0].existence, 0.5);
}

TEST(BoxTracking, RefusedBoxesAreCountedAndTouchNothing) {
  Stand stand;
  for (int k = 0; k < 5; ++k) stand.Step({At(10.0, 3.0, 0.0)});
  const LocalTrack before = stand.tracker.tracks()[0];
  BoxMeasurement infinite = At(10.0, 3.0, 0.0);
  infinite.x_m = std::numeric_limits<double>::infinity();
  BoxMeasurement flat = At(10.0, 3.0, 0.0);
  flat.width_m = 0.0;
  BoxMeasurement sure = At(10.0, 3.0, 0.0);
  sure.position_covariance.setZero();
  stand.Step({infinite, flat, sure});
  EXPECT_EQ(stand.tracker.failures().size(), 3u);
  ASSERT_EQ(stand.tracker.tracks().size(), 1u);
  EXPECT_LT(stand.tracker.tracks()[0].existence, before.existence);  // A miss.
}

}  // namespace
}  // namespace v2vouch
