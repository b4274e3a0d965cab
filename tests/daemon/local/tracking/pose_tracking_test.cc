// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/random.h"
#include "daemon/local/tracking/tracker.h"

namespace v2vouch {
namespace {

constexpr double kPeriod_s = 0.1;
const DetectabilityOf kVisible = [](const LocalTrack&) {
  return Detectability{.probability = 0.95};
};

// A sensor of whole poses that looks at vehicles on straight lines, ten times a second.
struct Stand {
  explicit Stand(const TrackerConfig& config = {}) : tracker(config, VehicleConfig{}) {}

  // Vehicles that move on by one period and are seen without noise.
  void Look(std::vector<PoseMeasurement>& vehicles) {
    Step(vehicles);
    for (PoseMeasurement& z : vehicles) {
      z.x_m += kPeriod_s * z.speed_mps * std::cos(z.yaw_rad);
      z.y_m += kPeriod_s * z.speed_mps * std::sin(z.yaw_rad);
    }
  }
  void Step(const std::vector<PoseMeasurement>& poses) {
    time = time + FromSeconds(kPeriod_s);
    tracker.Predict(time);
    tracker.UpdatePoses(PoseSensor{}, poses, kVisible);
  }
  int Confirmed() const {
    int count = 0;
    for (const LocalTrack& track : tracker.tracks()) count += track.is_confirmed ? 1 : 0;
    return count;
  }

  Tracker tracker;
  Timestamp time = FromMicros(1'700'000'000'000'000);
};

PoseMeasurement At(double x, double y, double yaw, double speed) {
  PoseMeasurement z{.x_m = x, .y_m = y, .yaw_rad = yaw, .speed_mps = speed};
  z.covariance.diagonal() << 0.25, 0.25, 0.0025, 0.25, 0.0004;
  return z;
}

TEST(PoseTracking, ATrackIsAVehicleFromItsFirstPoseOn) {
  Stand stand;
  stand.Step({At(20.0, -3.0, 2.0, 15.0)});
  ASSERT_EQ(stand.tracker.tracks().size(), 1u);
  const LocalTrack& track = stand.tracker.tracks()[0];
  EXPECT_FALSE(track.is_confirmed);
  EXPECT_NEAR(track.state_O.mean[kX], 20.0, 1e-12);
  EXPECT_NEAR(track.state_O.mean[kYaw], 2.0, 1e-12);
  EXPECT_NEAR(track.state_O.mean[kSpeed], 15.0, 1e-12);
  EXPECT_NEAR(track.state_O.covariance(kYaw, kYaw), 0.0025, 1e-12);
}

TEST(PoseTracking, ConfirmsInThreeLooksAndEndsAfterAFewMisses) {
  Stand stand;
  std::vector<PoseMeasurement> vehicles = {At(0.0, 0.0, 0.0, 20.0), At(0.0, 4.0, kPi, 20.0)};
  for (int k = 0; k < 3; ++k) stand.Look(vehicles);
  EXPECT_EQ(stand.Confirmed(), 2);
  for (int k = 0; k < 20; ++k) stand.Look(vehicles);
  EXPECT_GT(stand.tracker.tracks()[0].existence, 0.999);
  for (int k = 0; k < 6; ++k) stand.Step({});
  EXPECT_TRUE(stand.tracker.tracks().empty());
}

TEST(PoseTracking, TellsWhichPoseEachTrackWasGiven) {
  Stand stand;
  std::vector<PoseMeasurement> vehicles = {At(0.0, 0.0, 0.0, 20.0), At(0.0, 8.0, kPi, 20.0)};
  stand.Look(vehicles);
  const std::uint64_t first = stand.tracker.tracks()[0].id;
  std::swap(vehicles[0], vehicles[1]);
  stand.Step(vehicles);
  ASSERT_EQ(stand.tracker.pose_updates().size(), 2u);
  EXPECT_EQ(stand.tracker.pose_updates()[0].track_id, first);
  EXPECT_EQ(stand.tracker.pose_updates()[0].pose, 1u);
  EXPECT_TRUE(stand.tracker.updates().empty());
}

TEST(PoseTracking, SpeedAndDirectionTellClutterFromTheVehicle) {
  // Ten looks; in each a false pose stands right on the vehicle, but drives the other way.
  Stand stand;
  std::vector<PoseMeasurement> vehicles = {At(0.0, 0.0, 0.3, 20.0)};
  for (int k = 0; k < 10; ++k) {
    PoseMeasurement clutter = vehicles[0];
    clutter.yaw_rad += 0.5 + 0.4 * k;
    std::vector<PoseMeasurement> poses = {clutter, vehicles[0]};
    stand.Step(poses);
    stand.Look(vehicles);
  }
  EXPECT_EQ(stand.Confirmed(), 1);
  EXPECT_NEAR(stand.tracker.tracks()[0].state_O.mean[kYaw], 0.3, 0.02);
}

TEST(PoseTracking, TwoBoxesOfOneFrameAreTwoVehiclesHoweverClose) {
  Stand stand;
  std::vector<PoseMeasurement> vehicles = {At(0.0, 0.0, 0.0, 20.0), At(0.0, 1.7, 0.0, 20.5)};
  for (int k = 0; k < 30; ++k) stand.Look(vehicles);
  EXPECT_EQ(stand.Confirmed(), 2);
}

TEST(PoseTracking, ARadarTrackBecomesTheVehicleThatThePoseDescribes) {
  Stand stand;
  const EgoState ego;
  RadarMeasurement z{.range_m = 40.0, .range_rate_mps = 15.0, .ground_range_rate_mps = 15.0};
  z.covariance.diagonal() << 0.0625, 1e-4, 0.01;
  stand.time = stand.time + FromSeconds(kPeriod_s);
  stand.tracker.Predict(stand.time);
  const std::vector<RadarMeasurement> scan = {z};
  stand.tracker.UpdateRadar(0, ego, scan, kVisible);
  ASSERT_EQ(stand.tracker.tracks().size(), 1u);
  const std::uint64_t id = stand.tracker.tracks()[0].id;
  const Eigen::Vector2d p = stand.tracker.tracks()[0].state_O.mean.head<2>();
  stand.Step({At(p.x() + 1.5, p.y(), 0.4, 15.0)});
  ASSERT_EQ(stand.tracker.tracks().size(), 1u);
  EXPECT_EQ(stand.tracker.tracks()[0].id, id);
  EXPECT_NEAR(stand.tracker.tracks()[0].state_O.mean[kYaw], 0.4, 1e-9);
}

TEST(PoseTracking, RefusedPosesAreCountedAndTouchNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Stand clean, dirty;
  std::vector<PoseMeasurement> vehicles = {At(0.0, 0.0, 0.0, 20.0), At(50.0, 4.0, kPi, 20.0)};
  for (int k = 0; k < 10; ++k) {
    std::vector<PoseMeasurement> poses = vehicles;
    PoseMeasurement zero = vehicles[0];
    zero.covariance.setZero();
    PoseMeasurement negative = vehicles[0];
    negative.covariance(1, 1) = -1.0;
    poses.insert(poses.end(), {zero, negative, At(nan, 0.0, 0.0, 1.0), At(1e300, 0.0, 0.0, 1.0)});
    dirty.Step(poses);
    ASSERT_EQ(dirty.tracker.failures().size(), 4u);
    EXPECT_EQ(dirty.tracker.failures()[0], Reason::kOutOfRange);
    EXPECT_EQ(dirty.tracker.failures()[1], Reason::kOutOfRange);
    EXPECT_EQ(dirty.tracker.failures()[2], Reason::kNotFinite);
    EXPECT_EQ(dirty.tracker.failures()[3], Reason::kOutOfRange);
    clean.Look(vehicles);
    EXPECT_TRUE(clean.tracker.failures().empty());
    ASSERT_EQ(clean.tracker.tracks().size(), dirty.tracker.tracks().size());
    for (std::size_t i = 0; i < clean.tracker.tracks().size(); ++i) {
      EXPECT_EQ(clean.tracker.tracks()[i].state_O.mean, dirty.tracker.tracks()[i].state_O.mean);
      EXPECT_EQ(clean.tracker.tracks()[i].existence, dirty.tracker.tracks()[i].existence);
    }
  }
}

}  // namespace
}  // namespace v2vouch
