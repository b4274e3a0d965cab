// SPDX-License-Identifier: Apache-2.0
#include "daemon/warnings/assess.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <chrono>
#include <cmath>

#include "daemon/warnings/merge_lists.h"
#include "daemon/warnings/placement.h"
#include "tests/daemon/warnings/scenes.h"

namespace v2vouch::warnings {
namespace {

std::optional<Warning> Only(const Scene& scene) {
  const auto found = Assess(scene, {}, {});
  EXPECT_LE(found.size(), 1u);
  if (found.empty()) return std::nullopt;
  return found.front().warning;
}

TEST(Assess, StandingCarAheadRisesFromAdviseToUrgent) {
  // 15 m/s; bumper 3.75 m, rear at x - 2 m. WARN before 15/4.4 = 3.41 s, URGENT 1.44 s.
  EXPECT_EQ(Only(SceneOf(Driving(15.0), {Car(1, 75.0, 0, 0, 0)}))->level, Level::kAdvise);
  EXPECT_EQ(Only(SceneOf(Driving(15.0), {Car(1, 48.0, 0, 0, 0)}))->level, Level::kWarn);
  const auto urgent = Only(SceneOf(Driving(15.0), {Car(1, 23.0, 0, 0, 0)}));
  EXPECT_EQ(urgent->level, Level::kUrgent);
  EXPECT_EQ(urgent->kind, Kind::kFcw);
  EXPECT_NEAR(urgent->figures.required_decel_mps2, 225.0 / 2 / 17.25, 0.1);
  EXPECT_GT(urgent->figures.conflict_probability, 0.9);
  EXPECT_NEAR(urgent->figures.own_sensor_age_s, 0.0, 1e-9);
}

TEST(Assess, StandingCarIsWarnedOfWithAMarginOnlyWhereUsualBrakingWouldHaveBegun) {
  // 20 m/s: needed 1.2 + 20/8 = 3.7 s, usual braking from 20/4.4 = 4.5 s on: margin 0.5 s.
  EXPECT_NEAR(Only(SceneOf(Driving(20.0), {Car(1, 90.0, 0, 0, 0)}))->figures.warn_before_s, 4.2,
              1e-9);
  // 14 m/s: needed 2.95 s, usual 3.18 s.
  EXPECT_NEAR(Only(SceneOf(Driving(14.0), {Car(1, 50.0, 0, 0, 0)}))->figures.warn_before_s,
              14.0 / 4.4, 1e-9);
  // 8 m/s: needed 2.2 s; usual braking begins after that: none.
  EXPECT_NEAR(Only(SceneOf(Driving(8.0), {Car(1, 24.0, 0, 0, 0)}))->figures.warn_before_s, 2.2,
              1e-9);
}

TEST(Assess, EgoThatBrakesEnoughIsNotWarned) {
  EXPECT_FALSE(Only(SceneOf(Driving(15.0, 0.0, -5.0), {Car(1, 48.0, 0, 0, 0)})));
}

TEST(Assess, LeadThatBrakesWarnsBeforeTheClosingSpeedTells) {
  Target lead = Car(1, 24.0, 0, 0, 15.0);
  EXPECT_FALSE(Only(SceneOf(Driving(15.0), {lead})));
  lead.state_O.mean[kAccel] = -6.0;
  const auto found = Assess(SceneOf(Driving(15.0), {lead}), {}, {});
  ASSERT_EQ(found.size(), 2u);  // FCW and EEBL.
  EXPECT_EQ(found[0].warning.kind, Kind::kFcw);
  EXPECT_EQ(found[1].warning.kind, Kind::kEebl);
  EXPECT_EQ(found[1].warning.level, Level::kWarn);
}

// At exactly 4 m/s2 no estimate is ever sure of more than 3.9.
TEST(Assess, ClaimOfHardBrakingCountsWhereOwnSensorsSeeItBrake) {
  const auto level = [](double accel_mps2, bool is_claimed, bool is_seen) {
    Target lead = Car(1, 30.0, 0, 0, 15.0);
    lead.track_id = 2;
    lead.state_O.mean[kAccel] = accel_mps2;
    lead.state_O.covariance(kAccel, kAccel) = 0.5 * 0.5;
    lead.says_hard_braking = is_claimed;
    if (!is_seen) lead.last_own = kStart - FromSeconds(1.0);
    for (const Assessment& each : Assess(SceneOf(Driving(15.0), {lead}), {}, {})) {
      if (each.warning.kind == Kind::kEebl) return each.warning.level;
    }
    return Level::kInfo;
  };
  EXPECT_EQ(level(-4.0, false, true), Level::kInfo);
  EXPECT_EQ(level(-4.0, true, true), Level::kWarn);
  EXPECT_EQ(level(-2.2, true, true), Level::kWarn);
  EXPECT_EQ(level(-1.5, true, true), Level::kInfo);  // Might as well only coast.
  EXPECT_EQ(level(0.0, true, true), Level::kInfo);   // Feigned.
  EXPECT_EQ(level(-4.0, true, false), Level::kAdvise);
}

TEST(Assess, LeadThatBrakesHardIsUrgentWhileAPlannerCanStillStopBehindIt) {
  const auto urgent = [](double gap_m, double lead_mps) {
    Target lead = Car(1, gap_m + 3.75 + 2.0, 0, 0, lead_mps);
    lead.state_O.mean[kAccel] = -5.0;
    const auto found = Assess(SceneOf(Driving(20.0), {lead}), {}, {});
    return !found.empty() && found[0].warning.level == Level::kUrgent;
  };
  // 20 m/s: 10 m in 0.5 s of reaction and margin, 25 m of braking; the lead's way is 19.6 m.
  EXPECT_FALSE(urgent(19.0, 14.0));
  EXPECT_TRUE(urgent(14.0, 14.0));
}

TEST(Assess, StandingCarInTheOuterLaneOfABendIsNotInThePath) {
  // Left bend of 100 m: straight ahead at 40 m lies what the bend leaves 8 m to the right of.
  const double speed = 12.0;
  EXPECT_FALSE(Only(SceneOf(Driving(speed, speed / 100.0), {Car(1, 40.0, 4.7, 0.4, 0)})));
  EXPECT_TRUE(Only(SceneOf(Driving(speed, speed / 100.0), {Car(1, 38.9, 7.9, 0.4, 0)})));
}

TEST(Assess, ParkedRowQueueAndParallelRoadSayNothing) {
  for (const double y : {2.9, -2.9, 3.5, -3.5, 8.0}) {
    EXPECT_FALSE(Only(SceneOf(Driving(14.0), {Car(1, 30.0, y, 0, 0)}))) << y;
    EXPECT_FALSE(Only(SceneOf(Driving(14.0), {Car(1, 30.0, y, 0, 5.0)}))) << y;
  }
}

// A car of a parked row whose axis is not known yet: a place 0.1 m beside the ego's flank, and it
// might stand across as well.
TEST(Assess, BodyOfUnknownAxisIsUrgentOnlyWhereItsMiddleIsInThePath) {
  Target parked = Car(1, 11.0, -1.9, 0, 0);
  parked.state_O.covariance(kYaw, kYaw) = 0.7 * 0.7;
  const auto level = [&parked](double y) {
    parked.state_O.mean[kY] = y;
    const auto found = Assess(SceneOf(Driving(14.0), {parked}), {}, {});
    return found.empty() ? Level::kInfo : found.front().warning.level;
  };
  EXPECT_LT(level(-1.9), Level::kUrgent);
  EXPECT_EQ(level(0.0), Level::kUrgent);
}

// A parked car as radar lists it at 97 m: no axis, no speed, and neither known well.
TEST(Assess, WhatShowsNeitherAxisNorSpeedStands) {
  Target parked = Car(1, 97.0, -0.7, 0, 0.1);
  parked.state_O.covariance.diagonal() << 1.0, 0.6, 0.49, 22.0, 0.01, 2.25;
  const auto warning = Only(SceneOf(Driving(22.2), {parked}));
  ASSERT_TRUE(warning);
  EXPECT_EQ(warning->level, Level::kWarn);
  parked.state_O.mean[kY] = -3.5;
  const auto beside = Only(SceneOf(Driving(22.2), {parked}));
  EXPECT_TRUE(!beside || beside->level < Level::kWarn);
}

// A lorry in the next lane that we pass at 31 m/s: its heading and yaw rate are not known better.
Target Lorry(double x, double yaw, double yaw_rate) {
  Target lorry = Car(1, x, -3.7, yaw, 26.7);
  lorry.extent.length_m = 12.0;
  lorry.extent.width_m = 2.6;
  lorry.state_O.mean[kYawRate] = yaw_rate;
  return lorry;
}

Level LevelOf(const Target& target) {
  const auto found = Assess(SceneOf(Driving(31.0), {target}), {}, {});
  return found.empty() ? Level::kInfo : found.front().warning.level;
}

TEST(Assess, ALorryThatWePassKeepsItsLaneUntilItShowsOtherwise) {
  for (const double x : {12.0, 16.0, 22.0, 30.0}) {
    EXPECT_LT(LevelOf(Lorry(x, 0.0, 0.0)), Level::kWarn) << x;
    EXPECT_LT(LevelOf(Lorry(x, 0.025, 0.06)), Level::kWarn) << x;
    EXPECT_LT(LevelOf(Lorry(x, -0.06, 0.0)), Level::kWarn) << x;  // Moves away.
  }
  EXPECT_GE(LevelOf(Lorry(14.0, 0.05, 0.02)), Level::kWarn);  // 1.3 m/s across: comes over.
}

TEST(Assess, BrakingIsNotForWhatIsAlongside) {
  EXPECT_LE(LevelOf(Lorry(5.0, 0.05, 0.1)), Level::kAdvise);
}

TEST(Assess, OncomingTrafficInItsLaneSaysNothing) {
  EXPECT_FALSE(Only(SceneOf(Driving(14.0), {Car(1, 60.0, 3.5, kPi, 14.0)})));
  // On a bend both follow.
  // Left bend of 100 m, the oncoming lane inside: 0.6 rad on, at a radius of 96.5 m.
  Target oncoming = Car(1, 96.5 * std::sin(0.6), 100.0 - 96.5 * std::cos(0.6), kPi + 0.6, 14.0);
  oncoming.state_O.mean[kYawRate] = -0.145;
  EXPECT_FALSE(Only(SceneOf(Driving(14.0, 0.14), {oncoming})));
}

TEST(Assess, OncomingTrafficOfALongBendSaysNothing) {
  // Left bend of 120 m that both follow, 93 m apart along it: neither of them leaves it.
  for (const double at_rad : {0.5, 0.65, 0.8}) {
    Target oncoming = Car(1, 116.5 * std::sin(at_rad), 120.0 - 116.5 * std::cos(at_rad),
                          WrapAngle(kPi + at_rad), 13.9);
    oncoming.state_O.mean[kYawRate] = -13.9 / 116.5;
    EXPECT_FALSE(Only(SceneOf(Driving(13.9, 13.9 / 120.0), {oncoming}))) << at_rad;
    // The same in the ego's own lane.
    oncoming.state_O.mean.head<2>() << 120.0 * std::sin(at_rad), 120.0 - 120.0 * std::cos(at_rad);
    EXPECT_TRUE(Only(SceneOf(Driving(13.9, 13.9 / 120.0), {oncoming}))) << at_rad;
  }
}

TEST(Assess, CarInTheEgosOwnLaneIsWarnedOfWhileADriverCanStillBrake) {
  // 28 m/s together, one degree of heading: 1.7 m across on the way.
  Target oncoming = Car(1, 98.0, 0.4, kPi, 14.0);
  oncoming.state_O.covariance.diagonal() << 0.1, 0.06, 3.5e-4, 0.01, 0.0036, 0.25;
  const auto warning = Only(SceneOf(Driving(14.0), {oncoming}));
  ASSERT_TRUE(warning);
  EXPECT_EQ(warning->kind, Kind::kFcw);
  EXPECT_EQ(warning->side, Side::kOncoming);
  EXPECT_EQ(warning->level, Level::kWarn);
  oncoming.state_O.mean[kY] = 3.5;
  EXPECT_FALSE(Only(SceneOf(Driving(14.0), {oncoming})));
}

TEST(Assess, NoLaneIsKeptByWhatMayStandOrPointAnywhere) {
  // First frames of a parked car: backwards at 7 m/s, give or take 4, axis unknown.
  Target parked = Car(1, 24.0, 0.8, 0.0, -7.4);
  parked.state_O.covariance.diagonal() << 4.0, 1.1, 0.49, 14.5, 0.01, 2.25;
  EXPECT_FALSE(Only(SceneOf(Driving(2.8), {parked})));
}

TEST(Steadied, JoinsWhatMostCrossingCarsDoWhereTheTrackDoesNotContradict) {
  BodyTarget target;
  target.mean << 20.0, -30.0, kPi / 2, 15.0, -0.03, 0.4;
  target.covariance.diagonal() << 0.25, 0.3, 1e-3, 0.09, 0.0036, 0.5;
  target.covariance(kYaw, kYawRate) = target.covariance(kYawRate, kYaw) = 1e-3;
  const BodyTarget steady = Steadied(target);
  // Variances 0.0036 and (0.5 / 15)^2, 0.5 and 1: each counts by its inverse.
  const double across = 0.25 / 225.0;
  EXPECT_NEAR(steady.mean[kYawRate], -0.03 * across / (0.0036 + across), 1e-9);
  EXPECT_NEAR(steady.mean[kAccel], 0.4 * 1.0 / 1.5, 1e-9);
  EXPECT_NEAR(steady.covariance(kAccel, kAccel), 0.5 / 1.5, 1e-9);
  EXPECT_GT(steady.mean[kYaw], target.mean[kYaw]);  // It had gone with the yaw rate.
  EXPECT_LT(steady.covariance(kYaw, kYaw), target.covariance(kYaw, kYaw));
  EXPECT_GT(steady.covariance.eigenvalues().real().minCoeff(), 0.0);
  target.mean[kAccel] = -3.0;   // Brakes.
  target.mean[kYawRate] = 0.3;  // Turns.
  EXPECT_EQ(Steadied(target).mean, target.mean);
}

// The last moment to brake does not wait until the heading is known better than to two degrees.
TEST(Assess, CrossingCarIsUrgentWithSomeDoubtLeft) {
  WarningsConfig sure;
  sure.urgent_crossing_probability = 0.9;
  int only_by_less = 0;
  for (double x = 6.0; x < 10.0; x += 0.1) {
    Target crossing = Car(1, x, -8.5, FromDegrees(87.5), 16.7);
    crossing.state_O.covariance.diagonal() << 0.25, 0.3, 7e-4, 0.06, 0.0036, 0.5;
    const auto level = [&crossing](const WarningsConfig& config) {
      const auto found = Assess(SceneOf(Driving(5.6), {crossing}), {}, config);
      return found.empty() ? Level::kInfo : found.front().warning.level;
    };
    EXPECT_LE(level(sure), level({})) << x;
    only_by_less += level({}) == Level::kUrgent && level(sure) < Level::kUrgent;
    if (x > 9.0) {
      EXPECT_LT(level({}), Level::kUrgent) << x;  // Has passed.
    }
  }
  EXPECT_GE(only_by_less, 2);
}

TEST(Assess, CrossingCarIsImaFromItsSide) {
  const auto left = Only(SceneOf(Driving(10.0), {Car(1, 25.0, 23.6, -kPi / 2, 10.0)}));
  ASSERT_TRUE(left);
  EXPECT_EQ(left->kind, Kind::kIma);
  EXPECT_EQ(left->side, Side::kLeft);
  EXPECT_EQ(left->level, Level::kWarn);
  const auto right = Only(SceneOf(Driving(10.0), {Car(1, 25.0, -23.6, kPi / 2, 10.0)}));
  EXPECT_EQ(right->side, Side::kRight);
}

TEST(Assess, CrossingCarThatPassesTwoMetresAheadIsNeverUrgent) {
  // Near miss of NHTSA's choreography: two metres between the bodies at the closest.
  for (double back_s = 0.2; back_s < 4.0; back_s += 0.1) {
    // Other's tail leaves the ego's path when the ego's bumper is 2 m short of it.
    const double tail_y = 0.925 - 10.0 * back_s;
    const double x = 3.75 + 2.0 + 10.0 * back_s + 0.85;
    const auto found = Only(SceneOf(Driving(10.0), {Car(1, x, tail_y + 2.0, kPi / 2, 10.0)}));
    if (found) {
      EXPECT_LT(found->level, Level::kUrgent) << back_s;
    }
  }
}

TEST(Assess, StandingEgoIsToldOfCrossingTrafficOnlyWhenItWantsToGo) {
  const Target crossing = Car(1, 8.0, -20.0, kPi / 2, 8.0);
  EXPECT_FALSE(Only(SceneOf(Driving(0.0), {crossing})));
  Scene scene = SceneOf(Driving(0.0), {crossing}, TurnSignal::kNone);
  scene.intent->accel_request_mps2 = 1.0;
  const auto found = Only(scene);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->kind, Kind::kIma);
  EXPECT_EQ(found->level, Level::kAdvise);
}

TEST(Assess, LeftTurnNeedsTheSignalOrTheTurnItself) {
  // Oncoming lane 3.5 m to the left, 30 m away at 12 m/s; the ego rolls at 4 m/s.
  const Target oncoming = Car(1, 36.0, 3.5, kPi, 12.0);
  EXPECT_FALSE(Only(SceneOf(Driving(4.0), {oncoming})));
  const auto by_signal = Only(SceneOf(Driving(4.0), {oncoming}, TurnSignal::kLeft));
  ASSERT_TRUE(by_signal);
  EXPECT_EQ(by_signal->kind, Kind::kLta);
  EXPECT_LT(by_signal->level, Level::kUrgent);
  EXPECT_FALSE(Only(SceneOf(Driving(4.0), {oncoming}, TurnSignal::kRight)));
}

TEST(Assess, StandingLeftTurnerIsAdvisedToWaitAndNotForOneThatHasPassed) {
  EXPECT_TRUE(Only(SceneOf(Driving(0.0), {Car(1, 40.0, 3.5, kPi, 10.0)}, TurnSignal::kLeft)));
  EXPECT_FALSE(Only(SceneOf(Driving(0.0), {Car(1, -6.0, 3.5, kPi, 10.0)}, TurnSignal::kLeft)));
  EXPECT_FALSE(Only(SceneOf(Driving(0.0), {Car(1, 190.0, 3.5, kPi, 10.0)}, TurnSignal::kLeft)));
}

TEST(Assess, DoubtfulExistenceLowersTheLevel) {
  Target ghost = Car(1, 23.0, 0, 0, 0);
  ghost.existence = 0.6;
  EXPECT_EQ(Only(SceneOf(Driving(15.0), {ghost}))->level, Level::kWarn);
  ghost.existence = 0.3;
  EXPECT_EQ(Only(SceneOf(Driving(15.0), {ghost}))->level, Level::kAdvise);
  ghost.existence = 0.1;
  EXPECT_TRUE(Assess(SceneOf(Driving(15.0), {ghost}), {}, {}).front().level_if_sure ==
              Level::kUrgent);
}

TEST(Assess, HiddenVehicleWarnsByWhereItCouldBe) {
  // Wide covariance: the probability of this narrow conflict is small, the danger is not.
  Target car = Car(0, 25.0, -26.0, kPi / 2, 10.0);
  car.state_O.covariance.diagonal() << 4.0, 9.0, 0.06, 4.0, 0.01, 1.0;
  const auto seen = Only(SceneOf(Driving(10.0), {car}));
  Target hidden = Vouched(car, 7, Visibility::kHidden);
  const auto unseen = Only(SceneOf(Driving(10.0), {hidden}));
  ASSERT_TRUE(unseen);
  EXPECT_EQ(unseen->level, Level::kWarn);
  EXPECT_EQ(unseen->basis, Basis::kReachable);
  EXPECT_LT(unseen->figures.conflict_probability, 0.5);
  EXPECT_TRUE(!seen || seen->level < Level::kWarn);
}

TEST(Assess, VehicleUnseenForLongIsNeverUrgent) {
  Target car = Vouched(Car(0, 23.0, 0, 0, 0), 7, Visibility::kHidden);
  EXPECT_EQ(Only(SceneOf(Driving(15.0), {car}))->level, Level::kUrgent);
  car.last_own = kStart - FromSeconds(2.1);
  EXPECT_EQ(Only(SceneOf(Driving(15.0), {car}))->level, Level::kWarn);
  car.last_own = Timestamp{};
  EXPECT_EQ(Only(SceneOf(Driving(15.0), {car}))->level, Level::kWarn);
}

TEST(Assess, BesideTheCarIsBlindSpotAndWithTheSignalALaneChangeWarning) {
  const Target beside = Car(1, -1.0, 3.3, 0.0, 15.0);
  const auto bsw = Only(SceneOf(Driving(15.0), {beside}));
  ASSERT_TRUE(bsw);
  EXPECT_EQ(bsw->kind, Kind::kBsw);
  EXPECT_EQ(bsw->side, Side::kRearLeft);
  const auto both = Assess(SceneOf(Driving(15.0), {beside}, TurnSignal::kLeft), {}, {});
  ASSERT_EQ(both.size(), 2u);
  EXPECT_EQ(both[1].warning.kind, Kind::kLcw);
  EXPECT_EQ(both[1].warning.level, Level::kWarn);
  EXPECT_EQ(Assess(SceneOf(Driving(15.0), {beside}, TurnSignal::kRight), {}, {}).size(), 1u);
  // Closing from behind: 10 m/s faster, 25 m behind the rear.
  const Target fast = Car(1, -28.0, 3.3, 0.0, 25.0);
  EXPECT_FALSE(Only(SceneOf(Driving(15.0), {fast})));
  EXPECT_EQ(Only(SceneOf(Driving(15.0), {fast}, TurnSignal::kLeft))->kind, Kind::kLcw);
  // Two lanes away.
  EXPECT_FALSE(Only(SceneOf(Driving(15.0), {Car(1, -1.0, 7.0, 0.0, 15.0)})));
}

TEST(Assess, DoesNotDependOnWhereTheOdometryFrameLies) {
  const auto here = Only(SceneOf(Driving(10.0), {Car(1, 25.0, 23.6, -kPi / 2, 10.0)}));
  Scene moved = SceneOf(Driving(10.0), {Car(1, 25.0, 23.6, -kPi / 2, 10.0)});
  const double turn = 2.1;
  moved.ego_p_O = {500.0, -300.0};
  moved.ego_yaw_O = turn;
  StateVector& x = moved.targets[0].state_O.mean;
  const Eigen::Vector2d p = x.head<2>();
  x.head<2>() = moved.ego_p_O + Eigen::Vector2d(std::cos(turn) * p.x() - std::sin(turn) * p.y(),
                                                std::sin(turn) * p.x() + std::cos(turn) * p.y());
  x[kYaw] += turn;
  const auto there = Only(moved);
  ASSERT_TRUE(here && there);
  EXPECT_EQ(here->level, there->level);
  EXPECT_EQ(here->kind, there->kind);
  EXPECT_NEAR(here->figures.time_to_conflict_s, there->figures.time_to_conflict_s, 0.11);
}

TEST(MergeLists, OneObjectPerVehicleAndOwnSensorsWinWhileTheySee) {
  TargetList local;
  local.stamp = kStart;
  local.targets = {Car(11, 20, 0, 0, 5), Car(12, 30, 3, 0, 5)};
  local.targets[1].visibility = Visibility::kHidden;
  TargetList priority;
  priority.stamp = kStart;
  priority.targets = {Vouched(Car(11, 21, 0, 0, 5), 101, Visibility::kVisible),
                      Vouched(Car(0, 50, 0, 0, 5), 103, Visibility::kHidden)};
  Target hidden = Vouched(Car(12, 33, 3, 0, 5), 102, Visibility::kHidden);
  hidden.local_id = 12;
  priority.targets.push_back(hidden);
  priority.targets[0].says_hard_braking = true;
  const auto merged = MergeLists(&local, &priority, kStart + FromSeconds(0.1));
  EXPECT_TRUE(merged[1].says_hard_braking);
  ASSERT_EQ(merged.size(), 3u);
  EXPECT_EQ(merged[0].source, Source::kPriority);
  EXPECT_EQ(merged[0].track_id, 103);
  EXPECT_EQ(merged[1].source, Source::kBoth);
  EXPECT_NEAR(merged[1].state_O.mean[kX], 20.5, 1e-9);  // LOCAL's, 0.1 s on.
  EXPECT_NEAR(merged[2].state_O.mean[kX], 33.5, 1e-9);  // PRIORITY's.
  EXPECT_EQ(MergeLists(&local, nullptr, kStart).size(), 2u);
}

// A step with 50 tracks is to stay below 5 ms; timed tests assert ratios only, so this prints.
TEST(Assess, FiftyTracksTakeLittleTime) {
  std::vector<Target> targets;
  for (int i = 0; i < 50; ++i) {
    targets.push_back(
        Car(i + 1, 8.0 + 3.0 * i, (i % 5 - 2) * 3.5, i % 3 == 0 ? kPi : 0.0, 4.0 + i % 7));
  }
  const Scene scene = SceneOf(Driving(14.0), targets, TurnSignal::kLeft);
  const auto begin = std::chrono::steady_clock::now();
  std::size_t count = 0;
  for (int i = 0; i < 20; ++i) count += Assess(scene, {}, {}).size();
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
  RecordProperty("ms_per_step", std::to_string(took.count() / 20));
  std::printf("50 tracks: %.2f ms per step, %zu assessments\n", took.count() / 20, count / 20);
}

}  // namespace
}  // namespace v2vouch::warnings
