// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "daemon/v2v/gps_bias/residual_window.h"

namespace v2vouch {

/// What a solve says of one sender.
struct SenderSolution {
  SenderId sender = 0;
  BiasEstimate bias;      ///< Common, constant and wandering part at the solve's time, together.
  double change_m = 0.0;  ///< Of the wandering part, between any two knots, at most.
  double null_chi_square = 0.0;  ///< Of the wandering part against its own model, per dof.
  /// Where the common part would move without this sender, against its covariance [chi-square].
  double leave_one_out = 0.0;
};

struct BiasSolution {
  bool is_usable = false;
  BiasEstimate common;
  std::vector<SenderSolution> senders;  ///< As given.
  double chi_square_per_dof = 0.0;      ///< Of the residuals.
};

/// Maximum a posteriori over one window:
///
///     r_j(t) = c + b_j + w_j(t) + noise
///     c   common to all (the ego's own error),  N(0, common_sigma^2) per axis
///     b_j the sender's constant part,           N(0, sender_sigma^2)
///     w_j its wandering part: Gauss-Markov (wander_sigma, wander_decay), linear between knots
///
/// Only c + b_j + w_j is observable; the split hangs on the priors and on how many senders there
/// are, and its covariance says so. Huber loss on residuals, none on the priors. One thread, fixed
/// iterations, always from zero: the same blocks give the same bits on one machine.
BiasSolution SolveBias(const std::vector<SenderBlocks>& senders, Timestamp at,
                       const GpsBiasConfig& config);

}  // namespace v2vouch
