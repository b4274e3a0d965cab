// SPDX-License-Identifier: Apache-2.0
#include "sim/spoofing/message_judgement.h"

#include <gtest/gtest.h>

#include <v2vouch/track_t.hpp>

#include "daemon/common/base/angle.h"
#include "sim/spoofing/joint_view.h"
#include "tests/sim/spoofing/spoof_scene.h"

namespace v2vouch::evaluation {
namespace {

constexpr int kTrusted = track_t::TRUST_VALIDATED;
constexpr std::uint32_t kHonest = 0xA1, kLiar = 0xB2;

class Judgement : public testing::Test {
 protected:
  Judgement() {
    scene_.AddCar(1, {30.0, 0.0}, 0.0, kHonest);
    scene_.AddCar(2, {20.0, -6.0}, 10.0, kLiar);  // At 10 m/s, so that its heading counts.
  }

  BsmTruth& Lie(double t_s) {
    BsmTruth& m = scene_.Say(t_s, 12, kLiar, 2, kTrusted);
    m.is_attacker = m.is_attack = true;
    return m;
  }
  JudgedMessage Last() { return JudgeMessages(scene_.log()).back(); }

  SpoofScene scene_{6.0};
};

TEST_F(Judgement, EachKindOfLieIsFalseFromItsLimitOn) {
  Lie(1.0);
  EXPECT_FALSE(Last().is_false);  // Says it is an attack, yet every word is true.
  Lie(1.1).claimed.p_W.y() += 1.9;
  EXPECT_FALSE(Last().is_false);
  Lie(1.2).claimed.p_W.y() += 2.1;
  EXPECT_TRUE(Last().is_false);
  Lie(1.3).claimed.speed_mps += 0.9;
  EXPECT_FALSE(Last().is_false);
  Lie(1.4).claimed.speed_mps -= 1.1;
  EXPECT_TRUE(Last().is_false);
  Lie(1.5).claimed.yaw_rad += FromDegrees(14);
  EXPECT_FALSE(Last().is_false);
  Lie(1.6).claimed.yaw_rad -= FromDegrees(16);
  EXPECT_TRUE(Last().is_false);
  Lie(1.65).age_s = 1.01;
  EXPECT_FALSE(Last().is_false);  // Of a standing car: still so.
  BsmTruth& old = Lie(1.7);
  old.age_s = 1.01;
  old.claimed.p_W.x() -= 0.6;
  EXPECT_TRUE(Last().is_false);
  Lie(1.8).vehicle = 0;
  EXPECT_TRUE(Last().is_false);
}

TEST_F(Judgement, HeadingOfASlowVehicleIsNoLie) {
  BsmTruth& m = Lie(1.0);
  m.honest.speed_mps = m.claimed.speed_mps = 2.9;
  m.claimed.yaw_rad += kPi;
  EXPECT_FALSE(Last().is_false);
}

TEST_F(Judgement, ABorrowedIdIsFalseWhateverItSaysAndItsOwnerIsContested) {
  scene_.Say(1.0, 11, kHonest, 1, kTrusted);
  BsmTruth& stolen = Lie(1.05);
  stolen.sender = kHonest;
  scene_.Say(1.1, 11, kHonest, 1, kTrusted);
  scene_.Say(3.2, 11, kHonest, 1, kTrusted);  // More than 2 s later.
  const auto judged = JudgeMessages(scene_.log());
  EXPECT_TRUE(judged[0].is_contested);
  EXPECT_TRUE(judged[1].is_false);
  EXPECT_FALSE(judged[1].is_contested);
  EXPECT_TRUE(judged[2].is_contested);
  EXPECT_FALSE(judged[3].is_contested);
}

TEST_F(Judgement, MessagesCountAfterTwoSecondsInJointView) {
  AtTenHertz(0.0, 4.0, [&](double t) { scene_.Say(t, 11, kHonest, 1, kTrusted); });
  const auto judged = JudgeMessages(scene_.log());
  ASSERT_EQ(judged.size(), 40u);
  EXPECT_TRUE(judged[0].is_in_view);
  EXPECT_FALSE(judged[19].is_eligible);  // 1.9 s.
  EXPECT_TRUE(judged[20].is_eligible);
}

TEST_F(Judgement, ACarThatWasValidatedAndClaimsToBeOutOfSightIsStillInView) {
  scene_.log_.truth.objects.clear();
  scene_.AddCar(2, {50.0, 0.0}, 0.0, kLiar);
  AtTenHertz(0.0, 1.0, [&](double t) { Lie(t).claimed.p_W.x() = -60.0; });
  EXPECT_FALSE(Last().is_in_view);  // Never seen where it says: nobody could have known it.
  AtTenHertz(1.0, 4.0, [&](double t) { Lie(t); });
  Lie(4.1).claimed.p_W.x() = -60.0;  // Behind the ego.
  EXPECT_TRUE(Last().is_in_view);
  scene_.AddCar(3, {20.0, 0.0});  // Now something stands before it.
  EXPECT_FALSE(Last().is_in_view);
}

TEST_F(Judgement, OnlyRefusalsThatSpeakAgainstTheMessageArePositive) {
  for (const char* reason : {"bsm_stale", "bsm_repeat", "bsm_rate", "bsm_table_full"}) {
    scene_.Say(1.0, 11, kHonest, 1, kTrusted, reason);
    EXPECT_TRUE(Last().is_positive) << reason;
    EXPECT_FALSE(Last().is_mistrusted) << reason;
  }
  for (const char* reason : {"no_gnss", "bsm_own_echo", "bsm_unavailable"}) {
    scene_.Say(1.0, 11, kHonest, 1, kTrusted, reason);
    EXPECT_FALSE(Last().is_positive) << reason;
  }
  scene_.Say(1.0, 11, kHonest, 1, track_t::TRUST_SUSPECT);
  EXPECT_TRUE(Last().is_positive && Last().is_mistrusted);
  scene_.Say(1.0, 11, kHonest, 1, track_t::TRUST_REVOKED);
  EXPECT_TRUE(Last().is_positive);
  scene_.Say(1.0, 11, kHonest, 1, track_t::TRUST_BRIDGED);
  EXPECT_TRUE(!Last().is_positive && Last().is_relied_on);
  scene_.Say(1.0, 11, kHonest, 1, track_t::TRUST_CANDIDATE);
  EXPECT_FALSE(Last().is_positive || Last().is_relied_on);
}

TEST_F(Judgement, AMessageWithoutVerdictIsToldApart) {
  scene_.Say(1.0, 11, kHonest, 1, kTrusted);
  scene_.log_.bsm_verdicts.clear();
  EXPECT_FALSE(Last().has_verdict);
  EXPECT_FALSE(Last().is_positive);
}

TEST_F(Judgement, VerdictsBelongToTheAttackerOnlyOnceItAttacks) {
  scene_.Say(0.5, 12, kLiar, 2, kTrusted).is_attacker = true;  // Honest so far.
  Lie(2.0);
  Lie(2.1).sender = kHonest;
  scene_.Say(0.5, 11, kHonest, 1, kTrusted);
  const Senders senders(scene_.log());
  EXPECT_FALSE(senders.AttackerMeant(kLiar, scene_.At(1.9)));
  EXPECT_EQ(senders.AttackerMeant(kLiar, scene_.At(60.0)), 12);
  EXPECT_EQ(senders.AttackerMeant(kHonest, scene_.At(3.0)), 12);
  EXPECT_FALSE(senders.AttackerMeant(kHonest, scene_.At(13.0)));  // It stopped long ago.
  EXPECT_EQ(senders.HonestUser(kHonest), 11);
  ASSERT_NE(senders.AttackUnder(kLiar, scene_.At(2.0)), nullptr);
  EXPECT_EQ(senders.AttackUnder(kLiar, scene_.At(2.0))->original_vehicle, 2);
}

TEST_F(Judgement, JointViewNeedsRangeFieldOfViewAndAFreeLine) {
  scene_.AddCar(3, {50.0, 10.0});
  scene_.log_.specs.buildings = {{{60, -30}, {80, -30}, {80, -10}, {60, -10}}};
  JointView view(scene_.log());
  const Timestamp t = scene_.At(1.0);
  EXPECT_TRUE(view.Sees(t, {40.0, 10.0}, 0));
  EXPECT_FALSE(view.Sees(t, {4.0, 0.0}, 0));     // Too near.
  EXPECT_FALSE(view.Sees(t, {99.5, 20.0}, 0));   // 101.5 m away.
  EXPECT_FALSE(view.Sees(t, {-40.0, 0.0}, 0));   // Behind.
  EXPECT_FALSE(view.Sees(t, {30.0, 20.0}, 0));   // 34 degrees off.
  EXPECT_FALSE(view.Sees(t, {60.0, 0.0}, 0));    // Behind car 1.
  EXPECT_TRUE(view.Sees(t, {31.0, 0.5}, 0));     // In car 1's own box.
  EXPECT_FALSE(view.Sees(t, {34.0, 0.0}, 0));    // 2 m behind its back ...
  EXPECT_TRUE(view.Sees(t, {34.0, 0.0}, 1));     // ... is an honest error of car 1 itself ...
  EXPECT_FALSE(view.Sees(t, {36.0, 0.0}, 1));    // ... but 4 m are not.
  EXPECT_FALSE(view.Sees(t, {90.0, -25.0}, 0));  // Behind the house.
  EXPECT_FALSE(view.Sees(scene_.At(7.0), {40.0, 10.0}, 0));  // After the truth's end.
}

}  // namespace
}  // namespace v2vouch::evaluation
