// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "daemon/local/tracking/chi_square.h"
#include "daemon/local/tracking/existence.h"

namespace v2vouch {
namespace {

TEST(ChiSquareQuantile, MatchesTables) {
  // Any table of the chi-square distribution.
  EXPECT_NEAR(ChiSquareQuantile(0.95, 1), 3.841, 1e-3);
  EXPECT_NEAR(ChiSquareQuantile(0.95, 2), 5.991, 1e-3);
  EXPECT_NEAR(ChiSquareQuantile(0.95, 3), 7.815, 1e-3);
  EXPECT_NEAR(ChiSquareQuantile(0.99, 4), 13.277, 1e-3);
  EXPECT_NEAR(ChiSquareQuantile(0.99, 5), 15.086, 1e-3);
  EXPECT_NEAR(ChiSquareQuantile(0.9999, 2), 18.421, 1e-3);
  EXPECT_NEAR(ChiSquareQuantile(0.9999, 3), 21.108, 1e-3);
}

TEST(ExistenceAfterMiss, FollowsTheWorkedExample) {
  // 0.99 falls to 0.83, 0.20, 0.012 after one, two, three misses at 0.95.
  double r = 0.99;
  for (const double expected : {0.83, 0.20, 0.012}) {
    r = ExistenceAfterMiss(r, 0.95);
    EXPECT_NEAR(r, expected, 0.005);
  }
  // A hidden vehicle keeps most of it through 80 looks.
  r = 0.99;
  for (int i = 0; i < 80; ++i) r = ExistenceAfterMiss(r, 0.02);
  EXPECT_GT(r, 0.94);
  EXPECT_EQ(ExistenceAfterMiss(0.7, 0.0), 0.7);
}

TEST(AssociationMarginals, OnePairIsBayesRule) {
  AssociationMarginals marginals;
  const std::vector<GatedPair> pairs = {{0, 0, 3.0}};
  const std::vector<double> missed = {0.5};
  const std::vector<int> assigned = {0};
  marginals.Compute(pairs, missed, assigned, 1);
  EXPECT_NEAR(marginals.detected()[0], 3.0 / 3.5, 1e-12);
  EXPECT_NEAR(marginals.explained()[0], 3.0 / 3.5, 1e-12);
}

TEST(AssociationMarginals, TwoTracksShareOneMeasurement) {
  AssociationMarginals marginals;
  const std::vector<GatedPair> pairs = {{0, 0, 6.0}, {1, 0, 2.0}};
  const std::vector<double> missed = {0.5, 0.25};
  const std::vector<int> assigned = {0, -1};
  marginals.Compute(pairs, missed, assigned, 1);
  // By hand: nobody 0.125, first 6 x 0.25 = 1.5, second 2 x 0.5 = 1.
  const double total = 0.125 + 1.5 + 1.0;
  EXPECT_NEAR(marginals.detected()[0], 1.5 / total, 1e-12);
  EXPECT_NEAR(marginals.detected()[1], 1.0 / total, 1e-12);
  EXPECT_NEAR(marginals.explained()[0], 2.5 / total, 1e-12);
}

TEST(AssociationMarginals, ClustersDoNotInfluenceEachOther) {
  AssociationMarginals marginals;
  const std::vector<GatedPair> pairs = {{0, 1, 4.0}, {1, 0, 9.0}, {2, 2, 1.0}, {2, 0, 5.0}};
  const std::vector<double> missed = {0.1, 0.2, 0.3};
  const std::vector<int> assigned = {1, 0, 2};
  marginals.Compute(pairs, missed, assigned, 3);
  EXPECT_NEAR(marginals.detected()[0], 4.0 / 4.1, 1e-12);
  // Tracks 1 and 2 over measurements 0 and 2.
  const double total = 0.2 * 0.3 + 9.0 * 0.3 + 9.0 * 1.0 + 0.2 * 1.0 + 0.2 * 5.0;
  EXPECT_NEAR(marginals.detected()[1], (9.0 * 0.3 + 9.0) / total, 1e-12);
  EXPECT_NEAR(marginals.explained()[2], (9.0 + 0.2) / total, 1e-12);
}

TEST(AssociationMarginals, LargeClustersFallBackOnTheBestAssignment) {
  AssociationMarginals marginals;
  std::vector<GatedPair> pairs;
  std::vector<double> missed(6, 0.1);
  std::vector<int> assigned;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) pairs.push_back({i, j, i == j ? 50.0 : 0.1});
    assigned.push_back(i);
  }
  marginals.Compute(pairs, missed, assigned, 6);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(marginals.detected()[i], 50.0 / 50.1, 1e-12);
}

}  // namespace
}  // namespace v2vouch
