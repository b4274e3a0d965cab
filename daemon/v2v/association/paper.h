// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

namespace v2vouch {

/// One pair that the paper's method accepts.
struct PaperPair {
  std::size_t sensor = 0;  ///< Index into the sensor tracks S.
  std::size_t v2v = 0;     ///< Index into the V2V tracks V.
  double distance = 0.0;   ///< Mahalanobis distance D.
  friend bool operator==(const PaperPair&, const PaperPair&) = default;
};

/// The paper's Algorithm 1, as printed: every s in S against every v in V,
///
///     D = sqrt((z_v - z_s)^T C^-1 (z_v - z_s)),   z = (X, Y, Z);   D <= epsilon: add (s, v)
///
/// No one-to-one constraint, no memory, no check of speed or time; that is what it lacks and why
/// the safe form exists.
/// @param sensor positions z_s [m], any common frame.
/// @param v2v positions z_v [m], the same frame.
/// @param C covariance of the measurement error [m^2].
/// @param epsilon threshold, in standard deviations.
/// @return pairs ordered by sensor, then v2v. Empty where C is not positive definite.
/// Source: Billington et al., "Enhancing Track Management Systems with Vehicle-To-Vehicle Enabled
/// Sensor Fusion", Algorithm 1.
std::vector<PaperPair> AssociatePaper(std::span<const Eigen::Vector3d> sensor,
                                      std::span<const Eigen::Vector3d> v2v,
                                      const Eigen::Matrix3d& C, double epsilon);

}  // namespace v2vouch
