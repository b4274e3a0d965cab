// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <optional>

#include "daemon/common/models/measurement_model.h"

namespace v2vouch {

/// Joseph-form Kalman update of any Gaussian whose size is known to the compiler.
///
///     S = H P H' + R,  K = P H' S^-1,  mean += K y,  P = (I - K H) P (I - K H)' + K R K'
///
/// @param frozen bit i set: state i keeps its mean (Schmidt: its uncertainty counts, but the
///   measurement may not teach it).
/// @return false when S is not positive definite or the result is not finite; nothing is changed.
template <int N, class Vector, class Jacobian, class Covariance>
bool JosephUpdate(const Vector& y, const Jacobian& H, const Covariance& R,
                  Eigen::Matrix<double, N, 1>& mean, Eigen::Matrix<double, N, N>& P,
                  unsigned frozen = 0) {
  using Gain =
      Eigen::Matrix<double, N, Vector::RowsAtCompileTime, 0, N, Vector::MaxRowsAtCompileTime>;
  using Innovation = Eigen::Matrix<double, Vector::RowsAtCompileTime, Vector::RowsAtCompileTime, 0,
                                   Vector::MaxRowsAtCompileTime, Vector::MaxRowsAtCompileTime>;
  // Coefficient by coefficient: for sizes like these, packing for the blocked product costs more
  // than the product itself.
  const Gain PHt = P.lazyProduct(H.transpose());
  Innovation S = H.lazyProduct(PHt);
  S += R;
  S = (0.5 * (S + S.transpose())).eval();
  const Eigen::LLT<Innovation> llt(S);
  if (llt.info() != Eigen::Success) return false;
  Gain K = llt.solve(PHt.transpose()).transpose();
  for (int i = 0; i < N; ++i) {
    if ((frozen >> i & 1U) != 0) K.row(i).setZero();
  }
  const Eigen::Matrix<double, N, 1> next = mean + K.lazyProduct(y);
  Eigen::Matrix<double, N, N> A = Eigen::Matrix<double, N, N>::Identity();
  A.noalias() -= K.lazyProduct(H);
  const Eigen::Matrix<double, N, N> AP = A.lazyProduct(P);
  const Gain KR = K.lazyProduct(R);
  Eigen::Matrix<double, N, N> posterior = AP.lazyProduct(A.transpose());
  posterior += KR.lazyProduct(K.transpose());
  if (!next.allFinite() || !posterior.allFinite()) return false;
  mean = next;
  P = 0.5 * (posterior + posterior.transpose());
  return true;
}

/// Likelihood of an innovation y of covariance S; both of a size known to the compiler or bounded.
/// @return nullopt when S is not positive definite or y is not finite.
template <class Vector, class Covariance>
std::optional<Likelihood> LikelihoodOf(const Vector& y, const Covariance& S) {
  const Eigen::LLT<Covariance> llt(S);
  if (llt.info() != Eigen::Success) return std::nullopt;
  const Vector whitened = llt.matrixL().solve(y);
  Likelihood result;
  result.rows = static_cast<int>(y.size());
  result.distance_squared = whitened.squaredNorm();
  for (int i = 0; i < result.rows; ++i) result.log_det += 2.0 * std::log(llt.matrixLLT()(i, i));
  if (!std::isfinite(result.distance_squared) || !std::isfinite(result.log_det)) {
    return std::nullopt;
  }
  return result;
}

/// The same for an innovation whose covariance is H P H' + R.
template <int N, class Vector, class Jacobian, class Covariance>
std::optional<Likelihood> EvaluateInnovation(const Vector& y, const Jacobian& H,
                                             const Covariance& R,
                                             const Eigen::Matrix<double, N, N>& P) {
  const Jacobian HP = H.lazyProduct(P);
  Covariance S = HP.lazyProduct(H.transpose());
  S += R;
  return LikelihoodOf(y, S);
}

}  // namespace v2vouch
