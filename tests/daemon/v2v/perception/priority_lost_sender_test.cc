// SPDX-License-Identifier: Apache-2.0
// A sender that says itself, by the accuracy it reports, that it does not know where it is: a
// street canyon with an honest receiver.
#include "tests/daemon/v2v/perception/priority_scene.h"

namespace v2vouch {
namespace {

const Eigen::Vector2d kOff(5.0, 6.0);

TEST(PriorityLostSender, KeepsAVehicleThatIsSeenWhereTheSensorsHaveIt) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Scene scene = Validated(seed);
    const std::uint64_t id = scene.Priority()[0].track.id;
    scene.Run(5.0, [&] {
      scene.Lost(1, kOff);
      const auto lines = scene.Priority();
      ASSERT_EQ(lines.size(), 1u) << "seed " << seed;
      EXPECT_EQ(lines[0].track.id, id);
      EXPECT_LT(ErrorOf(lines[0], scene.cars[0]), 0.5) << "seed " << seed;
    });
    scene.Run(2.0, [&] { scene.Honest(1); });
    ASSERT_EQ(scene.Priority().size(), 1u) << "seed " << seed;
    EXPECT_EQ(scene.Priority()[0].track.id, id);
    EXPECT_TRUE(scene.outputs.reports.empty());
  }
}

TEST(PriorityLostSender, ItsMotionCarriesAHiddenVehicleThatTurns) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Scene scene = Validated(seed);
    Hide(scene);
    double most_m = 0.0;
    scene.Run(2.5, [&] {
      scene.cars[0].yaw_rad = WrapAngle(scene.cars[0].yaw_rad + 0.1 * kFrame_s);
      scene.Lost(1, kOff);
      ASSERT_EQ(scene.Priority().size(), 1u) << "seed " << seed;
      most_m = std::max(most_m, ErrorOf(scene.Priority()[0], scene.cars[0]));
    });
    EXPECT_LT(most_m, 1.0) << "seed " << seed;
    EXPECT_TRUE(scene.outputs.reports.empty());
  }
}

// While the sensors saw it, nothing of what it said was compared with them.
TEST(PriorityLostSender, NoBridgeBeginsOnASenderThatHasBeenLostForSeconds) {
  Scene scene = Validated(2);
  scene.Run(2.0, [&] { scene.Lost(1, kOff); });
  ASSERT_EQ(scene.Priority().size(), 1u);
  Hide(scene);
  scene.Run(1.0, [&] { scene.Lost(1, kOff); });
  EXPECT_TRUE(scene.Priority().empty());
  EXPECT_TRUE(scene.outputs.reports.empty());
}

// Turned at once, as the last look at a part had it: the claimed direction is not shut out by its
// gate, the vehicle would go on into the wrong street.
TEST(PriorityLostSender, AHiddenVehicleCarriedInAFalseDirectionIsTurnedOrEnded) {
  Scene scene = Validated(3);
  Hide(scene);
  scene.cars[0].yaw_rad = WrapAngle(scene.cars[0].yaw_rad + 0.7);
  scene.Run(3.0, [&] {
    scene.Lost(1, kOff);
    for (const auto& line : scene.Priority()) EXPECT_LT(ErrorOf(line, scene.cars[0]), 4.0);
  });
  EXPECT_TRUE(scene.outputs.reports.empty());
}

TEST(PriorityLostSender, IsNeverValidatedAndAfterTenSecondsNoLongerRelied) {
  Scene stranger;
  stranger.cars = {OncomingCar()};
  stranger.Run(6.0, [&] { stranger.Lost(1, {0.0, 0.0}); });
  EXPECT_TRUE(stranger.Priority().empty());

  Scene scene = Validated(4, 4.0, 90.0);
  scene.Run(9.5, [&] { scene.Lost(1, kOff); });
  EXPECT_EQ(scene.Priority().size(), 1u);
  scene.Run(1.0, [&] { scene.Lost(1, kOff); });
  EXPECT_TRUE(scene.Priority().empty());
  EXPECT_TRUE(scene.outputs.reports.empty());
}

}  // namespace
}  // namespace v2vouch
