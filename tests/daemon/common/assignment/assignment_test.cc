// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/assignment/assignment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "daemon/common/base/random.h"

namespace v2vouch {
namespace {

using testing::ElementsAre;

struct Problem {
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::vector<double> cost;
  std::vector<double> lone;

  double At(std::size_t i, std::size_t j) const { return cost[i * columns + j]; }
  std::vector<SparsePair> Pairs() const {
    std::vector<SparsePair> pairs;
    for (std::size_t i = 0; i < rows; ++i) {
      for (std::size_t j = 0; j < columns; ++j) {
        if (At(i, j) < kForbidden) {
          pairs.push_back({static_cast<int>(i), static_cast<int>(j), At(i, j)});
        }
      }
    }
    return pairs;
  }
};

// Total cost of an answer; also that it is one-to-one and makes no forbidden pair.
double Price(const Problem& problem, std::span<const int> column_of_row) {
  EXPECT_EQ(column_of_row.size(), problem.rows);
  std::vector<int> uses(problem.columns, 0);
  double total = 0.0;
  for (std::size_t i = 0; i < problem.rows; ++i) {
    if (column_of_row[i] < 0) {
      total += problem.lone[i];
      continue;
    }
    const auto j = static_cast<std::size_t>(column_of_row[i]);
    EXPECT_LT(j, problem.columns);
    EXPECT_EQ(++uses[j], 1);
    total += problem.At(i, j);
  }
  return total;
}

// Tries every partial matching.
double BruteForce(const Problem& problem, std::size_t row = 0, unsigned used = 0) {
  if (row == problem.rows) return 0.0;
  double best = problem.lone[row] + BruteForce(problem, row + 1, used);
  for (std::size_t j = 0; j < problem.columns; ++j) {
    if ((used >> j) & 1U || !(problem.At(row, j) < kForbidden)) continue;
    best = std::min(best, problem.At(row, j) + BruteForce(problem, row + 1, used | (1U << j)));
  }
  return best;
}

enum class Costs { kReal, kSmallIntegers };

Problem RandomProblem(Random& random, std::size_t most, Costs costs) {
  const auto draw = [&](double low, double high) {
    const double value = random.Uniform(low, high);
    return costs == Costs::kReal ? value : std::floor(value / 3.0);
  };
  Problem problem;
  problem.rows = static_cast<std::size_t>(random.Uniform(0.0, static_cast<double>(most + 1)));
  problem.columns = static_cast<std::size_t>(random.Uniform(0.0, static_cast<double>(most + 1)));
  const double forbidden = random.Uniform();
  for (std::size_t i = 0; i < problem.rows; ++i) {
    problem.lone.push_back(draw(-5.0, 10.0));
    for (std::size_t j = 0; j < problem.columns; ++j) {
      problem.cost.push_back(random.Bernoulli(forbidden) ? kForbidden : draw(-10.0, 10.0));
    }
  }
  return problem;
}

TEST(AssignmentSolver, LeavesARowAloneWhereThatIsCheaper) {
  AssignmentSolver solver;
  const std::vector<double> cost = {3.0, 7.0};
  EXPECT_THAT(solver.Solve(cost, 1, 2, std::vector{5.0}), ElementsAre(0));
  EXPECT_THAT(solver.Solve(cost, 1, 2, std::vector{2.0}), ElementsAre(-1));
  // Equal is not cheaper.
  EXPECT_THAT(solver.Solve(cost, 1, 2, std::vector{3.0}), ElementsAre(-1));
}

TEST(AssignmentSolver, AcceptsEmptyProblems) {
  AssignmentSolver solver;
  EXPECT_TRUE(solver.Solve({}, 0, 0, {}).empty());
  EXPECT_TRUE(solver.Solve({}, 0, 3, {}).empty());
  EXPECT_THAT(solver.Solve({}, 2, 0, std::vector{1.0, -1.0}), ElementsAre(-1, -1));
}

TEST(AssignmentSolver, PairsWhoseCostIsNotFiniteAreNeverMade) {
  AssignmentSolver dense;
  ClusteredAssignmentSolver clustered;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> cost = {kForbidden, nan, -kForbidden, 1.0};
  EXPECT_THAT(dense.Solve(cost, 1, 4, std::vector{100.0}), ElementsAre(3));
  EXPECT_THAT(dense.Solve(std::span(cost).first(3), 1, 3, std::vector{100.0}), ElementsAre(-1));
  std::vector<SparsePair> pairs;
  for (int j = 0; j < 4; ++j) pairs.push_back({0, j, cost[static_cast<std::size_t>(j)]});
  EXPECT_THAT(clustered.Solve(pairs, 1, 4, std::vector{100.0}), ElementsAre(3));
}

TEST(AssignmentSolver, GreedyChoiceIsUndoneWhenALaterRowNeedsIt) {
  AssignmentSolver solver;
  // Nearest-first would pair (0, 0) for 1 and leave 9 for the other: 10 instead of 4.
  const std::vector<double> cost = {1.0, 2.0, 2.0, 9.0};
  EXPECT_THAT(solver.Solve(cost, 2, 2, std::vector{50.0, 50.0}), ElementsAre(1, 0));
}

TEST(AssignmentSolver, TiesGoToTheEarlierRowAndTheLowerColumn) {
  AssignmentSolver solver;
  EXPECT_THAT(solver.Solve(std::vector{1.0, 1.0, 1.0}, 3, 1, std::vector{5.0, 5.0, 5.0}),
              ElementsAre(0, -1, -1));
  EXPECT_THAT(solver.Solve(std::vector{1.0, 1.0, 1.0}, 1, 3, std::vector{5.0}), ElementsAre(0));
  EXPECT_THAT(solver.Solve(std::vector(9, 1.0), 3, 3, std::vector(3, 5.0)), ElementsAre(0, 1, 2));
}

// A published tracker fills gated-out pairs with a huge number and scales all costs by it, so that
// one unrelated gated-out pair makes it return the crossed-over, worse matching.
TEST(AssignmentSolver, AGatedOutPairDoesNotSpoilTheOthers) {
  AssignmentSolver dense;
  ClusteredAssignmentSolver clustered;
  Problem problem{3, 3, std::vector<double>(9, kForbidden), std::vector<double>(3, 10.0)};
  problem.cost[0 * 3 + 0] = 0.9;  // straight
  problem.cost[1 * 3 + 1] = 0.9;
  problem.cost[0 * 3 + 1] = 0.1;  // crossed: the optimum
  problem.cost[1 * 3 + 0] = 0.1;
  problem.cost[2 * 3 + 2] = 0.5;  // unrelated pair; all others are gated out
  EXPECT_THAT(dense.Solve(problem.cost, 3, 3, problem.lone), ElementsAre(1, 0, 2));
  EXPECT_THAT(clustered.Solve(problem.Pairs(), 3, 3, problem.lone), ElementsAre(1, 0, 2));
  // Nor does a real cost that is merely huge.
  problem.cost[2 * 3 + 2] = 1e300;
  problem.lone[2] = 1.5e300;
  EXPECT_THAT(dense.Solve(problem.cost, 3, 3, problem.lone), ElementsAre(1, 0, 2));
}

TEST(AssignmentSolverProperty, AgreesWithBruteForce) {
  Random random(20240611);
  AssignmentSolver dense;  // Kept, so that left-overs of earlier problems would show.
  ClusteredAssignmentSolver clustered;
  int paired = 0;
  int alone = 0;
  for (int trial = 0; trial < 6000; ++trial) {
    const auto costs = trial % 2 == 0 ? Costs::kReal : Costs::kSmallIntegers;
    const Problem problem = RandomProblem(random, 6, costs);
    const double best = BruteForce(problem);
    const auto result = dense.Solve(problem.cost, problem.rows, problem.columns, problem.lone);
    ASSERT_NEAR(Price(problem, result), best, 1e-9) << "trial " << trial;
    for (std::size_t i = 0; i < problem.rows; ++i) {
      ++(result[i] < 0 ? alone : paired);
      if (result[i] >= 0) {
        ASSERT_LT(problem.At(i, static_cast<std::size_t>(result[i])), problem.lone[i]);
      }
    }
    const auto sparse =
        clustered.Solve(problem.Pairs(), problem.rows, problem.columns, problem.lone);
    ASSERT_NEAR(Price(problem, sparse), best, 1e-9) << "trial " << trial;
  }
  EXPECT_GT(paired, 5000);  // The cases did exercise both outcomes.
  EXPECT_GT(alone, 5000);
}

// On larger problems brute force is out of reach; dense and clustered answers, reached by
// different orders of work, must still cost the same, and agree where costs are real (no ties).
TEST(AssignmentSolverProperty, ClusteredEqualsDense) {
  Random random(7);
  AssignmentSolver dense;
  ClusteredAssignmentSolver clustered;
  for (int trial = 0; trial < 200; ++trial) {
    const Problem problem = RandomProblem(random, 40, Costs::kReal);
    const auto a = dense.Solve(problem.cost, problem.rows, problem.columns, problem.lone);
    auto pairs = problem.Pairs();
    std::reverse(pairs.begin(), pairs.end());  // The order of pairs says nothing.
    const auto b = clustered.Solve(pairs, problem.rows, problem.columns, problem.lone);
    ASSERT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end())) << "trial " << trial;
  }
}

TEST(ClusteredAssignmentSolver, OfAPairNamedTwiceTheCheaperCounts) {
  ClusteredAssignmentSolver solver;
  const std::vector<SparsePair> pairs = {{0, 0, 4.0}, {0, 1, 2.0}, {0, 0, 1.0}};
  EXPECT_THAT(solver.Solve(pairs, 1, 2, std::vector{9.0}), ElementsAre(0));
}

// A large gated scene: every row sees its own column and a few neighbours. The optimum is known:
// each row's own column is its cheapest and all are different.
TEST(ClusteredAssignmentSolver, SolvesALargeSparseScene) {
  Random random(3);
  const int count = 20000;
  std::vector<SparsePair> pairs;
  for (int i = 0; i < count; ++i) {
    pairs.push_back({i, (i * 7919) % count, random.Uniform(0.0, 1.0)});
    if (i % 4 != 3) pairs.push_back({i, ((i + 1) * 7919) % count, random.Uniform(1.0, 5.0)});
  }
  ClusteredAssignmentSolver solver;
  const std::vector<double> lone(static_cast<std::size_t>(count), 10.0);
  const auto result = solver.Solve(pairs, lone.size(), lone.size(), lone);
  for (int i = 0; i < count; ++i) {
    ASSERT_EQ(result[static_cast<std::size_t>(i)], (i * 7919) % count);
  }
}

}  // namespace
}  // namespace v2vouch
