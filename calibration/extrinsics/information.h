// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibration/extrinsics/drive_problem.h"

namespace v2vouch {

/// What the equations of a drive say about the mounting once everything else (the ego's true
/// motion, targets, nods) has been eliminated. With Jacobian J = [J_p J_t] of whitened equations,
///
///     S = H_pp - H_pt H_tt^-1 H_tp,    H = J'J of all equations but the mounting's priors.
///
/// ceres::Covariance does not serve here: it answers a rank deficiency with a number, and knows
/// neither groups nor correlated noise.
struct MountingInformation {
  Eigen::MatrixXd S;  ///< Data alone: no prior of a mounting parameter in it.
  /// What one sigma of each unknown that is considered only adds to the right side of S p = b, a
  /// column each.
  Eigen::MatrixXd doubts;

  /// Group by group, whose noise an estimate's variance is made of: row group (DriveProblem's),
  /// column parameter, each column sums to 1. With priors, as the estimate has.
  Eigen::MatrixXd shares;
  /// By what each group's noise exceeds white noise in blocks of 2 to 30 s: variance of block means
  /// over what independent residuals would give. 1 = white.
  Eigen::VectorXd inflation;
  /// By what each parameter's standard deviation grows for what of it the weights do not hold.
  Eigen::VectorXd std_factor;

  /// Standard deviation of each parameter as the drive's own blocks of a twentieth scatter: to
  /// first order, what leaving each of them out does (delete-one jackknife). Knows of correlated
  /// noise.
  Eigen::VectorXd block_std;

  struct Fit {
    int equations = 0;
    double chi_square_per_equation = 0.0;
    /// The same from the value that 68.27 % of the absolute residuals stay below: 1 for Gaussian
    /// ones of the stated size, however few outliers there are, and however large.
    double robust_chi_square = 0.0;
  };
  std::vector<Fit> fits;  ///< Per group; latent unknowns soak up a part, so below 1 is usual.
};

/// @return S empty when the equations of the eliminated unknowns have no solution.
MountingInformation Reduce(const DriveProblem& problem, const MountingParameters& parameters,
                           bool with_loss);

}  // namespace v2vouch
