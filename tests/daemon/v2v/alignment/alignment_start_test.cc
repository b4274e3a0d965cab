// SPDX-License-Identifier: Apache-2.0
// How an alignment begins: with every kind of receiver, in slow traffic, and with bad first fixes.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "daemon/v2v/alignment/alignment.h"
#include "tests/daemon/v2v/alignment/simulated_drive.h"

namespace v2vouch {
namespace {

const Wgs84 kTown{FromDegrees(50.938), FromDegrees(6.957), 0.0};

using Edit = std::function<void(GnssFix&, int)>;

void Leave(GnssFix&, int) {}
void PositionOnly(GnssFix& fix, int) { fix.velocity_en_mps.reset(); }

// Drives on with `speed_of(t)`, each fix edited; `index` counts the fixes.
class Journey {
 public:
  explicit Journey(const DriveErrors& errors, double yaw_rad = 0.7, double rate_hz = 10.0,
                   std::uint64_t seed = 11)
      : drive(kTown, yaw_rad, errors, seed), yaw_rad_(yaw_rad), period_s_(1.0 / rate_hz) {}

  void Go(double seconds, double speed_mps, const Edit& edit = Leave) {
    Go(
        seconds, [=](double) { return speed_mps; }, edit);
  }
  void Go(double seconds, const std::function<double(double)>& speed_of, const Edit& edit = Leave) {
    const double end_s = drive.time_s() + seconds - 1e-9;
    while (drive.time_s() < end_s) {
      drive.Advance(speed_of(drive.time_s()), 0.0, period_s_);
      GnssFix fix = drive.Fix(vehicle);
      edit(fix, index_++);
      refusal = alignment.OnFix(fix, drive.Ego());
    }
  }
  [[nodiscard]] double Error_m() const { return drive.ErrorOf(alignment).head<2>().norm(); }
  [[nodiscard]] double Error_deg() const {
    return std::abs(ToDegrees(drive.ErrorOf(alignment)(2)));
  }
  [[nodiscard]] Edit WithHeading() const {
    return [yaw = yaw_rad_](GnssFix& fix, int) {
      fix.velocity_en_mps.reset();
      fix.yaw_rad = yaw;
      fix.yaw_sigma_rad = 0.01;
    };
  }

  VehicleConfig vehicle;
  SimulatedDrive drive;
  Alignment alignment{AlignmentConfig{}, vehicle};
  std::optional<Refusal> refusal;

 private:
  double yaw_rad_;
  double period_s_;
  int index_ = 0;
};

DriveErrors Noisy() {
  DriveErrors errors;
  errors.white_sigma_m = 0.1;
  errors.markov_sigma_m = 0.3;
  errors.velocity_sigma_mps = 0.1;
  errors.speed_scale = 0.005;
  return errors;
}

void MoveNorth(GnssFix& fix, double metres) { fix.position.latitude_rad += metres / 6.371e6; }
void MoveEast(GnssFix& fix, double metres) {
  fix.position.longitude_rad += metres / 6.371e6 / std::cos(fix.position.latitude_rad);
}

// --- every receiver, in slow traffic

TEST(AlignmentStart, AnyReceiverStartsAtWalkingPace) {
  const Edit kinds[] = {Leave, PositionOnly};
  for (const Edit& kind : kinds) {
    Journey journey(Noisy());
    journey.Go(40.0, 1.4, kind);  // 56 m.
    ASSERT_TRUE(journey.alignment.is_ready());
    EXPECT_LT(journey.Error_m(), 1.5);
    EXPECT_LT(journey.Error_deg(), 8.0);
    EXPECT_FALSE(journey.alignment.is_suspect());
    journey.Go(60.0, 1.4, kind);
    EXPECT_LT(journey.Error_m(), 1.5);
    EXPECT_LT(journey.Error_deg(), 4.0);
  }
  Journey journey(Noisy());
  journey.Go(1.0, 1.4, journey.WithHeading());
  EXPECT_TRUE(journey.alignment.is_ready());
}

TEST(AlignmentStart, AnyReceiverStartsInStopAndGo) {
  const auto stop_and_go = [](double t) { return std::fmod(t, 12.0) < 5.0 ? 2.0 : 0.0; };
  const Edit kinds[] = {Leave, PositionOnly};
  for (const Edit& kind : kinds) {
    for (const double rate_hz : {1.0, 10.0}) {
      Journey journey(Noisy(), -2.4, rate_hz);
      journey.Go(80.0, stop_and_go, kind);
      ASSERT_TRUE(journey.alignment.is_ready()) << rate_hz;
      EXPECT_LT(journey.Error_m(), 1.5);
      EXPECT_LT(journey.Error_deg(), 8.0);
    }
  }
}

// A gyro offset turns O while the car stands; the way before and after is one way all the same.
TEST(AlignmentStart, WhatTheGyroTurnsAtStandstillIsTakenOut) {
  DriveErrors errors;
  errors.yaw_rate_bias_radps = FromDegrees(0.2);
  Journey journey(errors);
  journey.Go(4.0, 2.0, PositionOnly);
  journey.Go(60.0, 0.0, PositionOnly);  // 12 degrees.
  journey.Go(8.0, 2.0, PositionOnly);
  ASSERT_TRUE(journey.alignment.is_ready());
  EXPECT_LT(journey.Error_deg(), 2.5);
}

TEST(AlignmentStart, AReceiverThatLeavesItsVelocityAtZeroStartsFromPlaces) {
  Journey journey(Noisy());
  journey.Go(20.0, 8.0, [](GnssFix& fix, int) {
    fix.velocity_en_mps = Eigen::Vector2d::Zero();
    fix.velocity_sigma_mps = kNaN;
  });
  ASSERT_TRUE(journey.alignment.is_ready());
  EXPECT_LT(journey.Error_deg(), 3.0);
}

TEST(AlignmentStart, AWildFixAmongPositionsOnlyIsLeftOut) {
  Journey journey(Noisy());
  journey.Go(20.0, 8.0, [](GnssFix& fix, int i) {
    fix.velocity_en_mps.reset();
    if (i % 7 == 0) MoveNorth(fix, 900.0);
  });
  ASSERT_TRUE(journey.alignment.is_ready());
  EXPECT_LT(journey.Error_m(), 2.0);
  EXPECT_LT(journey.Error_deg(), 3.0);
}

TEST(AlignmentStart, AVagueHeadingGivesNoDirection) {
  Journey journey(Noisy());
  const Edit vague = [](GnssFix& fix, int) {
    fix.velocity_en_mps.reset();
    fix.yaw_rad = 3.0;
    fix.yaw_sigma_rad = 3.0;
  };
  journey.Go(3.0, 0.0, vague);
  EXPECT_FALSE(journey.alignment.is_ready());
  journey.Go(15.0, 8.0, vague);
  ASSERT_TRUE(journey.alignment.is_ready());
  EXPECT_LT(journey.Error_deg(), 4.0);
}

// The receiver gives its course for a heading, in reverse.
TEST(AlignmentStart, TheCourseByOdometryOverrulesAHeadingThatIsTheCourse) {
  Journey journey(Noisy(), 0.7);
  journey.Go(5.0, -4.0, [](GnssFix& fix, int) {
    fix.yaw_rad = WrapAngle(0.7 + kPi);
    fix.yaw_sigma_rad = 0.02;
  });
  ASSERT_TRUE(journey.alignment.is_ready());
  EXPECT_LT(journey.Error_deg(), 3.0);
}

// --- bad first fixes

TEST(AlignmentStart, BadFirstFixesAreOverruledWithinSeconds) {
  struct Bad {
    int fixes;
    double north_m;
    double east_m;
  };
  for (const Bad bad : {Bad{1, 1000.0, 0.0}, Bad{1, 100'000.0, 0.0}, Bad{1, 0.0, 1'000'000.0},
                        Bad{1, -5'660'000.0, 0.0}, Bad{20, 0.0, 500'000.0}, Bad{3, 30.0, 40.0}}) {
    for (const bool has_heading : {false, true}) {
      Journey journey(Noisy());
      const Edit heading = journey.WithHeading();
      const Edit edit = [&](GnssFix& fix, int i) {
        if (has_heading) heading(fix, i);
        if (i >= bad.fixes) return;
        MoveNorth(fix, bad.north_m);
        MoveEast(fix, bad.east_m);
      };
      journey.Go(bad.fixes * 0.1 + 4.0, 12.0, edit);
      ASSERT_TRUE(journey.alignment.is_ready()) << bad.north_m << " " << bad.east_m;
      EXPECT_LT(journey.Error_m(), 2.0) << bad.north_m << " " << bad.east_m << " " << has_heading;
      EXPECT_FALSE(journey.alignment.is_suspect());
      EXPECT_FALSE(journey.refusal);
    }
  }
}

TEST(AlignmentStart, ABadFirstFixOfAStandingCarIsOverruledToo) {
  Journey journey(Noisy());
  const Edit heading = journey.WithHeading();
  journey.Go(5.0, 0.0, [&](GnssFix& fix, int i) {
    heading(fix, i);
    if (i == 0) MoveNorth(fix, 1000.0);
  });
  EXPECT_LT(journey.Error_m(), 2.0);
  EXPECT_FALSE(journey.alignment.is_suspect());
}

TEST(AlignmentStart, AtOneHertzABadFirstFixIsOverruledWithinSeconds) {
  Journey journey(Noisy(), 0.7, 1.0);
  journey.Go(6.0, 12.0, [](GnssFix& fix, int i) {
    if (i == 0) MoveEast(fix, 1000.0);
  });
  EXPECT_LT(journey.Error_m(), 2.0);
  EXPECT_FALSE(journey.alignment.is_suspect());
}

// Zeros in between from the start: every third fix, the first included, lies a kilometre off.
TEST(AlignmentStart, BadFixesInBetweenDoNotKeepTheGoodOnesOut) {
  Journey journey(Noisy());
  journey.Go(12.0, 12.0, [](GnssFix& fix, int i) {
    if (i % 3 == 0) MoveNorth(fix, 1000.0);
  });
  EXPECT_LT(journey.Error_m(), 2.0);
}

TEST(AlignmentStart, AHeadingThatIsTurnedRoundAtTheStartIsOverruled) {
  Journey journey(Noisy());
  const Edit heading = journey.WithHeading();
  journey.Go(12.0, 12.0, [&](GnssFix& fix, int i) {
    heading(fix, i);
    if (i < 30) *fix.yaw_rad += kPi;
  });
  EXPECT_LT(journey.Error_m(), 2.0);
  EXPECT_LT(journey.Error_deg(), 3.0);
  EXPECT_FALSE(journey.alignment.is_suspect());
}

// Half a minute at standstill with a heading that was never measured (held from yesterday); driving
// off shows it.
TEST(AlignmentStart, AWrongHeadingHeldAtStandstillIsOverruledByDriving) {
  Journey journey(Noisy());
  const Edit held = [](GnssFix& fix, int) {
    fix.yaw_rad = -1.5;
    fix.yaw_sigma_rad = 0.02;
  };
  journey.Go(30.0, 0.0, held);
  journey.Go(6.0, 10.0);  // From now on with a velocity only.
  EXPECT_LT(journey.Error_deg(), 4.0);
  EXPECT_LT(journey.Error_m(), 3.0);
}

// --- what stays as it was

TEST(AlignmentStart, AnEstablishedPlaceIsNotOverruledBySeconds) {
  Journey journey(Noisy());
  journey.Go(20.0, 12.0);
  journey.Go(9.0, 12.0, [](GnssFix& fix, int) { MoveNorth(fix, 50.0); });
  EXPECT_LT(journey.Error_m(), 2.0);
  EXPECT_TRUE(journey.alignment.is_suspect());
  EXPECT_EQ(journey.refusal, Refusal(Reason::kGnssJump, "latitude_rad and longitude_rad"));
}

TEST(AlignmentStart, AStandingCarKeepsItsPlaceThroughAJumpFromTheStart) {
  Journey journey(Noisy());
  const Edit heading = journey.WithHeading();
  journey.Go(30.0, 0.0, heading);
  journey.Go(120.0, 0.0, [&](GnssFix& fix, int i) {
    heading(fix, i);
    MoveNorth(fix, 50.0);
  });
  EXPECT_LT(journey.Error_m(), 1.5);
  EXPECT_TRUE(journey.alignment.is_suspect());
}

TEST(AlignmentStart, AVouchedForPlaceIsNotOverruledHoweverYoung) {
  Journey journey(Noisy());
  journey.Go(4.0, 12.0);
  for (int i = 0; i < 8; ++i) {
    journey.alignment.Vouch(journey.drive.Now());
    journey.Go(1.0, 12.0, [](GnssFix& fix, int) { MoveNorth(fix, 50.0); });
  }
  EXPECT_LT(journey.Error_m(), 2.0);
}

TEST(AlignmentStart, AnUnknownHeightIsNotTaken) {
  Journey journey(Noisy());
  journey.Go(3.0, 12.0, [](GnssFix& fix, int i) {
    fix.position.height_m = 120.0;
    if (i % 2 == 1) {
      fix.has_height = false;
      fix.position.height_m = 0.0;
    }
  });
  EXPECT_NEAR(journey.alignment.EgoGeodetic(journey.drive.Ego()).height_m, 120.0, 1e-6);
}

}  // namespace
}  // namespace v2vouch
