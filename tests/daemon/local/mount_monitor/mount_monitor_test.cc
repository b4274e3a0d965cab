// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/mount_monitor/mount_monitor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "daemon/common/base/random.h"

namespace v2vouch {
namespace {

constexpr Timestamp kStart = FromMicros(1'700'000'000'000'000);
constexpr double kDegree = FromDegrees(1.0);

/// A drive through a world of standing things and traffic. Doppler comes from rigid motion alone:
/// of the antenna at (x, y) in B over ground, in B, (v - w y, w x).
struct Drive {
  double duration_s = 200.0;
  double speed_mps = 14.0;   ///< Varies by a third of it.
  double turn_radps = 0.15;  ///< Largest yaw rate.
  double odometer_scale = 1.005;
  double gyro_bias_radps = FromDegrees(0.05);
  int returns = 14;                                  ///< Per scan; a third of them moves.
  std::vector<double> turned_rad = {0.0, 0.0, 0.0};  ///< Each mount, against the configuration.
  std::uint64_t seed = 1;
  double from_s = 0.0;
};

RadarDetection Seen(const RadarConfig& radar, double turned_rad, double v, double w,
                    Random& random) {
  const double yaw = radar.yaw_rad + turned_rad;
  const double azimuth = random.Uniform(-radar.half_fov_rad, radar.half_fov_rad);
  const double bearing = azimuth + yaw;
  const double vx = v - w * radar.y_m;
  const double vy = w * radar.x_m;
  RadarDetection seen;
  seen.range_m = random.Uniform(5.0, 60.0);
  seen.azimuth_rad = azimuth + random.Normal(0.0, radar.azimuth_sigma_rad);
  seen.range_rate_mps = -(vx * std::cos(bearing) + vy * std::sin(bearing)) +
                        random.Normal(0.0, radar.range_rate_sigma_mps);
  if (random.Uniform() < 0.33) {  // Along the road either way, or across it.
    const double course = random.Uniform() < 0.8 ? 0.0 : kPi / 2.0;
    seen.range_rate_mps += random.Uniform(-16.0, 16.0) * std::cos(bearing - course);
  }
  return seen;
}

void Follow(const Drive& drive, MountMonitor& monitor) {
  const VehicleConfig vehicle;
  Random random(drive.seed);
  for (int i = 0; i < std::lround(100.0 * drive.duration_s); ++i) {
    const double t = 0.01 * i;
    const Timestamp stamp = kStart + FromSeconds(drive.from_s + t);
    const double v = drive.speed_mps * (1.0 + 0.33 * std::sin(0.11 * t));
    const double w = drive.turn_radps * std::sin(0.23 * t);
    if (i % 2 == 0) {
      EgoMotion motion;
      motion.stamp = stamp;
      motion.seq = i;
      motion.speed_mps = v * drive.odometer_scale + random.Normal(0.0, 0.05);
      motion.yaw_rate_radps = w + drive.gyro_bias_radps + random.Normal(0.0, 0.002);
      monitor.OnEgoMotion(motion);
    }
    if (i % 5 != 1) continue;
    for (int index = 0; index < 3; ++index) {
      RadarScan scan;
      scan.stamp = stamp;
      scan.seq = i;
      scan.radar = index;
      const auto k = static_cast<std::size_t>(index);
      for (int n = 0; n < drive.returns; ++n) {
        scan.detections.push_back(Seen(vehicle.radars[k], drive.turned_rad[k], v, w, random));
      }
      monitor.OnRadarScan(scan);
    }
  }
}

MountMonitor After(const Drive& drive) {
  MountMonitor monitor(MountMonitorConfig{}, VehicleConfig{});
  Follow(drive, monitor);
  return monitor;
}

TEST(MountMonitor, ATurnedRadarIsFoundInThreeWindowsWithSignAndSize) {
  for (std::size_t turned = 0; turned < 3; ++turned) {
    for (const double by : {0.5 * kDegree, -0.5 * kDegree, 3.0 * kDegree}) {
      Drive drive{.seed = 10 + turned};
      drive.turned_rad[turned] = by;
      const auto verdicts = After(drive).verdicts();
      for (std::size_t k = 0; k < 3; ++k) {
        const MountVerdict& verdict = verdicts[k];
        ASSERT_EQ(verdict.windows, 3);
        EXPECT_EQ(verdict.has_moved, k == turned) << k << " of " << turned;
        const double expected = k == turned ? by : 0.0;
        EXPECT_NEAR(verdict.yaw_correction_rad, expected, 0.06 * kDegree) << k << " of " << turned;
        EXPECT_NEAR(verdict.yaw_correction_rad, expected, 4.0 * verdict.yaw_sigma_rad);
        EXPECT_LT(verdict.yaw_sigma_rad, 0.05 * kDegree);
      }
    }
  }
}

TEST(MountMonitor, TwoWindowsAreNoAlarmYetAndACorrectedMountEndsIt) {
  Drive drive{.duration_s = 150.0};
  drive.turned_rad[0] = 0.5 * kDegree;
  MountMonitor monitor = After(drive);
  EXPECT_EQ(monitor.verdicts()[0].suspicious_run, 2);
  EXPECT_FALSE(monitor.verdicts()[0].has_moved);
  drive.from_s = 150.0;
  Follow(drive, monitor);
  EXPECT_TRUE(monitor.verdicts()[0].has_moved);
  drive.from_s = 300.0;
  drive.turned_rad[0] = 0.0;
  Follow(drive, monitor);
  EXPECT_FALSE(monitor.verdicts()[0].has_moved);
  EXPECT_EQ(monitor.verdicts()[0].suspicious_run, 0);
}

// Nor is the mean of many windows off, at whatever speed and odometer scale.
TEST(MountMonitor, NoRadarThatSitsRightRaisesAnAlarmInTwentyRuns) {
  std::array<double, 3> sum{};
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed + 100);
    const Drive drive{.speed_mps = random.Uniform(9.0, 25.0),
                      .odometer_scale = random.Uniform(0.98, 1.02),
                      .gyro_bias_radps = FromDegrees(random.Uniform(-0.1, 0.1)),
                      .seed = seed};
    const auto verdicts = After(drive).verdicts();
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_EQ(verdicts[k].windows, 3);
      EXPECT_EQ(verdicts[k].suspicious_run, 0) << "seed " << seed << ", radar " << k;
      sum[k] += verdicts[k].yaw_correction_rad / 20.0;
    }
  }
  for (const double mean : sum) EXPECT_LT(std::abs(mean), 0.015 * kDegree);
}

TEST(MountMonitor, StandingAndCrawlingGiveNoVerdict) {
  for (const double speed_mps : {0.0, 3.0}) {
    Drive drive{.speed_mps = speed_mps, .turn_radps = 0.0};
    drive.turned_rad[0] = 5.0 * kDegree;
    const MountMonitor monitor = After(drive);
    for (const MountVerdict& verdict : monitor.verdicts()) {
      EXPECT_EQ(verdict.windows, 0);
      EXPECT_EQ(verdict.driven_s, 0.0);
      EXPECT_FALSE(verdict.has_moved);
      EXPECT_TRUE(std::isnan(verdict.yaw_correction_rad));
    }
  }
}

TEST(MountMonitor, AnEmptyRoadGivesNoVerdict) {
  const MountMonitor monitor = After({.returns = 0});
  EXPECT_EQ(monitor.verdicts()[0].windows, 0);
}

TEST(MountMonitor, MessageTimeThatStartsAgainForgetsTheHalfWindowOnly) {
  Drive drive{.duration_s = 90.0};
  MountMonitor monitor = After(drive);
  const double correction_rad = monitor.verdicts()[0].yaw_correction_rad;
  EXPECT_GT(monitor.verdicts()[0].driven_s, 20.0);
  monitor.Restart();
  EXPECT_EQ(monitor.verdicts()[0].driven_s, 0.0);
  EXPECT_EQ(monitor.verdicts()[0].yaw_correction_rad, correction_rad);
  drive.duration_s = 50.0;
  Follow(drive, monitor);  // From the start of time again.
  EXPECT_EQ(monitor.verdicts()[0].windows, 1);
  EXPECT_NEAR(monitor.verdicts()[0].driven_s, 50.0, 0.2);
}

TEST(MountMonitor, DetectionsThatAreNoNumbersAreNoEvidence) {
  MountMonitor monitor(MountMonitorConfig{}, VehicleConfig{});
  Drive drive{.duration_s = 30.0};
  Follow(drive, monitor);
  RadarScan scan;
  scan.stamp = kStart + FromSeconds(30.0);
  scan.detections = {{10.0, kNaN, -10.0}, {10.0, 0.1, kNaN}, {kNaN, 0.1, -10.0}};
  monitor.OnRadarScan(scan);
  drive.from_s = 30.0;
  drive.duration_s = 40.0;
  Follow(drive, monitor);
  EXPECT_EQ(monitor.verdicts()[0].windows, 1);
  EXPECT_LT(std::abs(monitor.verdicts()[0].yaw_correction_rad), 0.1 * kDegree);
}

}  // namespace
}  // namespace v2vouch
