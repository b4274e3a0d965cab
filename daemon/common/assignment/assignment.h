// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace v2vouch {

/// A pair that must not be made. Any other cost that is not finite forbids the pair too.
inline constexpr double kForbidden = std::numeric_limits<double>::infinity();

/// Rectangular assignment of minimum total cost in which a row or a column may stay alone.
///
///     min  sum over pairs cost(i, j)  +  sum over lone rows lone_row[i]
///
/// Lone columns cost nothing; a pair is made only where it is cheaper than leaving its row alone
/// and it is not kForbidden. Exact for real costs, negative ones included; forbidden pairs never
/// enter the arithmetic, so they cannot spoil the others. Method: shortest augmenting paths with
/// row and column prices (Jonker and Volgenant 1987, re-derived), O(rows^2 x columns) at worst.
///
/// Ties: rows enter in order, a row takes the lowest of equally good columns, and a later row
/// displaces an earlier one only where that is cheaper. Same input, same answer.
/// Buffers are kept between calls: no allocation once they have grown.
class AssignmentSolver {
 public:
  /// @param cost row-major rows x columns.
  /// @param lone_row one price per row, finite.
  /// @return per row its column, or -1. Valid until the next call.
  std::span<const int> Solve(std::span<const double> cost, std::size_t rows, std::size_t columns,
                             std::span<const double> lone_row);

 private:
  /// Ends in a free column, or where there is none in the exit of a row.
  struct Path {
    double length = 0.0;
    int free_column = -1;
    int exit_row = -1;
  };
  void Insert(int row, std::span<const double> cost, std::size_t columns,
              std::span<const double> lone_row);
  Path ShortestPath(int row, std::span<const double> cost, std::size_t columns,
                    std::span<const double> lone_row);

  std::vector<double> row_price_, column_price_, shortest_;
  std::vector<int> row_of_column_, previous_row_, visited_, result_;
  std::vector<char> is_visited_;
};

/// One allowed pair.
struct SparsePair {
  int row = 0;
  int column = 0;
  double cost = 0.0;
};

/// The same problem given by its allowed pairs only: split into connected clusters, each solved
/// exactly. Fits gated tracking problems, where clusters are small. Of a pair named twice the
/// cheaper counts. Memory follows the largest cluster (its rows x columns).
class ClusteredAssignmentSolver {
 public:
  /// @return per row its column, or -1. Valid until the next call.
  std::span<const int> Solve(std::span<const SparsePair> pairs, std::size_t rows,
                             std::size_t columns, std::span<const double> lone_row);

 private:
  int Root(int node);
  void SortByCluster(std::span<const SparsePair> pairs, std::size_t rows, std::size_t columns,
                     std::span<const double> lone_row);
  void SolveCluster(std::size_t begin, std::size_t end, std::span<const double> lone_row);

  AssignmentSolver dense_;
  std::vector<SparsePair> sorted_;
  std::vector<int> parent_, result_, cluster_rows_, cluster_columns_, local_index_;
  std::vector<double> cost_, lone_;
};

}  // namespace v2vouch
