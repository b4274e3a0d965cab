// SPDX-License-Identifier: Apache-2.0
#include "sim/world/path.h"

#include <gtest/gtest.h>

#include <cmath>

namespace v2vouch::sim {
namespace {

Path Make(const std::vector<Waypoint>& waypoints) {
  Path path;
  std::string problem;
  EXPECT_TRUE(Path::Make(waypoints, path, problem)) << problem;
  return path;
}

TEST(Path, CurveEndsOnTheNextStraight) {
  const Path path = Make({{{0, 0}, 10}, {{50, 0}, 8}, {{50, 60}, 10}});
  const PathPoint end = path.At(path.length_m());
  EXPECT_NEAR(end.position.x(), 50.0, 0.01);
  EXPECT_NEAR(end.position.y(), 60.0, 0.06);  // The last step of the table may be cut.
  EXPECT_NEAR(end.yaw_rad, kPi / 2, 1e-4);
}

TEST(Path, CurvatureIsContinuousAndStaysWithinTheRadius) {
  const Path path = Make({{{0, 0}, 10}, {{60, 0}, 8}, {{20, 50}, 10}});
  double before = 0.0;
  double highest = 0.0;
  for (double s = 0.0; s < path.length_m(); s += 0.1) {
    const double curvature = path.At(s).curvature_per_m;
    EXPECT_LT(std::abs(curvature - before), 0.01) << "s = " << s;
    highest = std::max(highest, std::abs(curvature));
    before = curvature;
  }
  EXPECT_NEAR(highest, 1.0 / 8.0, 1e-3);
}

TEST(Path, DirectionIsThatOfTheLine) {
  const Path path = Make({{{0, 0}, 10}, {{40, 0}, 9}, {{70, 30}, 10}});
  for (double s = 1.0; s < path.length_m() - 1.0; s += 0.37) {
    const Vec2 step = path.At(s + 0.05).position - path.At(s - 0.05).position;
    EXPECT_NEAR(AngleDifference(std::atan2(step.y(), step.x()), path.At(s).yaw_rad), 0.0, 2e-3);
    EXPECT_NEAR(step.norm(), 0.1, 1e-4);
  }
}

TEST(Path, RunsOnStraightBeyondItsEnds) {
  const Path path = Make({{{0, 0}, 10}, {{10, 0}, 10}});
  EXPECT_NEAR(path.At(-5).position.x(), -5.0, 1e-9);
  EXPECT_NEAR(path.At(15).position.x(), 15.0, 1e-9);
}

TEST(Path, RefusesCornersThatDoNotFit) {
  Path path;
  std::string problem;
  EXPECT_FALSE(Path::Make({{{0, 0}, 10}, {{5, 0}, 20}, {{5, 5}, 10}}, path, problem));
  EXPECT_NE(problem.find("radius_m"), std::string::npos) << problem;
  EXPECT_FALSE(Path::Make({{{0, 0}, 10}}, path, problem));
  EXPECT_FALSE(Path::Make({{{0, 0}, 10}, {{50, 0}, 5}, {{0, 0.1}, 10}}, path, problem));
}

}  // namespace
}  // namespace v2vouch::sim
