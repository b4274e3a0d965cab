// SPDX-License-Identifier: Apache-2.0
#include "sim/spoofing/spoof_run.h"

#include <gtest/gtest.h>

#include <v2vouch/track_t.hpp>

#include "sim/spoofing/spoof_json.h"
#include "tests/sim/spoofing/spoof_scene.h"

namespace v2vouch::evaluation {
namespace {

constexpr std::uint32_t kHonest = 0xA1, kLiar = 0xB2;

// 12 s. Car 1 tells the truth; three of its messages are refused after 8 s. Car 2 is honest until
// 5 s, then claims to be 8 m further right; from 6 s on it is SUSPECT, but for two messages.
SpoofScene Attacked() {
  SpoofScene scene(12.0);
  scene.AddCar(1, {30.0, 4.0}, 0.0, kHonest);
  scene.AddCar(2, {50.0, 0.0}, 0.0, kLiar);
  AtTenHertz(0.0, 12.0, [&](double t) {
    const bool is_refused = t > 7.95 && t < 8.25;
    scene.Say(t, 11, kHonest, 1, track_t::TRUST_VALIDATED, is_refused ? "bsm_rate" : "");
    const bool is_lie = t > 4.95;
    const bool is_met = t > 5.95 && !(t > 9.95 && t < 10.15);
    BsmTruth& m =
        scene.Say(t, 12, kLiar, 2, is_met ? track_t::TRUST_SUSPECT : track_t::TRUST_VALIDATED);
    m.is_attacker = true;
    m.is_attack = is_lie;
    if (is_lie) m.claimed.p_W.y() -= 8.0;
  });
  return scene;
}

TEST(SpoofRun, EveryCountOfAKnownRunIsRight) {
  const SpoofRun run = JudgeSpoof(Attacked().log(), false);
  EXPECT_EQ(run.messages, 240);
  EXPECT_EQ(run.false_messages, 70);
  EXPECT_EQ(run.unanswered, 0);
  // 5.0..11.9 s false: 10 before it is met and 2 in between are missed.
  EXPECT_EQ(run.by_message.true_positive, 58);
  EXPECT_EQ(run.by_message.false_negative, 12);
  EXPECT_EQ(run.by_message.false_positive, 3);
  EXPECT_EQ(run.by_message.true_negative, 97);  // Eligible from 2.0 s: 100 messages.
  EXPECT_NEAR(*run.by_message.precision(), 58.0 / 61.0, 1e-12);
  EXPECT_NEAR(*run.by_message.recall(), 58.0 / 70.0, 1e-12);
  EXPECT_NEAR(*run.by_message.f1(), 116.0 / 131.0, 1e-12);
  ASSERT_EQ(run.attackers.size(), 1u);
  EXPECT_EQ(run.attackers[0].device, 12);
  EXPECT_NEAR(run.attackers[0].first_false_s, 5.0, 1e-9);
  EXPECT_NEAR(run.attackers[0].false_in_view_s, 6.9, 1e-9);
  EXPECT_NEAR(*run.attackers[0].met_after_s, 1.0, 1e-9);
  EXPECT_FALSE(run.attackers[0].accused_after_s);
  EXPECT_EQ(run.by_source.true_positive, 1);
  EXPECT_EQ(run.by_source.false_positive, 1);
}

TEST(SpoofRun, AVerdictMeetsAnAttackerBeforeItsMessagesShowIt) {
  SpoofScene scene = Attacked();
  scene.Report(4.0, kLiar, false);  // Before it lied: counts for nothing.
  scene.Report(5.4, kLiar, false);
  scene.Report(7.0, kLiar, true);
  const SpoofRun run = JudgeSpoof(scene.log(), false);
  ASSERT_EQ(run.attackers.size(), 1u);
  EXPECT_NEAR(*run.attackers[0].met_after_s, 0.4, 1e-9);
  EXPECT_NEAR(*run.attackers[0].accused_after_s, 2.0, 1e-9);
}

TEST(SpoofRun, OneRefusalDoesNotMeetASenderThatIsReliedOn) {
  SpoofScene scene(10.0);
  scene.AddCar(2, {50.0, 0.0}, 0.0, kLiar);
  AtTenHertz(0.0, 10.0, [&](double t) {
    BsmTruth& m = scene.Say(t, 12, kLiar, 2, track_t::TRUST_VALIDATED,
                            std::abs(t - 5.0) < 0.01 ? "bsm_rate" : "");
    m.is_attacker = m.is_attack = true;
    m.claimed.p_W.y() -= 5.0;
  });
  const SpoofRun run = JudgeSpoof(scene.log(), false);
  ASSERT_EQ(run.attackers.size(), 1u);
  EXPECT_FALSE(run.attackers[0].met_after_s);
  EXPECT_TRUE(run.attackers[0].was_detected);
  EXPECT_EQ(run.by_message.true_positive, 1);
}

TEST(SpoofRun, ASenderNeverReliedOnIsMetByItsFirstPositiveMessage) {
  SpoofScene scene(10.0);
  scene.AddCar(1, {30.0, 6.0}, 0.0, kHonest);
  AtTenHertz(0.0, 10.0, [&](double t) {
    BsmTruth& m =
        scene.Say(t, 13, 0xC3, 0, t > 0.75 ? track_t::TRUST_SUSPECT : track_t::TRUST_UNKNOWN);
    m.is_attacker = m.is_attack = true;
    m.claimed.p_W = {40.0, -3.0};
    m.claimed.length_m = 4.5;
  });
  const SpoofRun run = JudgeSpoof(scene.log(), false);
  ASSERT_EQ(run.attackers.size(), 1u);
  EXPECT_NEAR(*run.attackers[0].met_after_s, 0.8, 1e-9);
  EXPECT_EQ(run.by_message.true_positive, 80);  // From 2.0 s on.
  EXPECT_EQ(run.by_message.false_negative, 0);
}

TEST(SpoofRun, WithoutFalseMessagesNothingIsMeasured) {
  SpoofScene scene(5.0);
  scene.AddCar(1, {30.0, 4.0}, 0.0, kHonest);
  AtTenHertz(0.0, 5.0, [&](double t) { scene.Say(t, 11, kHonest, 1, track_t::TRUST_VALIDATED); });
  const SpoofRun run = JudgeSpoof(scene.log(), false);
  EXPECT_FALSE(run.by_message.recall());
  EXPECT_FALSE(run.by_message.f1());
  EXPECT_NE(SpoofJson(run).find("\"f1\":null"), std::string::npos);
}

TEST(SpoofJson, ComesBackAsItWent) {
  SpoofScene scene = Attacked();
  scene.Report(7.0, kLiar, true);
  scene.AddTrack(5, kLiar, {50.0, -9.0});
  scene.List(6.0);
  SpoofRun run = JudgeSpoof(scene.log(), true);
  ASSERT_TRUE(run.checks_by_message);
  SpoofRun back;
  ASSERT_TRUE(ReadSpoofJson(SpoofJson(run), back));
  EXPECT_EQ(SpoofJson(back), SpoofJson(run));
  EXPECT_EQ(SpoofTable(back), SpoofTable(run));
  EXPECT_FALSE(ReadSpoofJson("{\"by_message\": 3", back));
  EXPECT_FALSE(ReadSpoofJson("[]", back));
}

}  // namespace
}  // namespace v2vouch::evaluation
