// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/association/paper.h"

#include <Eigen/Cholesky>

namespace v2vouch {

std::vector<PaperPair> AssociatePaper(std::span<const Eigen::Vector3d> sensor,
                                      std::span<const Eigen::Vector3d> v2v,
                                      const Eigen::Matrix3d& C, double epsilon) {
  std::vector<PaperPair> A;
  const Eigen::LLT<Eigen::Matrix3d> factor(C);
  if (factor.info() != Eigen::Success) return A;
  for (std::size_t s = 0; s < sensor.size(); ++s) {                        // 1: for all s in S do
    for (std::size_t v = 0; v < v2v.size(); ++v) {                         // 2:   for all v in V do
      const double D = factor.matrixL().solve(v2v[v] - sensor[s]).norm();  // 3: distance
      if (D <= epsilon) A.push_back({s, v, D});  // 4:     if D <= epsilon add (s, v)
    }
  }
  return A;  // 5: return A
}

}  // namespace v2vouch
