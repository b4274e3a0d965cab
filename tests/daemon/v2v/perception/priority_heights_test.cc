// SPDX-License-Identifier: Apache-2.0
// Heights in PRIORITY: bridges never match, other zeros of height do.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/daemon/v2v/perception/priority_scene.h"

namespace v2vouch {
namespace {

constexpr double kEgoHeight_m = 60.0;  // Of the scene's fixes.

bool Holds(const Scene& scene, SenderId sender) {
  const auto tracks = scene.Priority();
  return std::ranges::any_of(tracks, [&](const auto& line) { return line.sender == sender; });
}

std::vector<Notice> NoticesOf(const Scene& scene) {
  std::vector<Notice> notices;
  scene.perception.CollectNotices(notices);
  return notices;
}

// Two cars that drive away in two lanes at 6 m/s.
Scene TwoCars(std::uint64_t seed = 1) {
  Scene scene(seed);
  scene.cars = {{.local_id = 11, .p = {15.0, 0.0}, .speed_mps = 6.0},
                {.local_id = 12, .p = {25.0, 8.0}, .speed_mps = 6.0}};
  return scene;
}

// Car `index` talks, ten times a second.
void Talk(Scene& scene, std::size_t index, SenderId sender, double height_m) {
  if (scene.frames % 2 != 0) return;
  const Car& car = scene.cars[index];
  scene.Say(sender, car.p + Eigen::Vector2d(0.6, -0.5), car.yaw_rad, car.speed_mps, 0.5, height_m);
}

TEST(PriorityHeights, AConstantDifferenceToEverybodyIsNoBridge) {
  for (const double difference_m : {47.0, -47.0, -60.0, 9.0}) {
    Scene scene = TwoCars();
    scene.Run(std::abs(difference_m) < 20.0 ? 16.0 : 5.0, [&] {
      Talk(scene, 0, 0xA1, kEgoHeight_m + difference_m);
      Talk(scene, 1, 0xA2, kEgoHeight_m + difference_m);
    });
    EXPECT_TRUE(Holds(scene, 0xA1) && Holds(scene, 0xA2)) << difference_m;
    const auto notices = NoticesOf(scene);
    ASSERT_EQ(notices.size(), 1u);
    EXPECT_EQ(notices[0].kind, NoticeKind::kHeightOffset);
    EXPECT_NEAR(notices[0].value, difference_m, 0.5);
    EXPECT_EQ(notices[0].subject.kind, NoticeSubject::Kind::kGnss);
  }
}

TEST(PriorityHeights, OneSenderAloneIsMatchedAfterSomeWayWhereNoBridgeIsSoHigh) {
  Scene scene = TwoCars();
  scene.Run(3.0, [&] { Talk(scene, 0, 0xA1, kEgoHeight_m + 47.0); });
  EXPECT_FALSE(Holds(scene, 0xA1));
  EXPECT_EQ(NoticesOf(scene).at(0).kind, NoticeKind::kHeightsApart);
  scene.Run(10.0, [&] { Talk(scene, 0, 0xA1, kEgoHeight_m + 47.0); });
  EXPECT_TRUE(Holds(scene, 0xA1));
}

// On the upper of two decks, at the pace of the car below, as long as one likes.
TEST(PriorityHeights, ACarOnABridgeNeverMatchesHoweverLongItKeepsPace) {
  for (const double deck_m : {5.0, 6.0, 12.0, -6.0}) {
    Scene scene = TwoCars();
    scene.Run(25.0, [&] {
      Talk(scene, 0, 0xA1, kEgoHeight_m + deck_m);
      ASSERT_FALSE(Holds(scene, 0xA1)) << deck_m;
    });
    EXPECT_EQ(NoticesOf(scene).at(0).kind, NoticeKind::kHeightsApart);
  }
}

TEST(PriorityHeights, NorDoesItBesideOneOnTheEgosOwnLevel) {
  for (const double deck_m : {6.0, 30.0}) {
    Scene scene = TwoCars();
    scene.Run(25.0, [&] {
      Talk(scene, 1, 0xA2, kEgoHeight_m + 0.5);
      Talk(scene, 0, 0xA1, kEgoHeight_m + deck_m);
      ASSERT_FALSE(Holds(scene, 0xA1)) << deck_m;
    });
    EXPECT_TRUE(Holds(scene, 0xA2));
    EXPECT_TRUE(NoticesOf(scene).empty());
  }
}

// It overhears nobody else for a while, tells a wild height and is taken for the common one. The
// honest sender that comes later is matched all the same.
TEST(PriorityHeights, ALiarCannotPushHonestSendersOntoAnotherLevel) {
  Scene scene = TwoCars();
  scene.Run(14.0, [&] { Talk(scene, 0, 0xBAD, kEgoHeight_m + 80.0); });
  scene.Run(8.0, [&] {
    Talk(scene, 0, 0xBAD, kEgoHeight_m + 80.0);
    Talk(scene, 1, 0xA2, kEgoHeight_m);
  });
  EXPECT_TRUE(Holds(scene, 0xA2));
}

TEST(PriorityHeights, AnEgoWithoutHeightKnowsNoBridges) {
  Scene scene = TwoCars();
  scene.has_height = false;
  scene.Run(7.0, [] {});  // The heights told before are forgotten.
  scene.Run(6.0, [&] { Talk(scene, 0, 0xA1, kEgoHeight_m + 47.0); });
  EXPECT_TRUE(Holds(scene, 0xA1));
  EXPECT_TRUE(NoticesOf(scene).empty());
}

// The other car's road climbs from where the ego stands: 12 % over 100 m and more.
TEST(PriorityHeights, OnAClimbTheDifferenceGrowsWithTheWay) {
  Scene scene = TwoCars();
  scene.Run(16.0, [&] { Talk(scene, 0, 0xA1, kEgoHeight_m + 0.12 * scene.cars[0].p.x()); });
  EXPECT_GT(scene.cars[0].p.x(), 100.0);
  EXPECT_TRUE(Holds(scene, 0xA1));
  EXPECT_TRUE(NoticesOf(scene).empty());
}

}  // namespace
}  // namespace v2vouch
