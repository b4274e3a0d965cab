// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/odometry/ego_reading.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>
#include <random>

#include "tests/daemon/local/odometry/standing_scene.h"

namespace v2vouch {
namespace {

using Scene = std::vector<Reflector>;

Scene operator+(Scene a, const Scene& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Scene Street() { return Posts(7.5) + Posts(-7.5) + Scene{{18.0, 5.0}, {24.0, -5.0}, {30.0, 5.0}}; }

// The car ahead with four returns.
Scene Ahead(double vx_mps) {
  return {{9.0, -0.5, vx_mps}, {9.0, 0.5, vx_mps}, {9.1, 0.0, vx_mps}, {9.6, 0.8, vx_mps}};
}

struct Truth {
  double speed_mps = 0.0;
  double told_mps = 0.0;
  Gear gear = Gear::kForward;
  double yaw_rate_radps = 0.0;
  std::optional<double> told_yaw_rate_radps{};
};

/// Plays a drive: 50 samples and 20 scans of each of three radars a second.
class Drive {
 public:
  /// @return share of the samples after `settle_s` whose speed is right to within 0.3 m/s and 2 %.
  double Play(double seconds, double settle_s, const std::function<Truth(double)>& truth,
              const std::function<Scene(double)>& scene) {
    int right = 0;
    int all = 0;
    const auto radars = ThreeRadars();
    const auto noise = [this] {
      return std::uniform_real_distribution<double>(-1.0, 1.0)(random_);
    };
    for (int tick = 0; tick < static_cast<int>(seconds * 100.0); ++tick) {
      const double t = 0.01 * tick;
      const Timestamp stamp = now_ + FromSeconds(t);
      const Truth now = truth(t);
      if (tick % 2 == 0) {
        EgoMotion sample;
        sample.stamp = stamp;
        sample.speed_mps = now.told_mps;
        sample.gear = now.gear;
        sample.yaw_rate_radps = now.told_yaw_rate_radps.value_or(now.yaw_rate_radps);
        last_ = reading.Read(sample);
        if (t >= settle_s) {
          ++all;
          right +=
              std::abs(last_.speed_mps - now.speed_mps) <= 0.3 + 0.02 * std::abs(now.speed_mps);
        }
      }
      if (tick % 5 == 1) {
        for (const RadarConfig& radar : radars) {
          RadarScan scan = Scan(radar, scene(t), now.speed_mps, now.yaw_rate_radps, noise);
          scan.stamp = stamp;
          reading.OnRadarScan(scan, radar);
        }
      }
    }
    now_ += FromSeconds(seconds);
    return static_cast<double>(right) / std::max(1, all);
  }

  EgoReading reading;
  [[nodiscard]] const EgoMotion& last() const { return last_; }

 private:
  std::mt19937_64 random_{7};
  Timestamp now_ = FromMicros(1'700'000'000'000'000);
  EgoMotion last_;
};

TEST(EgoReading, ASpeedOf0WhileTheStandingWorldComesNearerIsCorrected) {
  for (const double creep : {0.6, 0.9, 1.2, 2.0}) {
    for (const Gear gear : {Gear::kForward, Gear::kUnknown, Gear::kNeutral}) {
      Drive drive;
      const double right = drive.Play(
          6.0, 0.8,
          [&](double) {
            return Truth{creep, 0.0, gear};
          },
          [&](double) { return Street() + Ahead(creep) + Lane(3.5, -8.0); });
      EXPECT_GT(right, 0.97) << creep << " gear " << static_cast<int>(gear);
      EXPECT_EQ(drive.reading.speed().correction(), SpeedCorrection::kDeadband);
    }
  }
}

TEST(EgoReading, BackingOutBelowTheDeadbandIsCorrected) {
  for (const Gear gear : {Gear::kReverse, Gear::kUnknown}) {
    Drive drive;
    EXPECT_GT(drive.Play(
                  6.0, 2.2,
                  [&](double) {
                    return Truth{-1.0, 0.0, gear};
                  },
                  [](double) { return Street(); }),
              0.97);
  }
}

TEST(EgoReading, TheWheelSpeedIsBelievedAgainAsSoonAsItSpeaks) {
  Drive drive;
  const auto truth = [](double t) {  // Creeps, starts, stops again.
    const double v = t < 3.0   ? 0.9
                     : t < 6.0 ? 0.9 + 1.5 * (t - 3.0)
                               : std::max(0.0, 5.4 - 2.0 * (t - 6.0));
    return Truth{v, v < 1.2 ? 0.0 : v};
  };
  EXPECT_GT(drive.Play(11.0, 0.8, truth, [](double) { return Street(); }), 0.95);
  EXPECT_EQ(drive.reading.speed().correction(), SpeedCorrection::kNone);
  EXPECT_EQ(drive.last().speed_mps, 0.0);
}

// Everything around moves at one speed; the ego stands, and must go on standing.
TEST(EgoReading, ATrafficJamThatMovesAroundAStandingEgoIsNotTheEgosMotion) {
  const std::vector<std::pair<const char*, Scene>> scenes{
      {"both lanes beside it move off", Lane(3.5, 2.0) + Lane(-3.5, 2.0)},
      {"and the one ahead too", Lane(3.5, 2.0) + Lane(-3.5, 2.0) + Lane(0.0, 2.0, 12.0)},
      {"oncoming jam on the left", Lane(3.5, -2.0) + Lane(7.0, -2.0)},
      {"oncoming on the left, queue ahead", Lane(3.5, -2.0) + Ahead(0.0)},
      {"both ways", Lane(3.5, -2.0) + Lane(-3.5, 2.0)},
      {"with posts", Lane(3.5, -2.0) + Lane(-3.5, -2.0) + Posts(9.0) + Posts(-9.0)},
      {"fast on both sides", Lane(3.5, 15.0) + Lane(-3.5, 15.0)},
  };
  for (const auto& [name, scene] : scenes) {
    for (const Gear gear : {Gear::kForward, Gear::kPark}) {
      Drive drive;
      EXPECT_EQ(drive.Play(
                    20.0, 0.0,
                    [&](double) {
                      return Truth{0.0, 0.0, gear};
                    },
                    [&scene = scene](double) { return scene; }),
                1.0)
          << name;
      EXPECT_EQ(drive.reading.speed().correction(), SpeedCorrection::kNone) << name;
      EXPECT_FALSE(drive.reading.speed().is_suspect()) << name;
    }
  }
}

// A roundabout or a junction: what comes towards a standing ego on both sides of its axis looks
// like a world that it drives into, but has that speed from the first moment on.
TEST(EgoReading, WhatComesTowardsACarThatHasStoppedIsNotItsMotion) {
  for (const double speed : {4.0, 7.0, 11.0}) {
    for (const double every_m : {9.0, 20.0, 40.0}) {
      for (const Gear gear : {Gear::kForward, Gear::kNeutral, Gear::kUnknown}) {
        Drive drive;
        const auto stops = [&](double t) {
          const double v = std::max(0.0, 7.0 - 2.5 * t);
          return Truth{v, v, gear};
        };
        drive.Play(4.0, 0.0, stops, [](double) { return Scene{}; });
        const Scene oncoming = Lane(5.0, -speed, every_m) + Lane(-5.0, -speed, every_m);
        EXPECT_EQ(drive.Play(
                      20.0, 0.0,
                      [&](double) {
                        return Truth{0.0, 0.0, gear};
                      },
                      [&](double) { return oncoming; }),
                  1.0)
            << speed << " m/s, every " << every_m << " m, gear " << static_cast<int>(gear);
        EXPECT_EQ(drive.reading.speed().correction(), SpeedCorrection::kNone);
      }
    }
  }
}

TEST(EgoReading, ASensorThatFailsOnTheRoadOrNeverSpokeIsReplaced) {
  for (const double speed : {5.0, 9.0, 14.0, 30.0}) {
    Drive never;
    EXPECT_GT(never.Play(
                  6.0, 2.0,
                  [&](double) {
                    return Truth{speed, 0.0};
                  },
                  [](double) { return Street(); }),
              0.95)
        << speed;
    Drive fails;
    EXPECT_GT(fails.Play(
                  8.0, 4.5,
                  [&](double t) {
                    return Truth{speed, t < 2.0 ? speed : 0.0};
                  },
                  [](double) { return Street(); }),
              0.95)
        << speed;
  }
}

TEST(EgoReading, TrafficAtOneSpeedAroundARollingEgoDoesNotOutvoteItsWheels) {
  for (const double traffic : {-15.0, 5.0, 12.0, 14.0, 16.0, 18.0, 28.0}) {
    Drive drive;
    const auto scene = [&](double) {
      return Lane(3.5, traffic) + Lane(-3.5, traffic) + Posts(10.0, 20.0);
    };
    EXPECT_EQ(drive.Play(
                  20.0, 0.0,
                  [](double) {
                    return Truth{14.0, 14.0};
                  },
                  scene),
              1.0)
        << traffic;
  }
}

TEST(EgoReading, TrafficThatDrivesAlongWhereNothingStandsIsNoReasonForSuspicion) {
  Drive drive;
  const auto truth = [](double t) {
    const double v = 25.0 + 5.0 * std::sin(0.3 * t);
    return Truth{v, v, Gear::kUnknown};
  };
  const auto scene = [&](double t) {
    const double v = truth(t).speed_mps;
    return Lane(3.5, v + 1.0) + Lane(-3.5, v - 2.0) + Ahead(v);
  };
  EXPECT_EQ(drive.Play(30.0, 0.0, truth, scene), 1.0);
  EXPECT_FALSE(drive.reading.speed().is_suspect());
}

TEST(EgoReading, PositiveSpeedInReverseGearIsBackwards) {
  Drive drive;
  EXPECT_EQ(drive.Play(
                5.0, 0.0,
                [](double) {
                  return Truth{-3.0, 3.0, Gear::kReverse};
                },
                [](double) { return Street(); }),
            1.0);
  EXPECT_EQ(drive.reading.speed().correction(), SpeedCorrection::kSign);
  EXPECT_TRUE(drive.reading.speed().gear_contradicts());
}

TEST(EgoReading, DopplerOverrulesAGearThatIsWrong) {
  Drive stuck;  // Reverse is told, the car drives forward.
  EXPECT_GT(stuck.Play(
                5.0, 0.5,
                [](double) {
                  return Truth{3.0, 3.0, Gear::kReverse};
                },
                [](double) { return Street(); }),
            0.99);
  Drive turned;  // Forward gear and speed, but the sensor counts backwards.
  EXPECT_GT(turned.Play(
                5.0, 0.5,
                [](double) {
                  return Truth{3.0, -3.0, Gear::kForward};
                },
                [](double) { return Street(); }),
            0.99);
  Drive rolls;  // Rolls back on a hill: signs are right as they are.
  EXPECT_EQ(rolls.Play(
                5.0, 0.0,
                [](double) {
                  return Truth{-1.0, -1.0, Gear::kForward};
                },
                [](double) { return Street(); }),
            1.0);
}

TEST(EgoReading, AnUnsignedSpeedWithoutGearIsSettledByDoppler) {
  for (const double speed : {-1.0, -3.0, -5.0}) {
    Drive drive;
    const auto truth = [&](double t) {  // Backs out, stops, drives off.
      const double v = t < 5.0 ? speed : t < 6.0 ? 0.0 : 2.0 * (t - 6.0);
      return Truth{v, std::abs(v), Gear::kUnknown};
    };
    EXPECT_GT(drive.Play(12.0, 0.8, truth, [](double) { return Street(); }), 0.97) << speed;
    EXPECT_EQ(drive.reading.speed().correction(), SpeedCorrection::kNone);
  }
}

TEST(EgoReading, AStreetBuiltOnOneSideIsEnoughForTheSign) {
  Drive drive;
  EXPECT_GT(drive.Play(
                6.0, 1.5,
                [](double) {
                  return Truth{-3.5, 3.5, Gear::kUnknown};
                },
                [](double) { return Posts(-6.5, 10.0); }),
            0.99);
}

TEST(EgoReading, AWrongUnitIsFoundWhileTheSpeedChanges) {
  for (const double factor : {3.6, 1.0 / 3.6, 2.23694, 0.44704}) {
    Drive drive;
    const auto truth = [&](double t) {
      const double v = std::min(15.0, 2.0 * t);
      return Truth{v, factor * v};
    };
    EXPECT_GT(drive.Play(15.0, 5.0, truth, [](double) { return Street(); }), 0.98) << factor;
    EXPECT_EQ(drive.reading.speed().correction(), SpeedCorrection::kScale);
    EXPECT_NEAR(drive.reading.speed().factor() * factor, 1.0, 0.02);
  }
}

TEST(EgoReading, AWrongTyreSizeIsLearntAndARightOneLeftAlone) {
  for (const double factor : {0.9, 0.95, 0.97, 1.03, 1.05, 1.1}) {
    Drive drive;
    const auto truth = [&](double) { return Truth{15.0, factor * 15.0}; };
    EXPECT_GT(drive.Play(20.0, 10.0, truth, [](double) { return Street(); }), 0.99) << factor;
    EXPECT_NEAR(drive.reading.speed().factor() * factor, 1.0, 0.01);
  }
  for (const double factor : {0.99, 1.0, 1.01}) {
    Drive drive;
    const auto truth = [&](double) { return Truth{15.0, factor * 15.0}; };
    drive.Play(30.0, 0.0, truth, [](double) { return Street(); });
    EXPECT_EQ(drive.last().speed_mps, factor * 15.0);
  }
}

TEST(EgoReading, AFrozenSpeedIsReplacedAndAStrangeOneFlagged) {
  Drive frozen;
  const auto slows = [](double t) {
    return Truth{t < 5.0 ? 12.0 : std::max(3.0, 12.0 - 2.0 * (t - 5.0)), 12.0};
  };
  frozen.Play(12.0, 0.0, slows, [](double) { return Street(); });
  EXPECT_EQ(frozen.reading.speed().correction(), SpeedCorrection::kFrozen);
  EXPECT_NEAR(frozen.last().speed_mps, 3.0, 0.3);
  Drive strange;
  strange.Play(
      5.0, 0.0,
      [](double t) {
        return Truth{8.0, 13.0 + std::sin(t)};
      },
      [](double) { return Street(); });
  EXPECT_TRUE(strange.reading.speed().is_suspect());
  EXPECT_EQ(strange.reading.speed().correction(), SpeedCorrection::kNone);
}

TEST(EgoReading, AStandingCarDoesNotTurnAndACreepingOneDoes) {
  Drive stands;
  stands.Play(
      10.0, 0.0,
      [](double) {
        return Truth{0.0, 0.0, Gear::kForward, FromDegrees(0.5)};
      },
      [](double) { return Ahead(0.0); });
  EXPECT_EQ(stands.last().yaw_rate_radps, 0.0);
  Drive creeps;
  creeps.Play(
      5.0, 0.0,
      [](double) {
        return Truth{1.0, 0.0, Gear::kForward, FromDegrees(2.0)};
      },
      [](double) { return Street(); });
  EXPECT_NEAR(creeps.last().yaw_rate_radps, FromDegrees(2.0), FromDegrees(0.6));
}

TEST(EgoReading, AFrozenYawRateIsFlaggedAndARightOneIsNot) {
  for (const double turn : {-0.3, -0.12, 0.12, 0.3}) {
    Drive frozen;
    frozen.Play(
        5.0, 0.0,
        [&](double) {
          return Truth{8.0, 8.0, Gear::kForward, turn, 0.0};
        },
        [](double) { return Street() + Lane(3.5, -8.0); });
    EXPECT_TRUE(frozen.reading.yaw().is_suspect()) << turn;
    EXPECT_NEAR(frozen.reading.yaw().missing_radps(), turn, 0.04);
    Drive right;
    right.Play(
        5.0, 0.0,
        [&](double) {
          return Truth{8.0, 8.03, Gear::kForward, turn};
        },
        [](double) { return Street() + Lane(3.5, -8.0) + Lane(-3.5, 9.0); });
    EXPECT_FALSE(right.reading.yaw().is_suspect()) << turn;
  }
}

TEST(EgoReading, ACopyGoesOnToTheSameBits) {
  Drive drive;
  const auto truth = [](double t) { return Truth{0.9, t < 2.0 ? 0.0 : 0.9}; };
  drive.Play(1.0, 0.0, truth, [](double) { return Street(); });
  Drive other = drive;
  drive.Play(3.0, 0.0, truth, [](double) { return Street(); });
  other.Play(3.0, 0.0, truth, [](double) { return Street(); });
  EXPECT_EQ(drive.last().speed_mps, other.last().speed_mps);
  EXPECT_EQ(drive.reading.speed().doppler_speed_mps(), other.reading.speed().doppler_speed_mps());
}

}  // namespace
}  // namespace v2vouch
