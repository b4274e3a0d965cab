// SPDX-License-Identifier: Apache-2.0
#include "sim/import/fcd.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "daemon/common/base/angle.h"
#include "tests/sim/import/files.h"

namespace v2vouch::sim {
namespace {

using testing::HasSubstr;

constexpr char kHeader[] =
    "time_s,id,type,lon_deg,lat_deg,x_m,y_m,heading_deg_cw_from_north,speed_mps,lane\n";

std::string Row(double time_s, const std::string& id, double x_m, double y_m, double heading_deg) {
  return std::to_string(time_s) + "," + id + ",car,7,51," + std::to_string(x_m) + "," +
         std::to_string(y_m) + "," + std::to_string(heading_deg) + ",10,l_0\n";
}

// Drives east at 10 m/s with 0.1 s steps.
FcdVehicle Eastbound(int steps) {
  FcdVehicle vehicle{"a", "car", {}};
  for (int k = 0; k < steps; ++k) {
    vehicle.samples.push_back({0.1 * k, {1.0 * k, 0.0}, 0.0, 51.0, 7.0});
  }
  return vehicle;
}

TEST(ReadFcd, HeadingsBecomeCounterClockwiseFromEast) {
  const ScratchFolder folder("fcd");
  std::string error;
  const auto vehicles = ReadFcd(
      folder.Write("f.csv", kHeader + Row(1.0, "a", 5, 6, 0.0) + Row(1.1, "a", 5, 7, 270.0)),
      error);
  ASSERT_EQ(vehicles.size(), 1u) << error;
  EXPECT_NEAR(vehicles[0].samples[0].heading_rad, 0.5 * kPi, 1e-12);
  EXPECT_NEAR(std::abs(vehicles[0].samples[1].heading_rad), kPi, 1e-12);
}

TEST(ReadFcd, AVehicleThatVanishesOrTeleportsCountsAsANewOne) {
  const ScratchFolder folder("fcd");
  std::string error;
  const auto vehicles =
      ReadFcd(folder.Write("f.csv", kHeader + Row(1.0, "a", 0, 0, 90) + Row(1.1, "a", 1, 0, 90) +
                                        Row(5.0, "a", 2, 0, 90) + Row(5.1, "a", 500, 0, 90)),
              error);
  ASSERT_EQ(vehicles.size(), 3u);
  EXPECT_EQ(vehicles[0].samples.size(), 2u);
  EXPECT_EQ(vehicles[2].id, "a");
}

TEST(ReadFcd, TimeThatStandsStillIsAFault) {
  const ScratchFolder folder("fcd");
  std::string error;
  EXPECT_TRUE(
      ReadFcd(folder.Write("f.csv", kHeader + Row(1.0, "a", 0, 0, 90) + Row(1.0, "a", 1, 0, 90)),
              error)
          .empty());
  EXPECT_THAT(error, HasSubstr(":3: time of this vehicle does not go forward"));
}

TEST(BodyOfType, NamesGiveClassAndSize) {
  EXPECT_EQ(BodyOfType("pkw").object_class, ObjectClass::kCar);
  EXPECT_EQ(BodyOfType("LKW_heavy").object_class, ObjectClass::kTruck);
  EXPECT_EQ(BodyOfType("city_bus").object_class, ObjectClass::kBus);
  EXPECT_EQ(BodyOfType("motorcycle").object_class, ObjectClass::kMotorcycle);
  EXPECT_GT(BodyOfType("trailer").length_m, BodyOfType("truck").length_m);
}

TEST(CentreMotion, AStraightDriveIsTheBumperHalfALengthBack) {
  const FcdBody body{ObjectClass::kCar, 4.0, 1.8};
  const auto motion = CentreMotion(Eastbound(50), body);
  ASSERT_EQ(motion.size(), 50u);
  for (std::size_t k = 0; k < motion.size(); ++k) {
    EXPECT_NEAR(motion[k].centre.x(), static_cast<double>(k) - 2.0, 1e-9);
    EXPECT_NEAR(motion[k].centre.y(), 0.0, 1e-9);
    EXPECT_NEAR(motion[k].speed_mps, 10.0, 1e-9);
    EXPECT_NEAR(motion[k].yaw_rad, 0.0, 1e-9);
  }
}

TEST(CentreMotion, ALaneChangeIsDrivenNotJumped) {
  FcdVehicle vehicle = Eastbound(100);
  for (std::size_t k = 50; k < 100; ++k) vehicle.samples[k].front.y() = 3.2;
  const auto motion = CentreMotion(vehicle, {});
  EXPECT_NEAR(motion[20].centre.y(), 0.0, 1e-6);
  EXPECT_NEAR(motion[95].centre.y(), 3.2, 0.02);
  for (std::size_t k = 1; k < motion.size(); ++k) {
    // 3.2 m over 20 m at 10 m/s peaks at 2.4 m/s sideways.
    EXPECT_LT(std::abs(motion[k].centre.y() - motion[k - 1].centre.y()), 0.26) << k;
    EXPECT_LT(std::abs(motion[k].yaw_rad - motion[k - 1].yaw_rad), 0.03) << k;
  }
}

// A towed axle on a circle settles on the circle of radius sqrt(r^2 - d^2) (tractrix).
TEST(CentreMotion, OnACircleTheBodyPointsAlongItsOwnWay) {
  constexpr double kRadius_m = 20.0;
  constexpr double kSpeed_mps = 5.0;
  FcdVehicle vehicle{"a", "car", {}};
  for (int k = 0; k < 300; ++k) {
    const double angle = kSpeed_mps / kRadius_m * 0.1 * k;
    vehicle.samples.push_back({0.1 * k,
                               {kRadius_m * std::sin(angle), kRadius_m * (1.0 - std::cos(angle))},
                               angle,
                               51.0,
                               7.0});
  }
  const FcdBody body{ObjectClass::kCar, 4.5, 1.8};
  const auto motion = CentreMotion(vehicle, body);
  const auto& late = motion[250];
  const double bumper_rad = kSpeed_mps / kRadius_m * 25.0;
  const double lag_rad = AngleDifference(bumper_rad, late.yaw_rad);
  EXPECT_NEAR(std::sin(lag_rad), 0.78 * 4.5 / kRadius_m, 0.005);
  const double rate = (motion[251].yaw_rad - motion[249].yaw_rad) / 0.2;
  EXPECT_NEAR(rate, kSpeed_mps / kRadius_m, 0.002);
}

TEST(CentreMotion, AStandingVehicleStandsStill) {
  FcdVehicle vehicle{"a", "car", {}};
  for (int k = 0; k < 30; ++k) vehicle.samples.push_back({0.1 * k, {7.0, 8.0}, 1.0, 51.0, 7.0});
  const auto motion = CentreMotion(vehicle, {});
  for (const CentreSample& sample : motion) {
    EXPECT_NEAR(sample.speed_mps, 0.0, 1e-9);
    EXPECT_NEAR(sample.yaw_rad, 1.0, 1e-9);
  }
}

}  // namespace
}  // namespace v2vouch::sim
