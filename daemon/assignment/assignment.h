// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace v2vouch {

/// A pair that must not be made.
inline constexpr double kForbidden = std::numeric_limits<double>::infinity();

/// Rectangular assignment of minimum total cost in which a row or a column may stay alone.
///
///     min  sum over pairs cost(i, j)  +  sum over lone rows lone_row[i]
///
/// Lone columns cost nothing; a pair is made only where it is cheaper than leaving its row alone
/// and it is not kForbidden. Exact (shortest augmenting path, Jonker and Volgenant 1987,
/// re-derived); real costs, negative ones included. Ties go to the lower row, then column.
/// Buffers are kept between calls: no allocation once they have grown.
class AssignmentSolver {
 public:
  /// @param cost row-major rows x columns.
  /// @return per row its column, or -1. Valid until the next call.
  std::span<const int> Solve(std::span<const double> cost, std::size_t rows, std::size_t columns,
                             std::span<const double> lone_row);

 private:
  std::vector<double> padded_, row_price_, column_price_, shortest_;
  std::vector<int> row_of_column_, column_of_row_, previous_, result_;
  std::vector<char> visited_;
};

/// One allowed pair.
struct SparsePair {
  int row = 0;
  int column = 0;
  double cost = 0.0;
};

/// The same problem given by its allowed pairs only: split into connected clusters, each solved
/// exactly. Fits gated tracking problems, where clusters are small.
class ClusteredAssignmentSolver {
 public:
  std::span<const int> Solve(std::span<const SparsePair> pairs, std::size_t rows,
                             std::size_t columns, std::span<const double> lone_row);

 private:
  AssignmentSolver dense_;
  std::vector<int> parent_, result_, order_, local_rows_, local_columns_, column_index_;
  std::vector<double> cost_, lone_;
};

}  // namespace v2vouch
