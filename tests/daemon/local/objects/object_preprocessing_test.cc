// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/objects/object_preprocessing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "daemon/common/base/angle.h"

namespace v2vouch {
namespace {

struct Stand {
  Stand() {
    vehicle.objects = {ObjectSensorConfig{}};
    source().x_m = 1.0;
    source().yaw_rad = 0.5 * kPi;  // Looks to the left.
    ego.X_OB = Pose<Odometry, Body>(100.0, 50.0, 0.5 * kPi);
    ego.speed_mps = 10.0;
  }
  ObjectSensorConfig& source() { return vehicle.objects[0]; }
  std::vector<BoxMeasurement> Process(const ObjectBox& object) {
    ObjectList list;
    list.objects = {object};
    std::vector<BoxMeasurement> boxes;
    ProcessObjects(list, vehicle, ego, boxes);
    return boxes;
  }

  VehicleConfig vehicle;
  EgoState ego;
};

// The body looks along O's y, the sensor to its left, which is along O's -x.
TEST(ProcessObjects, TurnsPositionAxisAndCovarianceIntoO) {
  Stand stand;
  ObjectBox object{.x_m = 20.0, .y_m = 3.0, .yaw_rad = 0.1, .score = 0.9};
  object.position_covariance << 0.04, 0.01, 0.01, 0.09;
  object.velocity_mps = Eigen::Vector2d(5.0, 1.0);
  const auto boxes = stand.Process(object);
  ASSERT_EQ(boxes.size(), 1U);
  EXPECT_NEAR(boxes[0].x_m, 80.0, 1e-9);
  EXPECT_NEAR(boxes[0].y_m, 48.0, 1e-9);
  EXPECT_NEAR(AngleDifference(boxes[0].yaw_rad, kPi + 0.1), 0.0, 1e-12);
  EXPECT_NEAR(boxes[0].position_covariance(0, 0), 0.04, 1e-12);
  EXPECT_NEAR(boxes[0].position_covariance(1, 1), 0.09, 1e-12);
  EXPECT_NEAR(boxes[0].position_covariance(0, 1), 0.01, 1e-12);
  EXPECT_NEAR(boxes[0].velocity_O_mps->x(), -5.0, 1e-12);
  EXPECT_NEAR(boxes[0].velocity_O_mps->y(), -1.0, 1e-12);
}

// What stands still in the world comes nearer to a sensor that drives towards it, and turns round
// one that turns.
TEST(ProcessObjects, AVelocityRelativeToTheSensorIsPutOverGround) {
  Stand stand;
  stand.source().velocity = VelocityReference::kSensor;
  stand.ego.yaw_rate_radps = 0.2;
  const ObjectBox object{.x_m = 20.0,
                         .y_m = 3.0,
                         .score = 0.9,
                         // In the sensor's axes: the car drives along the sensor's -y and turns to
                         // the left; the sensor sits 1 m ahead of the axle.
                         .velocity_mps = Eigen::Vector2d(0.2 * (3.0 - 1.0), 10.0 - 0.2 * 20.0)};
  const auto boxes = stand.Process(object);
  ASSERT_EQ(boxes.size(), 1U);
  EXPECT_NEAR(boxes[0].velocity_O_mps->norm(), 0.0, 1e-9) << boxes[0].velocity_O_mps->transpose();
}

TEST(ProcessObjects, WhatAnObjectDoesNotTellIsAsConfigured) {
  Stand stand;
  const auto boxes =
      stand.Process({.x_m = 20.0, .score = 0.9, .has_yaw = false, .has_size = false});
  ASSERT_EQ(boxes.size(), 1U);
  EXPECT_NEAR(boxes[0].position_covariance(0, 0), 0.09, 1e-12);
  EXPECT_FALSE(boxes[0].velocity_O_mps);
  EXPECT_NEAR(boxes[0].yaw_rad, 0.5 * kPi, 1e-12) << "along the ego's own direction";
  EXPECT_GT(boxes[0].yaw_sigma_rad, 0.5);
  EXPECT_NEAR(boxes[0].length_m, 4.6, 1e-12) << "any vehicle's";
  EXPECT_GT(boxes[0].length_sigma_m, 0.5);
}

TEST(ProcessObjects, AnAxisThatNobodyToldIsThatOfAFastVelocity) {
  Stand stand;
  ObjectBox object{.x_m = 20.0, .score = 0.9, .has_yaw = false};
  object.velocity_mps = Eigen::Vector2d(0.0, 12.0);
  EXPECT_NEAR(stand.Process(object)[0].yaw_rad, -0.5 * kPi, 1e-12);
  object.velocity_mps = Eigen::Vector2d(0.0, 1.0);
  EXPECT_NEAR(stand.Process(object)[0].yaw_rad, 0.5 * kPi, 1e-12);
}

TEST(ProcessObjects, LeavesOutWeakScoresOtherPlacesAndTheCarItself) {
  Stand stand;
  stand.source().half_fov_rad = FromDegrees(60.0);
  stand.source().min_range_m = 2.0;
  EXPECT_EQ(stand.Process({.x_m = 20.0, .score = 0.9}).size(), 1U);
  EXPECT_EQ(stand.Process({.x_m = 20.0, .score = 0.2}).size(), 0U);
  EXPECT_EQ(stand.Process({.x_m = 81.0, .score = 0.9}).size(), 0U);
  EXPECT_EQ(stand.Process({.x_m = 1.0, .score = 0.9}).size(), 0U);
  EXPECT_EQ(stand.Process({.x_m = 5.0, .y_m = 20.0, .score = 0.9}).size(), 0U);
  stand.source().min_range_m = 0.0;
  stand.source().half_fov_rad = kPi;
  EXPECT_EQ(stand.Process({.x_m = 0.3, .y_m = 0.2, .score = 0.9}).size(), 0U) << "the own car";
}

}  // namespace
}  // namespace v2vouch
