// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/intake/path_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/random.h"

namespace v2vouch {
namespace {

const MessageCheckConfig kConfig;

// Steps of 0.1 s with the way truly made and the claimed motion.
struct Story {
  explicit Story(double noise = 0.0) : noise_m(noise) {}

  PathCheck check;
  Random random{3};
  double noise_m = 0.0;
  Eigen::Vector2d last_noise = Eigen::Vector2d::Zero();

  std::optional<Finding> Step(const Eigen::Vector2d& v_mps, double claimed_mps,
                              double claimed_yaw_rad = 0.0, double dt_s = 0.1,
                              const Eigen::Vector2d& shift_m = Eigen::Vector2d::Zero()) {
    const double x = random.Normal(0.0, noise_m);
    const double y = random.Normal(0.0, noise_m);
    const Eigen::Vector2d noise(x, y);
    PathStep step;
    step.dt_s = dt_s;
    step.moved_m = v_mps * dt_s + shift_m + noise - last_noise;
    step.claimed_m = ClaimedWay(claimed_yaw_rad, claimed_mps, claimed_yaw_rad, claimed_mps, dt_s);
    last_noise = noise;
    return check.Judge(step, kConfig);
  }
};

TEST(ClaimedWay, IsTheChordOfTheArc) {
  // A quarter circle of radius 10 m at 5 m/s: pi s, from east to north.
  const Eigen::Vector2d way = ClaimedWay(0.0, 5.0, kPi / 2.0, 5.0, kPi);
  EXPECT_NEAR(way.x(), 10.0, 1e-9);
  EXPECT_NEAR(way.y(), 10.0, 1e-9);
  const Eigen::Vector2d back = ClaimedWay(0.3, -2.0, 0.3, -4.0, 0.5);
  EXPECT_NEAR(back.x(), -1.5 * std::cos(0.3), 1e-9);
}

TEST(PathCheck, TrueClaimsAreClean) {
  Story story{0.5};
  for (int i = 0; i < 600; ++i) EXPECT_FALSE(story.Step({15.0, 0.0}, 15.0)) << i;
}

TEST(PathCheck, NothingIsSaidWithinASecondOrTenMetres) {
  Story fast;
  for (int i = 0; i < 9; ++i) EXPECT_FALSE(fast.Step({30.0, 0.0}, 0.0)) << i;
  Story slow;
  for (int i = 0; i < 48; ++i) EXPECT_FALSE(slow.Step({1.9, 0.0}, 0.0)) << i;
}

TEST(PathCheck, ASenderThatMovesButSaysItStandsIsFoundAndInTheEndAccused) {
  Story story;
  int first = 0;
  int accused = 0;
  for (int i = 1; i <= 150; ++i) {
    const auto finding = story.Step({10.5, 0.0}, 0.0);
    if (!finding) continue;
    EXPECT_EQ(finding->check, Check::kSpeedAgainstPath);
    EXPECT_NEAR(finding->value, 10.5, 0.01);
    EXPECT_GT(finding->value, finding->limit);
    if (first == 0) first = i;
    if (accused == 0 && finding->severity == Verdict::kAccuse) accused = i;
  }
  EXPECT_NEAR(first, 10, 1);
  EXPECT_NEAR(accused, first + 50, 2);
}

TEST(PathCheck, ASenderThatStandsButSaysItMovesIsFound) {
  Story story;
  int found = 0;
  for (int i = 0; i < 30; ++i) found += story.Step({0.0, 0.0}, 10.0) ? 1 : 0;
  EXPECT_GE(found, 19);
}

TEST(PathCheck, TwoMetresPerSecondTooFastAreFound) {
  for (const double speed_mps : {5.0, 12.0, 20.0}) {
    Story story{0.3};
    int found = 0;
    for (int i = 0; i < 100; ++i) {
      found += story.Step({speed_mps, 0.0}, speed_mps + 2.0) && i >= 50 ? 1 : 0;
    }
    EXPECT_GE(found, 45) << speed_mps;
  }
}

TEST(PathCheck, ATurnedCourseIsFound) {
  Story story;
  std::optional<Finding> last;
  for (int i = 0; i < 100; ++i) last = story.Step({10.0, 0.0}, 10.0, FromDegrees(150.0));
  ASSERT_TRUE(last);
  EXPECT_EQ(last->check, Check::kCourseAgainstPath);
  EXPECT_NEAR(last->value, FromDegrees(150.0), 1e-3);
  EXPECT_EQ(last->severity, Verdict::kAccuse);
}

// An honest unit that tells the way its body looks and not its gear.
TEST(PathCheck, BackingUpWithoutAGearIsNotAccused) {
  Story story;
  std::optional<Finding> last;
  for (int i = 0; i < 150; ++i) last = story.Step({-4.0, 0.0}, 4.0);
  ASSERT_TRUE(last);
  EXPECT_EQ(last->severity, Verdict::kWithdraw);
}

TEST(PathCheck, AStepOfThePositionIsNoSpeed) {
  for (const double step_m : {3.0, 8.0}) {
    Story story{0.2};
    for (int i = 0; i < 150; ++i) {
      const Eigen::Vector2d shift(i == 70 ? step_m : 0.0, 0.0);
      EXPECT_FALSE(story.Step({10.0, 0.0}, 10.0, 0.0, 0.1, shift)) << step_m << " at " << i;
    }
  }
}

TEST(PathCheck, ASilenceStartsAnew) {
  Story story;
  for (int i = 0; i < 20; ++i) (void)story.Step({10.0, 0.0}, 0.0);
  EXPECT_FALSE(story.Step({10.0, 0.0}, 0.0, 0.0, 3.0));
  EXPECT_FALSE(story.Step({10.0, 0.0}, 0.0));
}

}  // namespace
}  // namespace v2vouch
