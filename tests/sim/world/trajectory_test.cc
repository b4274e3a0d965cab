// SPDX-License-Identifier: Apache-2.0
#include "sim/world/trajectory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

namespace v2vouch::sim {
namespace {

Path Straight() {
  Path path;
  std::string problem;
  EXPECT_TRUE(Path::Make({{{0, 0}, 10}, {{500, 0}, 10}}, path, problem));
  return path;
}

TEST(Drive, FrontBumperStopsAtTheLineUntilItMayGo) {
  DriveSpec drive;
  drive.start_m = 20;
  drive.speed_mps = 12;
  drive.stops = {{100.0, 25.0}};
  const auto trajectory = Trajectory::Drive(Straight(), drive, 4.0, 1.12, 40);
  const Motion standing = trajectory.At(24);
  EXPECT_NEAR(standing.centre.x() + 2.0, 100.0, 0.15);
  EXPECT_NEAR(standing.speed_mps, 0.0, 0.01);
  EXPECT_NEAR(trajectory.At(40).speed_mps, 12.0, 0.05);
}

TEST(Drive, AccelerationIsContinuousAndWithinTheDriversLimits) {
  DriveSpec drive;
  drive.speed_mps = 10;
  drive.speeds = {{5.0, 15.0}, {12.0, 4.0}};
  drive.stops = {{150.0, 30.0}};
  const auto trajectory = Trajectory::Drive(Straight(), drive, 4.0, 1.12, 30);
  for (double t = 0.1; t < 29.0; t += 0.05) {
    const double accel = trajectory.At(t).accel_mps2;
    EXPECT_LT(accel, drive.accel_mps2 + 0.05) << "t = " << t;
    EXPECT_GT(accel, -drive.decel_mps2 - 0.05) << "t = " << t;
    EXPECT_LT(std::abs(trajectory.At(t + 0.05).accel_mps2 - accel), 0.5) << "t = " << t;
  }
}

TEST(Drive, VelocityIsTheDerivativeOfPlaceAndCentreSwingsOut) {
  Path path;
  std::string problem;
  ASSERT_TRUE(Path::Make({{{0, 0}, 10}, {{60, 0}, 10}, {{60, 80}, 10}}, path, problem));
  DriveSpec drive;
  drive.start_m = 20;
  drive.speed_mps = 8;
  const auto trajectory = Trajectory::Drive(path, drive, 4.5, 1.26, 20);
  double largest_slip = 0.0;
  for (double t = 0.2; t < 19.0; t += 0.1) {
    const Motion motion = trajectory.At(t);
    const Vec2 velocity = (trajectory.At(t + 0.05).centre - trajectory.At(t - 0.05).centre) / 0.1;
    EXPECT_LT((velocity - motion.velocity).norm(), 0.02) << "t = " << t;
    const double lateral = motion.velocity.dot(LeftOf(Direction(motion.yaw_rad)));
    // A rigid body whose rear axle rolls: the centre moves sideways by yaw rate times lever.
    EXPECT_NEAR(lateral, 1.26 * motion.yaw_rate_radps, 0.03) << "t = " << t;
    largest_slip = std::max(largest_slip, std::abs(lateral));
  }
  EXPECT_GT(largest_slip, 0.3);
}

TEST(Drive, LaneChangeEndsOnTheOffset) {
  DriveSpec drive;
  drive.speed_mps = 20;
  drive.lane_changes = {{2.0, 4.0, 3.5}};
  const auto trajectory = Trajectory::Drive(Straight(), drive, 4.0, 1.12, 10);
  EXPECT_NEAR(trajectory.At(1.5).centre.y(), 0.0, 1e-6);
  EXPECT_NEAR(trajectory.At(6.5).centre.y(), 3.5, 1e-3);
  EXPECT_GT(trajectory.At(4.0).yaw_rad, 0.05);
}

TEST(Follow, GoesSmoothlyThroughRecordedRows) {
  std::vector<Trajectory::Row> rows;
  for (int i = 0; i <= 100; ++i) {
    const double t = 0.1 * i;
    rows.push_back(
        {5.0 + t, {10.0 * t, 2.0 * std::sin(0.5 * t)}, std::atan2(std::cos(0.5 * t), 10.0)});
  }
  const auto trajectory = Trajectory::Follow(rows);
  EXPECT_FALSE(trajectory.Exists(4.9));
  EXPECT_TRUE(trajectory.Exists(10.0));
  EXPECT_FALSE(trajectory.Exists(15.1));
  const Motion motion = trajectory.At(10.03);
  EXPECT_NEAR(motion.centre.x(), 50.3, 0.01);
  EXPECT_NEAR(motion.centre.y(), 2.0 * std::sin(0.5 * 5.03), 0.03);
  EXPECT_NEAR(motion.speed_mps, 10.0, 0.1);
}

TEST(LoadTrajectories, NamesTheBadRow) {
  const auto path = std::filesystem::temp_directory_path() / "v2vouch_bad_rows.csv";
  std::ofstream(path) << "time_s,id,class,x_m,y_m,yaw_rad,speed_mps,length_m,width_m\n"
                      << "0.0,7,car,0,0,0,10,4.5,1.8\n0.1,7,spaceship,1,0,0,10,4.5,1.8\n";
  std::map<std::uint32_t, Recorded> vehicles;
  std::vector<std::string> problems;
  EXPECT_FALSE(LoadTrajectories(path.string(), vehicles, problems));
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_NE(problems[0].find(":3:"), std::string::npos) << problems[0];
  std::filesystem::remove(path);
}

TEST(Drive, InReverseTheFrontLooksBackAndTheRearBumperLeads) {
  Path path;
  std::string problem;
  ASSERT_TRUE(Path::Make({{{0.0, 0.0}, 10.0}, {{200.0, 0.0}, 10.0}}, path, problem));
  DriveSpec drive;
  drive.start_m = 20.0;
  drive.speed_mps = 3.0;
  drive.reverse = true;
  drive.stops = {{60.0, 1000.0}};
  const Trajectory backwards = Trajectory::Drive(path, drive, 4.5, 1.26, 40.0);
  EXPECT_NEAR(backwards.At(0.0).centre.x(), 20.0, 1e-6);
  const Motion middle = backwards.At(5.0);
  EXPECT_NEAR(middle.centre.x(), 35.0, 1e-6);
  EXPECT_NEAR(std::abs(WrapAngle(middle.yaw_rad)), kPi, 1e-9);
  EXPECT_NEAR(middle.speed_mps, -3.0, 1e-6);
  EXPECT_NEAR(backwards.At(39.0).centre.x() + 2.25, 60.0, 0.05);  // The rear bumper at the stop.
}

}  // namespace
}  // namespace v2vouch::sim
