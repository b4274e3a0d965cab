// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "daemon/common/assignment/assignment.h"
#include "daemon/common/base/check.h"

namespace v2vouch {

int ClusteredAssignmentSolver::Root(int node) {
  while (parent_[static_cast<std::size_t>(node)] != node) {
    int& parent = parent_[static_cast<std::size_t>(node)];
    parent = parent_[static_cast<std::size_t>(parent)];  // Path halving.
    node = parent;
  }
  return node;
}

std::span<const int> ClusteredAssignmentSolver::Solve(std::span<const SparsePair> pairs,
                                                      std::size_t rows, std::size_t columns,
                                                      std::span<const double> lone_row) {
  V2VOUCH_CHECK(lone_row.size() == rows);
  result_.assign(rows, -1);
  SortByCluster(pairs, rows, columns, lone_row);
  local_index_.resize(columns);
  for (std::size_t begin = 0, end = 0; begin < sorted_.size(); begin = end) {
    const int root = Root(sorted_[begin].row);
    for (end = begin; end < sorted_.size() && Root(sorted_[end].row) == root;) ++end;
    SolveCluster(begin, end, lone_row);
  }
  return result_;
}

// Leaves the pairs that can be made in `sorted_`, cluster after cluster.
void ClusteredAssignmentSolver::SortByCluster(std::span<const SparsePair> pairs, std::size_t rows,
                                              std::size_t columns,
                                              std::span<const double> lone_row) {
  // Rows are nodes 0 .. rows-1, columns follow. The lower root wins, so that a cluster's root is
  // its lowest row.
  parent_.resize(rows + columns);
  for (std::size_t node = 0; node < parent_.size(); ++node) parent_[node] = static_cast<int>(node);
  sorted_.clear();
  for (const SparsePair& pair : pairs) {
    V2VOUCH_CHECK(pair.row >= 0 && static_cast<std::size_t>(pair.row) < rows);
    V2VOUCH_CHECK(pair.column >= 0 && static_cast<std::size_t>(pair.column) < columns);
    // A pair no cheaper than leaving its row alone is never made: it must not join clusters.
    if (!(pair.cost < lone_row[static_cast<std::size_t>(pair.row)])) continue;
    if (!(pair.cost > -kForbidden)) continue;
    sorted_.push_back(pair);
    const int a = Root(pair.row);
    const int b = Root(static_cast<int>(rows) + pair.column);
    parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  std::sort(sorted_.begin(), sorted_.end(), [&](const SparsePair& a, const SparsePair& b) {
    const int root_a = Root(a.row);
    const int root_b = Root(b.row);
    if (root_a != root_b) return root_a < root_b;
    if (a.row != b.row) return a.row < b.row;
    return a.column != b.column ? a.column < b.column : a.cost < b.cost;
  });
}

// Gives the rows of sorted_[begin, end), one cluster, their columns.
void ClusteredAssignmentSolver::SolveCluster(std::size_t begin, std::size_t end,
                                             std::span<const double> lone_row) {
  cluster_rows_.clear();
  cluster_columns_.clear();
  for (std::size_t k = begin; k < end; ++k) {
    const SparsePair& pair = sorted_[k];
    if (cluster_rows_.empty() || cluster_rows_.back() != pair.row) {
      cluster_rows_.push_back(pair.row);
    }
    cluster_columns_.push_back(pair.column);
  }
  std::sort(cluster_columns_.begin(), cluster_columns_.end());
  cluster_columns_.erase(std::unique(cluster_columns_.begin(), cluster_columns_.end()),
                         cluster_columns_.end());
  for (std::size_t j = 0; j < cluster_columns_.size(); ++j) {
    local_index_[static_cast<std::size_t>(cluster_columns_[j])] = static_cast<int>(j);
  }

  const std::size_t width = cluster_columns_.size();
  cost_.assign(cluster_rows_.size() * width, kForbidden);
  lone_.clear();
  std::size_t next = begin;
  for (std::size_t i = 0; i < cluster_rows_.size(); ++i) {
    lone_.push_back(lone_row[static_cast<std::size_t>(cluster_rows_[i])]);
    for (; next < end && sorted_[next].row == cluster_rows_[i]; ++next) {
      const auto j =
          static_cast<std::size_t>(local_index_[static_cast<std::size_t>(sorted_[next].column)]);
      cost_[i * width + j] = std::min(cost_[i * width + j], sorted_[next].cost);
    }
  }
  const auto local = dense_.Solve(cost_, cluster_rows_.size(), width, lone_);
  for (std::size_t i = 0; i < cluster_rows_.size(); ++i) {
    if (local[i] < 0) continue;
    result_[static_cast<std::size_t>(cluster_rows_[i])] =
        cluster_columns_[static_cast<std::size_t>(local[i])];
  }
}

}  // namespace v2vouch
