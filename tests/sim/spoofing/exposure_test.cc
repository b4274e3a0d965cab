// SPDX-License-Identifier: Apache-2.0
#include "sim/spoofing/exposure.h"

#include <gtest/gtest.h>

#include <v2vouch/track_t.hpp>

#include "tests/sim/spoofing/spoof_scene.h"

namespace v2vouch::evaluation {
namespace {

constexpr std::uint32_t kLiar = 0xB2, kHonest = 0xA1;

class ExposureOf : public testing::Test {
 protected:
  // Car 1 covers x 28..32, y -1..1; car 2 is the liar's.
  ExposureOf() {
    scene_.AddCar(1, {30.0, 0.0}, 0.0, kHonest);
    scene_.AddCar(2, {60.0, 10.0}, 0.0, kLiar);
    scene_.Say(0.0, 12, kLiar, 2, track_t::TRUST_VALIDATED).is_attacker = true;
    BsmTruth& lie = scene_.Say(2.0, 12, kLiar, 2, track_t::TRUST_VALIDATED);
    lie.is_attacker = lie.is_attack = true;
  }

  // A list every 50 ms; `place` may give nothing.
  Exposure With(std::uint32_t sender,
                const std::function<std::optional<Eigen::Vector2d>(double)>& place) {
    for (int k = 0; k <= 100; ++k) {
      const double t = 0.05 * k;
      if (const auto p = place(t)) scene_.AddTrack(7, sender, *p);
      scene_.List(t);
    }
    return MeasureExposure(scene_.log(), Senders(scene_.log()));
  }

  SpoofScene scene_{5.0};
};

TEST_F(ExposureOf, AnAttackersTrackIsTheDistanceToTheNearestBoxOnceItAttacks) {
  const Exposure e = With(kLiar, [](double t) {
    return t < 3.0 ? Eigen::Vector2d(30.0, -4.0) : Eigen::Vector2d(30.0, -5.0);
  });
  // 3 m from car 1 until 3 s, then 4 m; counted from 2 s on, 41 + 20 instants.
  EXPECT_NEAR(e.max_m, 4.0, 1e-9);
  EXPECT_NEAR(e.harm_s, 41 * 0.05, 1e-9);
  EXPECT_NEAR(e.priority_s, 61 * 0.05, 1e-9);
  EXPECT_NEAR(e.original_max_m, std::hypot(28.0, 14.0), 1e-9);
  ASSERT_EQ(e.curve_m.size(), 7u);
  EXPECT_NEAR(e.curve_m[1], 3.0, 1e-9);
  EXPECT_NEAR(e.curve_m[2], 4.0, 1e-9);
  EXPECT_TRUE(e.ghosts.empty());
  EXPECT_EQ(e.instants, 101);
}

TEST_F(ExposureOf, HonestTracksDoNotCountForTheAttack) {
  const Exposure e = With(kHonest, [](double) { return Eigen::Vector2d(30.0, -5.0); });
  EXPECT_EQ(e.max_m, 0.0);
  EXPECT_EQ(e.priority_s, 0.0);
  EXPECT_TRUE(e.curve_m.empty());
}

TEST_F(ExposureOf, AGhostLastsAFifthOfASecond) {
  const auto from_to = [](double to) {
    return [to](double t) -> std::optional<Eigen::Vector2d> {
      if (t < 0.999 || t > to) return std::nullopt;
      return Eigen::Vector2d(30.0, -7.0);  // 6 m from car 1.
    };
  };
  EXPECT_TRUE(With(kHonest, from_to(1.16)).ghosts.empty());  // 1.00, 1.05, 1.10, 1.15: 0.15 s.
  scene_.log_.lists[Index(ListKind::kPriority)].clear();
  const Exposure e = With(kHonest, from_to(1.21));
  ASSERT_EQ(e.ghosts.size(), 1u);
  EXPECT_EQ(e.ghosts_of_attackers(), 0);
  EXPECT_EQ(e.ghosts[0].track, 7);
  EXPECT_EQ(e.ghosts[0].sender, kHonest);
  EXPECT_NEAR(e.ghosts[0].from_s, 1.0, 1e-9);
  EXPECT_NEAR(e.ghosts[0].to_s, 1.2, 1e-9);
  EXPECT_NEAR(e.ghosts[0].max_m, 6.0, 1e-9);
}

TEST_F(ExposureOf, WhatIsBeyondTheTruthsReachIsNotJudged) {
  const Exposure e = With(kLiar, [](double) { return Eigen::Vector2d(141.0, 0.0); });
  EXPECT_TRUE(e.ghosts.empty());
  EXPECT_EQ(e.max_m, 0.0);
}

TEST_F(ExposureOf, AGhostOfAnAttackerIsCountedOncePerTrack) {
  const Exposure e = With(kLiar, [](double t) {  // Comes, goes, and comes again.
    return t > 3.0 && t < 3.5 ? Eigen::Vector2d(30.0, 0.0) : Eigen::Vector2d(30.0, -7.0);
  });
  ASSERT_EQ(e.ghosts.size(), 1u);
  EXPECT_EQ(e.ghosts_of_attackers(), 1);
  EXPECT_NEAR(e.ghosts[0].to_s, 5.0, 1e-9);
}

TEST_F(ExposureOf, LingeringIsWhereTheSensorsCouldHaveLooked) {
  const auto beside = [](double x_m) {
    return [x_m](double t) -> std::optional<Eigen::Vector2d> {
      if (t < 2.499 || t > 4.001) return std::nullopt;
      return Eigen::Vector2d(x_m, -5.0);  // Clear of car 1 by 4 m.
    };
  };
  EXPECT_NEAR(With(kLiar, beside(30.0)).lingered_s, 1.55, 1e-9);
  scene_.log_.lists[Index(ListKind::kPriority)].clear();
  EXPECT_EQ(With(kLiar, beside(-30.0)).lingered_s, 0.0);  // Behind the ego nobody looks.
}

TEST_F(ExposureOf, OneCarListedTwiceIsDoubledAndThreeForTwoOutnumber) {
  for (int k = 0; k <= 100; ++k) {
    scene_.AddTrack(7, kLiar, {30.0, 0.5});
    scene_.AddTrack(8, kHonest, {31.0, -0.5});
    if (k < 50) scene_.AddTrack(9, kHonest, {60.0, 10.0});
    scene_.List(0.05 * k);
  }
  const Exposure e = MeasureExposure(scene_.log(), Senders(scene_.log()));
  EXPECT_EQ(e.doubled, 101);
  EXPECT_EQ(e.outnumbered, 50);
}

}  // namespace
}  // namespace v2vouch::evaluation
