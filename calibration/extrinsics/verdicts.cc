// SPDX-License-Identifier: Apache-2.0
#include "calibration/extrinsics/verdicts.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace v2vouch {
namespace {

constexpr double kTiny = 1e-9;  // Of the prior's information: nothing at all.

Eigen::VectorXd PriorStd(const MountingParameters& parameters) {
  Eigen::VectorXd D(parameters.size());
  for (int i = 0; i < parameters.size(); ++i) {
    D(i) = parameters.descriptions()[static_cast<std::size_t>(i)].prior_std;
  }
  return D;
}

// The main parts of an eigenvector, largest first, with signs relative to the first.
std::string InWords(const Eigen::VectorXd& q, const MountingParameters& parameters) {
  std::vector<int> order(static_cast<std::size_t>(q.size()));
  for (int i = 0; i < q.size(); ++i) order[static_cast<std::size_t>(i)] = i;
  std::ranges::stable_sort(order, [&](int a, int b) { return std::abs(q(a)) > std::abs(q(b)); });
  std::string text;
  for (std::size_t k = 0; k < order.size() && k < 8; ++k) {
    const int i = order[k];
    if (std::abs(q(i)) < 0.1 * std::abs(q(order[0]))) break;
    if (k > 0) text += q(i) * q(order[0]) > 0.0 ? " + " : " - ";
    text += parameters.descriptions()[static_cast<std::size_t>(i)].name;
  }
  return text;
}

bool Contains(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

HeldPosterior HoldWeakDirections(const Eigen::MatrixXd& S, const Eigen::MatrixXd& doubts,
                                 const MountingParameters& solution) {
  HeldPosterior held;
  const Eigen::VectorXd D = PriorStd(solution);
  const Eigen::Index n = D.size();
  // In units of the priors; what is considered only is taken out, and its pull on the rest kept.
  Eigen::MatrixXd W = D.asDiagonal() * S * D.asDiagonal();
  Eigen::MatrixXd pull = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd push = D.asDiagonal() * doubts;
  Eigen::VectorXd step(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& d = solution.descriptions()[static_cast<std::size_t>(i)];
    step(i) = (solution.values()[static_cast<std::size_t>(i)] - d.prior) / D(i);
    if (!d.is_considered) continue;
    pull.col(i) = W.col(i);
    W.row(i).setZero();
    W.col(i).setZero();
    step(i) = 0.0;
  }
  Eigen::MatrixXd anchored = W;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& d = solution.descriptions()[static_cast<std::size_t>(i)];
    if (d.is_anchor) anchored(i, i) += 1.0;
    if (!d.is_considered) continue;
    pull.row(i).setZero();
    push.row(i).setZero();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(W);
  const Eigen::MatrixXd& Q = eigen.eigenvectors();
  const Eigen::ArrayXd l = eigen.eigenvalues().array().max(0.0);
  Eigen::ArrayXd kept = l;
  for (Eigen::Index k = 0; k < n && l(k) < 1.0; ++k) {  // Eigenvalues come in rising order.
    kept(k) = 0.0;
    step -= Q.col(k) * Q.col(k).dot(step);
    held.weak.push_back({l(k), InWords(Q.col(k), solution)});
  }
  const auto posterior = [&](const Eigen::ArrayXd& information) -> Eigen::MatrixXd {
    const Eigen::MatrixXd C =
        Q * (1.0 + information).inverse().matrix().asDiagonal() * Q.transpose();
    const Eigen::MatrixXd K = C * pull;  // What one sigma of the considered ones moves.
    const Eigen::MatrixXd P = C * push;
    return D.asDiagonal() * (C + K * K.transpose() - K - K.transpose() + P * P.transpose()).eval() *
           D.asDiagonal();
  };
  held.covariance = posterior(kept);
  held.crlb = posterior(l).diagonal().cwiseSqrt();

  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> data(anchored);
  const Eigen::MatrixXd inverse = data.eigenvectors() *
                                  data.eigenvalues().cwiseMax(kTiny).cwiseInverse().asDiagonal() *
                                  data.eigenvectors().transpose();
  const Eigen::VectorXd variance = inverse.diagonal() + (inverse * pull).rowwise().squaredNorm() +
                                   (inverse * push).rowwise().squaredNorm();
  held.data_std = D.cwiseProduct(variance.cwiseSqrt());
  for (Eigen::Index i = 0; i < n; ++i) {
    held.values.push_back(solution.descriptions()[static_cast<std::size_t>(i)].prior +
                          D(i) * step(i));
  }
  return held;
}

CalibrationVerdict VerdictOf(double value, double data_std, double prior, double prior_std,
                             bool fits) {
  if (!(data_std <= prior_std)) return CalibrationVerdict::kPrior;
  if (!fits) return CalibrationVerdict::kRejected;
  if (std::abs(value - prior) >= 2.999 * prior_std) return CalibrationVerdict::kAtBound;
  return data_std > prior_std / 3.0 ? CalibrationVerdict::kWeak : CalibrationVerdict::kEstimated;
}

std::string HintFor(const std::string& name, CalibrationVerdict verdict,
                    const Excitation& excitation) {
  if (verdict != CalibrationVerdict::kPrior && verdict != CalibrationVerdict::kWeak) return "";
  if (Contains(name, "odometer_y") || Contains(name, "slip")) {  // However long the drive.
    return "held by what is known of the car; only a reference outside it could tell more";
  }
  const auto is_unheard = [&](const std::string& sensor) {
    const auto found = excitation.messages.find(sensor);
    return found != excitation.messages.end() && found->second == 0;
  };
  const std::string sensor = name.substr(0, name.find('.'));
  if (is_unheard(sensor)) return "no message of " + sensor + " in the logs";
  if (Contains(name, "antenna") && is_unheard("gnss")) return "no GNSS fix in the logs";
  if (Contains(name, "heading_bias") && is_unheard("gnss_heading")) {
    return is_unheard("gnss") ? "no GNSS fix in the logs" : "no fix in the logs has a heading";
  }
  if (excitation.moving_s < 20.0) {
    if (excitation.moving_s <= 0.5 * excitation.duration_s || excitation.moving_s <= 0.0) {
      return "the car hardly moved: drive, faster than 3 m/s";
    }
    return "only " + std::to_string(std::lround(excitation.moving_s)) +
           " s of driving in the logs: ten minutes tell everything";
  }
  const bool is_place = Contains(name, ".x_m") || Contains(name, ".y_m");
  const bool is_ego_place = Contains(name, "antenna") || Contains(name, "odometer_y");
  if ((is_place || is_ego_place) && excitation.yaw_rate_rms_radps < 0.05) {
    return "no turns: drive a roundabout, left and right bends";
  }
  if (Contains(name, "camera_")) {
    if (excitation.target_windows < 100) {
      return "only " + std::to_string(excitation.target_windows) +
             " looks at moving vehicles seen by radar and camera: drive in traffic";
    }
    if (Contains(name, "roll")) return "vehicles to the left and right of the camera's axis";
    if (Contains(name, "pitch") || Contains(name, ".z_m")) {
      return "vehicles near and far, 8 to 80 m, on flat road";
    }
    return "more vehicles in view, near ones, and turns";
  }
  if (Contains(name, "radar_") && excitation.static_returns < 2000) {
    return "too few returns of standing things: drive past poles, parked cars, guard rails";
  }
  if (Contains(name, "heading_bias")) return "the receiver gives no heading, or only a noisy one";
  if (is_place || is_ego_place) return "more turns, at different speeds";
  return "more of the same: " + std::to_string(std::lround(excitation.moving_s)) +
         " s of driving and " + std::to_string(excitation.static_returns) +
         " returns of standing things were too few";
}

}  // namespace v2vouch
