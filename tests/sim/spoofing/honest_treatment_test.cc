// SPDX-License-Identifier: Apache-2.0
#include "sim/spoofing/honest_treatment.h"

#include <gtest/gtest.h>

#include <v2vouch/track_t.hpp>

#include "tests/sim/spoofing/spoof_scene.h"

namespace v2vouch::evaluation {
namespace {

constexpr std::uint32_t kFirst = 0xA1, kLiar = 0xB2;

HonestTreatment Judged(const SpoofScene& scene) {
  return JudgeHonest(scene.log(), Senders(scene.log()), JudgeMessages(scene.log()));
}

TEST(HonestTreatment, TimeWithdrawnIsByTheStateAtEachMessage) {
  SpoofScene scene(10.0);
  scene.AddCar(1, {40.0, 0.0}, 0.0, kFirst);
  AtTenHertz(0.0, 10.0, [&](double t) {
    const bool is_withdrawn = t > 3.95 && t < 5.95;  // 20 messages.
    scene.Say(t, 11, kFirst, 1, is_withdrawn ? track_t::TRUST_SUSPECT : track_t::TRUST_VALIDATED);
  });
  const HonestTreatment h = Judged(scene);
  EXPECT_NEAR(h.vehicle_s, 9.9, 1e-6);
  EXPECT_NEAR(h.withdrawn_s, 2.0, 1e-6);
  EXPECT_EQ(h.senders, 1);
}

TEST(HonestTreatment, SilencesFarVehiclesAndAttackersAddNoVehicleTime) {
  SpoofScene scene(10.0);
  scene.AddCar(1, {40.0, 0.0}, 0.0, kFirst);
  scene.AddCar(2, {160.0, 0.0}, 0.0, 0xA2);
  scene.AddCar(3, {50.0, 5.0}, 0.0, kLiar);
  for (const double t : {0.0, 1.0, 4.0, 5.0}) scene.Say(t, 11, kFirst, 1, 3);  // 3 s of silence.
  AtTenHertz(0.0, 10.0, [&](double t) {
    scene.Say(t, 12, 0xA2, 2, 3);
    scene.Say(t, 13, kLiar, 3, 3).is_attacker = true;
  });
  EXPECT_NEAR(Judged(scene).vehicle_s, 2.0, 1e-6);
}

TEST(HonestTreatment, OnlyVerdictsOnHonestSendersAreHeldAgainstUs) {
  SpoofScene scene(10.0);
  scene.AddCar(1, {40.0, 0.0}, 0.0, kFirst);
  scene.AddCar(3, {50.0, 5.0}, 0.0, kLiar);
  scene.Say(1.0, 11, kFirst, 1, 3);
  BsmTruth& lie = scene.Say(1.0, 13, kLiar, 3, 3);
  lie.is_attacker = lie.is_attack = true;
  scene.Report(2.0, kFirst, true);
  scene.Report(2.0, kFirst, false);
  scene.Report(3.0, kFirst, true);
  scene.Report(2.0, kLiar, true);
  scene.Report(2.0, 0xFFFF, true);  // Nobody the simulator knows.
  const HonestTreatment h = Judged(scene);
  EXPECT_EQ(h.accusations, 2);
  EXPECT_EQ(h.accused, 1);
  EXPECT_EQ(h.withdrawals, 1);
}

// Car 1 is hidden from 4 s to 8 s; its track follows it, or not.
class Bridging : public testing::Test {
 protected:
  HonestTreatment Track(const std::function<Eigen::Vector2d(double)>& error,
                        const std::function<std::int64_t(double)>& id) {
    SpoofScene scene(12.0);
    scene.AddCar(1, {40.0, 0.0}, 0.0, kFirst);
    scene.Hide(1, 4.0, hidden_to_s_);
    scene.Look();
    AtTenHertz(0.0, 12.0, [&](double t) { scene.Say(t, 11, kFirst, 1, 3); });
    for (int k = 0; k <= 240; ++k) {
      const double t = 0.05 * k;
      if (id(t) != 0)
        scene.AddTrack(id(t), kFirst, Eigen::Vector2d(40.0, 0.0) + error(t), budget_s_);
      scene.List(t);
    }
    return Judged(scene);
  }
  double hidden_to_s_ = 8.0;
  double budget_s_ = 10.0;
};

Eigen::Vector2d None(double) { return Eigen::Vector2d::Zero(); }

TEST_F(Bridging, ATrackThatStaysWithinTwoMetresSurvives) {
  const HonestTreatment h = Track(
      [](double t) { return Eigen::Vector2d(t > 7.0 ? 1.9 : 0.0, 0.0); }, [](double) { return 5; });
  EXPECT_EQ(h.bridges, 1);
  EXPECT_EQ(h.bridges_survived, 1);
  EXPECT_EQ(h.bridges_same_id, 1);
  EXPECT_GT(h.holdable_s, 9.0);
  EXPECT_NEAR(h.held_s, h.holdable_s, 1e-9);
}

TEST(HonestTreatment, WhoIsInViewCountsOnceValidationWasPossible) {
  SpoofScene scene(12.0);
  scene.AddCar(1, {40.0, 0.0}, 0.0, kFirst);
  scene.Hide(1, 8.0, 10.0);
  // VALIDATED from 4 s; hidden messages count neither way.
  AtTenHertz(0.0, 12.0, [&](double t) { scene.Say(t, 11, kFirst, 1, t < 4.0 ? 2 : 3); });
  const HonestTreatment h = Judged(scene);
  EXPECT_NEAR(h.in_view, 60, 1);    // 2..8 s.
  EXPECT_NEAR(h.validated, 40, 1);  // 4..8 s.
}

TEST_F(Bridging, ATrackThatStraysOrEndsDoesNot) {
  EXPECT_EQ(Track([](double t) { return Eigen::Vector2d(t > 7.0 ? 2.1 : 0.0, 0.0); },
                  [](double) { return 5; })
                .bridges_survived,
            0);
  const HonestTreatment ended = Track(None, [](double t) { return t < 7.5 ? 5 : 0; });
  EXPECT_EQ(ended.bridges, 1);
  EXPECT_EQ(ended.bridges_survived, 0);
  EXPECT_LT(ended.held_s, ended.holdable_s);
}

TEST_F(Bridging, WhatOutlastsTheBudgetIsToldApart) {
  for (const auto& [budget_s, is_within] : {std::pair{4.5, 1}, {3.5, 0}}) {
    budget_s_ = budget_s;
    const HonestTreatment h = Track(None, [](double t) { return t < 7.5 ? 5 : 0; });
    EXPECT_EQ(h.bridges, 1);
    EXPECT_EQ(h.bridges_in_budget, is_within);
    EXPECT_EQ(h.survived_in_budget, 0);
    EXPECT_EQ(Track(None, [](double) { return 5; }).survived_in_budget, is_within);
  }
}

TEST_F(Bridging, ANewIdAfterwardsIsNotTheSame) {
  const HonestTreatment h = Track(None, [](double t) { return t < 8.5 ? 5 : 6; });
  EXPECT_EQ(h.bridges_survived, 1);
  EXPECT_EQ(h.bridges_same_id, 0);
}

TEST_F(Bridging, ShortAndLongOcclusionsAndUnlistedVehiclesAreNoBridges) {
  hidden_to_s_ = 6.9;
  EXPECT_EQ(Track(None, [](double) { return 5; }).bridges, 0);
  hidden_to_s_ = 10.2;
  EXPECT_EQ(Track(None, [](double) { return 5; }).bridges, 0);
  hidden_to_s_ = 8.0;
  EXPECT_EQ(Track(None, [](double t) { return t > 5.0 ? 5 : 0; }).bridges, 0);
}

}  // namespace
}  // namespace v2vouch::evaluation
