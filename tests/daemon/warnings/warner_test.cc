// SPDX-License-Identifier: Apache-2.0
#include "daemon/warnings/warner.h"

#include <gtest/gtest.h>

#include "tests/daemon/warnings/scenes.h"

namespace v2vouch::warnings {
namespace {

// A drive in which a list comes every 50 ms. The ego does not move in O: targets tell.
class Drive {
 public:
  WarningList Step(std::vector<Target> local, std::vector<Target> priority = {}) {
    now_ += FromSeconds(0.05);
    EgoReading ego = Driving(15.0);
    ego.stamp = now_;
    warner.OnEgo(ego);
    for (Target& target : local) target.last_own = now_;
    TargetList list;
    list.stamp = now_;
    list.sectors = sectors;
    list.targets = std::move(local);
    EXPECT_FALSE(warner.OnLocal(list));
    list.targets = std::move(priority);
    return *warner.OnPriority(list);
  }
  Timestamp now() const { return now_; }
  Warner warner{WarningsConfig{}, EgoBody{}};
  std::vector<SectorHealth> sectors = AllRound();

 private:
  Timestamp now_ = kStart;
};

const Target kNear = Car(1, 23.0, 0, 0, 0);  // URGENT at 15 m/s
const Target kFar = Car(1, 75.0, 0, 0, 0);   // ADVISE

TEST(Warner, OneListIsNotEnoughAndTwoAre) {
  Drive drive;
  drive.Step({});
  EXPECT_TRUE(drive.Step({kNear}).warnings.empty());
  const WarningList second = drive.Step({kNear});
  ASSERT_EQ(second.warnings.size(), 1u);
  EXPECT_EQ(second.warnings[0].level, Level::kUrgent);
  EXPECT_EQ(second.warnings[0].since, second.stamp);
}

TEST(Warner, FlickeringConditionGivesOneWarningWithoutFlapping) {
  Drive drive;
  drive.Step({});
  int changes = 0;
  std::size_t before = 0;
  for (int i = 0; i < 80; ++i) {
    const std::size_t now =
        drive.Step(i % 5 < 3 ? std::vector{kNear} : std::vector<Target>{}).warnings.size();
    changes += now != before;
    before = now;
  }
  EXPECT_EQ(changes, 1);
}

TEST(Warner, LevelFallsOnlyAfterTheHoldAndThroughWhatIsStillTrue) {
  Drive drive;
  drive.Step({});
  drive.Step({kNear});
  drive.Step({kNear});
  std::vector<Level> levels;
  for (int i = 0; i < 40; ++i) levels.push_back(drive.Step({kFar}).warnings.at(0).level);
  EXPECT_EQ(levels[10], Level::kUrgent);  // 0.55 s: shortest time of one second.
  EXPECT_EQ(levels[30], Level::kAdvise);
  EXPECT_EQ(drive.Step({kFar}).warnings[0].basis, Basis::kProbability);
}

TEST(Warner, WarningEndsWhenItsVehicleIsGone) {
  Drive drive;
  drive.Step({});
  for (int i = 0; i < 3; ++i) drive.Step({kNear});
  std::size_t left = 1;
  int steps = 0;
  for (; left > 0 && steps < 100; ++steps) left = drive.Step({}).warnings.size();
  EXPECT_GE(steps, 15);
  EXPECT_LE(steps, 25);  // One second, no more.
}

TEST(Warner, HiddenVehicleKeepsItsWarningThenIsLost) {
  Drive drive;
  drive.Step({});
  Target seen = Car(1, 40.0, 0, 0, 0);
  Timestamp since{};
  for (int i = 0; i < 4; ++i) {
    const auto list = drive.Step({seen}, {Vouched(seen, 70, Visibility::kVisible)});
    if (!list.warnings.empty()) since = list.warnings[0].since;
  }
  // LOCAL loses it, PRIORITY goes on: the same warning.
  Target hidden = Vouched(seen, 70, Visibility::kHidden);
  for (int i = 0; i < 40; ++i) {
    hidden.last_own = kStart;
    const auto list = drive.Step({}, {hidden});
    ASSERT_EQ(list.warnings.size(), 1u);
    EXPECT_EQ(list.warnings[0].since, since);
    EXPECT_EQ(list.warnings[0].level, Level::kWarn);
  }
  // The bridge ends.
  const auto lost = drive.Step({}, {});
  ASSERT_EQ(lost.warnings.size(), 1u);
  EXPECT_EQ(lost.warnings[0].level, Level::kLost);
  EXPECT_EQ(lost.warnings[0].basis, Basis::kEnded);
  for (int i = 0; i < 38; ++i) ASSERT_EQ(drive.Step({}, {}).warnings.size(), 1u) << i;
  for (int i = 0; i < 3; ++i) drive.Step({}, {});
  EXPECT_TRUE(drive.Step({}, {}).warnings.empty());
}

TEST(Warner, VehicleThatTheListsJoinHasOneWarningWhereItIs) {
  Drive drive;
  drive.Step({});
  Target own = Car(1, 40.0, 0, 0, 0);
  Target theirs = own;
  theirs.track_id = 9;
  theirs.last_own = drive.now();
  for (int i = 0; i < 5; ++i) {
    own.state_O.mean[kX] -= 0.75;
    theirs.state_O.mean[kX] -= 0.75;
    theirs.local_id = 0;  // PRIORITY does not know yet that LOCAL sees it again.
    EXPECT_LE(drive.Step({own}, {theirs}).warnings.size(), 2u);
  }
  theirs.local_id = own.local_id;
  for (int i = 0; i < 10; ++i) {
    own.state_O.mean[kX] -= 0.75;
    theirs.state_O.mean[kX] -= 0.75;
    const WarningList list = drive.Step({own}, {theirs});
    ASSERT_EQ(list.warnings.size(), 1u) << i;
    EXPECT_EQ(list.warnings[0].source, Source::kBoth);
    EXPECT_NEAR(list.warnings[0].figures.position_B.x(), own.state_O.mean[kX], 1e-9);
  }
}

TEST(Warner, HeldWarningGoesWithItsVehicle) {
  Drive drive;
  drive.Step({});
  for (int i = 0; i < 3; ++i) drive.Step({kNear});
  const WarningList held = drive.Step({Car(1, 20.0, -8.0, 0, 0)});  // Beside the path by now.
  ASSERT_EQ(held.warnings.size(), 1u);
  EXPECT_EQ(held.warnings[0].basis, Basis::kHeld);
  EXPECT_NEAR(held.warnings[0].figures.position_B.y(), -8.0, 1e-9);
}

TEST(Warner, UrgentStaysWhenExistenceFalls) {
  Drive drive;
  drive.Step({});
  for (int i = 0; i < 3; ++i) drive.Step({kNear});
  Target doubtful = kNear;
  doubtful.existence = 0.3;
  for (int i = 0; i < 60; ++i) {
    EXPECT_EQ(drive.Step({doubtful}).warnings.at(0).level, Level::kUrgent) << i;
  }
}

TEST(Warner, StaleListsMakeEverythingUnavailable) {
  Drive drive;
  drive.Step({});
  for (int i = 0; i < 3; ++i) drive.Step({kNear});
  WarningList list;
  for (int i = 1; i <= 10; ++i) {  // Predicted copies, as the daemon makes them.
    TargetList copy;
    copy.stamp = drive.now() + FromSeconds(0.1 * i);
    copy.is_stale = true;
    copy.sectors = AllRound();
    copy.targets = {kNear};
    EgoReading ego = Driving(15.0);
    ego.stamp = copy.stamp;
    drive.warner.OnEgo(ego);
    drive.warner.OnLocal(copy);
    copy.targets = {};
    list = *drive.warner.OnPriority(copy);
    EXPECT_EQ(list.available_kinds != 0, i <= 3) << i;
  }
  EXPECT_TRUE((list.degraded & kListsStale) != 0);
  EXPECT_TRUE(drive.warner.Silence().available_kinds == 0);
}

TEST(Warner, UnwatchedSectorsMakeTheirKindsUnavailable) {
  Drive drive;
  drive.sectors = {{-1.0, 1.0, 100.0, SectorState::kWatched}};
  const WarningList front = drive.Step({});
  EXPECT_TRUE((front.available_kinds & Bit(Kind::kFcw)) != 0);
  EXPECT_TRUE((front.available_kinds & Bit(Kind::kBsw)) == 0);
  EXPECT_TRUE((front.degraded & kSectorsMissing) != 0);
  drive.sectors = AllRound();
  EXPECT_EQ(drive.Step({}).available_kinds, kAllKinds);
  drive.sectors = {};
  EXPECT_EQ(drive.Step({}).available_kinds, 0);
}

TEST(Warner, TrackThatJumpsFromStandingToFastIsOnlyAdvisedOf) {
  // A parked car's track slips to something else; a car that is new may have any speed.
  for (const bool stood : {true, false}) {
    Drive drive;
    for (int i = 0; i < 20; ++i) {
      drive.Step(stood ? std::vector{Car(1, 7.0, -3.5, 0.0, 0.0)} : std::vector<Target>{});
    }
    Level worst = Level::kInfo;
    for (int i = 0; i < 6; ++i) {
      for (const Warning& each : drive.Step({Car(1, 8.0, -2.9, 0.9, 7.0)}).warnings) {
        worst = std::max(worst, each.level);
      }
    }
    EXPECT_EQ(worst, stood ? Level::kAdvise : Level::kUrgent) << stood;
  }
}

TEST(Warner, WithoutPriorityLocalGoesOnAndSaysSo) {
  Warner warner{WarningsConfig{}, EgoBody{}};
  WarningList last;
  for (int i = 0; i < 12; ++i) {
    TargetList list;
    list.stamp = kStart + FromSeconds(0.05 * i);
    list.sectors = AllRound();
    list.targets = {kNear};
    EgoReading ego = Driving(15.0);
    ego.stamp = list.stamp;
    warner.OnEgo(ego);
    const auto made = warner.OnLocal(list);
    EXPECT_EQ(made.has_value(), i > 6) << i;  // PRIORITY might still come: 0.3 s.
    if (made) last = *made;
  }
  EXPECT_TRUE((last.degraded & kNoPriority) != 0);
  ASSERT_EQ(last.warnings.size(), 1u);
  EXPECT_EQ(last.warnings[0].source, Source::kLocal);
}

TEST(Warner, WithoutEgoMotionNothingIsAvailable) {
  Warner warner{WarningsConfig{}, EgoBody{}};
  TargetList list;
  list.stamp = kStart;
  list.sectors = AllRound();
  warner.OnLocal(list);
  const auto made = warner.OnPriority(list);
  EXPECT_EQ(made->available_kinds, 0);
  EXPECT_TRUE((made->degraded & kNoEgo) != 0);
}

TEST(Warner, TimeThatStepsBackStartsAnew) {
  Drive drive;
  drive.Step({});
  for (int i = 0; i < 3; ++i) drive.Step({kNear});
  TargetList earlier;
  earlier.stamp = kStart - FromSeconds(3600);
  earlier.sectors = AllRound();
  EgoReading ego = Driving(15.0);
  ego.stamp = earlier.stamp;
  drive.warner.OnEgo(ego);
  drive.warner.OnLocal(earlier);
  const auto list = drive.warner.OnPriority(earlier);
  EXPECT_TRUE(list->warnings.empty());
  EXPECT_EQ(list->available_kinds, kAllKinds);
}

TEST(Warner, TheSameMessagesGiveTheSameWarnings) {
  const auto run = [] {
    Drive drive;
    std::vector<double> figures;
    for (int i = 0; i < 30; ++i) {
      const Target car = Car(1, 60.0 - i, 0.3, 0.02, 1.0);
      for (const Warning& each : drive.Step({car}).warnings) {
        figures.push_back(each.figures.conflict_probability);
        figures.push_back(each.figures.time_to_conflict_s);
      }
    }
    return figures;
  };
  EXPECT_EQ(run(), run());
}

// A gyro's noise, sample by sample, bends the path ahead to and fro; its mean does not.
TEST(Warner, NoiseOfTheYawRateKeepsNoWarningBackOnAFastStraightRoad) {
  const auto first_warn_s = [](double noise_radps) {
    Warner warner({}, {});
    Timestamp t = kStart;
    for (int k = 0; k < 400; ++k) {  // 36 m/s towards a car at 19.4 m/s, 130 m ahead.
      t += Duration(20'000);
      EgoReading ego = Driving(36.0, k % 2 == 0 ? noise_radps : -noise_radps);
      ego.stamp = t;
      ego.yaw_rate_sigma_radps = 0.005;
      warner.OnEgo(ego);
      Target target = Car(1, 130.0 - 0.332 * k, 0.0, 0.0, 19.4);
      target.last_own = t;
      TargetList list;
      list.stamp = t;
      list.sectors = AllRound();
      list.targets = {target};
      warner.OnLocal(list);
      const auto out = warner.OnPriority(list);
      for (const Warning& warning : out->warnings) {
        if (warning.level >= Level::kWarn) return 0.02 * k;
      }
    }
    return 99.0;
  };
  // Gap 124 m at the start, WARN before 1.2 + 16.6 / 8 + margin 0.5 = 3.8 s: after 3.7 s.
  EXPECT_NEAR(first_warn_s(0.005), 3.7, 0.3);
  EXPECT_NEAR(first_warn_s(0.0), 3.7, 0.3);
}

TEST(Warner, ATurnIsFollowedAtOnce) {
  Warner warner({}, {});
  Timestamp t = kStart;
  Target target = Car(1, 20.0, 0.0, 0.0, 0.0);
  std::size_t last = 0;
  for (int k = 0; k < 100; ++k) {
    t += Duration(20'000);
    EgoReading ego = Driving(9.0, k < 20 ? 0.0 : 0.6);  // Away from the car ahead.
    ego.stamp = t;
    warner.OnEgo(ego);
    TargetList list;
    list.stamp = t;
    list.sectors = AllRound();
    target.last_own = t;
    list.targets = {target};
    warner.OnLocal(list);
    last = warner.OnPriority(list)->warnings.size();
    if (k == 19) {
      EXPECT_EQ(last, 1u);
    }
  }
  EXPECT_EQ(last, 0u);
}

}  // namespace
}  // namespace v2vouch::warnings
