// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/association/paper.h"

#include <gmock/gmock.h>

#include <Eigen/LU>

#include "daemon/common/base/random.h"

namespace v2vouch {
namespace {

using Eigen::Vector3d;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(AssociatePaper, PairsWithinEpsilonByMahalanobisDistance) {
  const std::vector<Vector3d> sensor = {{0, 0, 0}, {50, 0, 0}};
  const std::vector<Vector3d> v2v = {{3, 0, 0}, {50, 4, 0}};
  // C = diag(1, 4, 1): 3 m along x is D = 3, 4 m along y is D = 2.
  const Eigen::Matrix3d C = Vector3d(1, 4, 1).asDiagonal();
  EXPECT_THAT(AssociatePaper(sensor, v2v, C, 2.5), ElementsAre(PaperPair{1, 1, 2.0}));
  EXPECT_THAT(AssociatePaper(sensor, v2v, C, 3.0),
              ElementsAre(PaperPair{0, 0, 3.0}, PaperPair{1, 1, 2.0}));
}

TEST(AssociatePaper, AgreesWithTheFormulaForAnyCovariance) {
  Random random(17);
  for (int trial = 0; trial < 200; ++trial) {
    Eigen::Matrix3d A;
    for (double& a : A.reshaped()) a = random.Normal();
    const Eigen::Matrix3d C = A * A.transpose() + 0.1 * Eigen::Matrix3d::Identity();
    const Vector3d s(random.Normal(), random.Normal(), random.Normal());
    const Vector3d v(random.Normal(), random.Normal(), random.Normal());
    const double D = std::sqrt((v - s).dot(C.inverse() * (v - s)));
    const std::vector<Vector3d> S = {s}, V = {v};
    const auto inside = AssociatePaper(S, V, C, D + 1e-9);
    ASSERT_EQ(inside.size(), 1u);
    EXPECT_NEAR(inside[0].distance, D, 1e-9);
    EXPECT_THAT(AssociatePaper(S, V, C, D - 1e-6), IsEmpty());
  }
}

TEST(AssociatePaper, HasNoOneToOneRule) {
  // What the paper prints: one car, two senders beside it: both are taken, the liar included.
  const std::vector<Vector3d> sensor = {{0, 0, 0}, {1, 0, 0}};
  const std::vector<Vector3d> v2v = {{0.2, 0, 0}, {0.8, 0, 0}};
  EXPECT_EQ(AssociatePaper(sensor, v2v, Eigen::Matrix3d::Identity(), 3.0).size(), 4u);
}

TEST(AssociatePaper, CovarianceThatIsNoneGivesNoPair) {
  const std::vector<Vector3d> one = {{0, 0, 0}};
  EXPECT_THAT(AssociatePaper(one, one, -Eigen::Matrix3d::Identity(), 3.0), IsEmpty());
  EXPECT_THAT(AssociatePaper({}, one, Eigen::Matrix3d::Identity(), 3.0), IsEmpty());
}

}  // namespace
}  // namespace v2vouch
