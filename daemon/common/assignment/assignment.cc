// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/assignment/assignment.h"

#include <cmath>
#include <utility>

#include "daemon/common/base/check.h"

namespace v2vouch {

std::span<const int> AssignmentSolver::Solve(std::span<const double> cost, std::size_t rows,
                                             std::size_t columns,
                                             std::span<const double> lone_row) {
  V2VOUCH_CHECK(cost.size() == rows * columns);
  V2VOUCH_CHECK(lone_row.size() == rows);
  row_price_.assign(rows, 0.0);
  column_price_.assign(columns, 0.0);
  row_of_column_.assign(columns, -1);
  shortest_.resize(columns);
  previous_row_.resize(columns);
  is_visited_.resize(columns);
  result_.assign(rows, -1);
  for (std::size_t row = 0; row < rows; ++row) {
    V2VOUCH_CHECK(std::isfinite(lone_row[row]));
    Insert(static_cast<int>(row), cost, columns, lone_row);
  }
  return result_;
}

// Finds the cheapest way to give `row` a place: Dijkstra over reduced costs, which the prices keep
// non-negative on every edge but those of `row` itself; they all leave the start and share its
// unset price, so their order is right too. Every row on the way also has an exit: to stay alone
// at its lone price. A row once alone is never reached again, so exits need no price of their own.
void AssignmentSolver::Insert(int row, std::span<const double> cost, std::size_t columns,
                              std::span<const double> lone_row) {
  const Path path = ShortestPath(row, cost, columns, lone_row);
  const double length = path.length;
  row_price_[static_cast<std::size_t>(row)] += length;
  for (const int column : visited_) {
    const auto j = static_cast<std::size_t>(column);
    const double rise = length - shortest_[j];
    row_price_[static_cast<std::size_t>(row_of_column_[j])] += rise;
    column_price_[j] -= rise;
  }

  // Walk the path back, each row passing its old column on to the row before it.
  int column = path.free_column;
  if (column < 0) {
    column = result_[static_cast<std::size_t>(path.exit_row)];
    result_[static_cast<std::size_t>(path.exit_row)] = -1;
    if (path.exit_row == row) return;
  }
  while (true) {
    const auto j = static_cast<std::size_t>(column);
    const int taker = previous_row_[j];
    row_of_column_[j] = taker;
    std::swap(column, result_[static_cast<std::size_t>(taker)]);
    if (taker == row) return;
  }
}

AssignmentSolver::Path AssignmentSolver::ShortestPath(int row, std::span<const double> cost,
                                                      std::size_t columns,
                                                      std::span<const double> lone_row) {
  shortest_.assign(columns, kForbidden);
  is_visited_.assign(columns, 0);
  visited_.clear();

  double length = 0.0;  // Of the path to the row being scanned.
  double exit_length = kForbidden;
  int exit_row = -1;
  int scanned = row;
  while (true) {
    const auto r = static_cast<std::size_t>(scanned);
    const double to_exit = length + lone_row[r] - row_price_[r];
    if (to_exit < exit_length) {
      exit_length = to_exit;
      exit_row = scanned;
    }
    int nearest = -1;
    double nearest_length = exit_length;  // A column must beat the exit, not equal it.
    for (std::size_t j = 0; j < columns; ++j) {
      if (is_visited_[j]) continue;
      const double c = cost[r * columns + j];
      // Not finite means forbidden: such a pair does not exist, and its value is never used.
      if (c < lone_row[r] && c > -kForbidden) {
        const double to_column = length + c - row_price_[r] - column_price_[j];
        if (to_column < shortest_[j]) {
          shortest_[j] = to_column;
          previous_row_[j] = scanned;
        }
      }
      if (shortest_[j] < nearest_length) {
        nearest_length = shortest_[j];
        nearest = static_cast<int>(j);
      }
    }
    if (nearest < 0) return {.length = exit_length, .exit_row = exit_row};
    length = nearest_length;
    const auto n = static_cast<std::size_t>(nearest);
    if (row_of_column_[n] < 0) return {.length = length, .free_column = nearest};
    is_visited_[n] = 1;
    visited_.push_back(nearest);
    scanned = row_of_column_[n];
  }
}

}  // namespace v2vouch
