// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "daemon/v2v/gps_bias/remote_solution.h"

/// The least-squares terms of remote_solution.h, for Ceres.
namespace v2vouch::remote {

/// The pairs of one second, as one.
struct Block {
  double time_s = 0.0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();
  Eigen::Vector2d heading = Eigen::Vector2d::Zero();
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< From the ego.
  int pairs = 0;
};

std::vector<Block> Blocks(const std::vector<RemotePair>& pairs, double white_hz);

/// b 0..1, tau 2, c 3, slope 4..5 of the constant part; the turn and knots beside it.
inline constexpr int kConstant = 6;

struct BlockCost {
  Block block;
  Eigen::Matrix2d whiten;
  double share;     ///< Between the two knots.
  double middle_s;  ///< The slope turns round it.
  template <class T>
  bool operator()(const T* x, const T* turn, const T* from, const T* to, T* out) const {
    const Eigen::Vector2d left(-block.place.y(), block.place.x());
    T off[2];
    for (int i = 0; i < 2; ++i) {
      off[i] = T(block.mean[i]) - x[i] - x[4 + i] * T(block.time_s - middle_s) -
               T(1.0 - share) * from[i] - T(share) * to[i] - x[3] * T(block.heading[i]) +
               x[2] * T(block.velocity[i]) - turn[0] * T(left[i]);
    }
    for (int i = 0; i < 2; ++i) out[i] = T(whiten(i, 0)) * off[0] + T(whiten(i, 1)) * off[1];
    return true;
  }
};

}  // namespace v2vouch::remote
