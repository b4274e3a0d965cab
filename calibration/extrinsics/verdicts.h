// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibration/extrinsics/extrinsics.h"
#include "calibration/extrinsics/information.h"

namespace v2vouch {

/// The posterior that the reduced information gives, with directions held at the prior where the
/// data say less than it does. With D the prior standard deviations and W = D S D = Q diag(l) Q':
///
///     values = prior + D sum_(l >= 1) q q' D^-1 (solution - prior)
///     covariance = D Q diag(1 / (1 + l)) Q' D,  l taken as 0 where held (l < 1)
///
/// The prior's metric makes this exact: a direction without data is independent of the others.
struct HeldPosterior {
  Eigen::MatrixXd covariance;
  std::vector<double> values;
  Eigen::VectorXd data_std;  ///< Of the data and the anchors alone.
  Eigen::VectorXd crlb;      ///< Nothing held.
  std::vector<WeakDirection> weak;
};

/// @param doubts what one sigma of each unknown that is considered only pulls (a column each).
/// @param solution the solver's values.
HeldPosterior HoldWeakDirections(const Eigen::MatrixXd& S, const Eigen::MatrixXd& doubts,
                                 const MountingParameters& solution);

/// ESTIMATED: data_std under a third of the prior's; WEAK: under the prior's; else PRIOR. Then
/// AT_BOUND beyond three prior standard deviations, REJECTED where the sensor's equations do not
/// fit.
CalibrationVerdict VerdictOf(double value, double data_std, double prior, double prior_std,
                             bool fits);

/// What driving would tell more of this quantity.
std::string HintFor(const std::string& name, CalibrationVerdict verdict,
                    const Excitation& excitation);

}  // namespace v2vouch
