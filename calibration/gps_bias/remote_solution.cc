// SPDX-License-Identifier: Apache-2.0
#include "calibration/gps_bias/remote_solution.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>

namespace v2vouch {
namespace {

constexpr int kIterations = 20;
constexpr double kStanding_mps = 0.5;  // Slower, the heading is not that of the velocity.
constexpr double kSlopePrior_mps = 1.0;

// The pairs of one second, as one.
struct Block {
  double time_s = 0.0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();
  Eigen::Vector2d heading = Eigen::Vector2d::Zero();
  int pairs = 0;
};

std::vector<Block> Blocks(const std::vector<RemotePair>& pairs, double white_hz) {
  std::map<std::int64_t, Block> by_second;
  const Timestamp start = pairs.front().residual.stamp;
  for (const RemotePair& pair : pairs) {
    const double time_s = ToSeconds(pair.residual.stamp - start);
    Block& block = by_second[static_cast<std::int64_t>(std::floor(time_s))];
    ++block.pairs;
    block.time_s += time_s;
    block.mean += pair.residual.claimed_minus_sensed_en;
    block.covariance += pair.residual.covariance;
    block.velocity += pair.velocity_en_mps;
    const double speed = pair.velocity_en_mps.norm();
    if (speed > kStanding_mps) block.heading += pair.velocity_en_mps / speed;
  }
  std::vector<Block> blocks;
  for (auto& [second, block] : by_second) {
    const double n = block.pairs;
    block.time_s /= n;
    block.mean /= n;
    block.velocity /= n;
    block.heading /= n;
    block.covariance /= n * std::min(n, white_hz);
    blocks.push_back(block);
  }
  return blocks;
}

// b 0..1, tau 2, c 3, slope 4..5 of the constant part; knots beside it.
constexpr int kConstant = 6;

struct BlockCost {
  Block block;
  Eigen::Matrix2d whiten;
  double share;     // Between the two knots.
  double middle_s;  // The slope turns round it.
  template <class T>
  bool operator()(const T* x, const T* from, const T* to, T* out) const {
    T off[2];
    for (int i = 0; i < 2; ++i) {
      off[i] = T(block.mean[i]) - x[i] - x[4 + i] * T(block.time_s - middle_s) -
               T(1.0 - share) * from[i] - T(share) * to[i] - x[3] * T(block.heading[i]) +
               x[2] * T(block.velocity[i]);
    }
    for (int i = 0; i < 2; ++i) out[i] = T(whiten(i, 0)) * off[0] + T(whiten(i, 1)) * off[1];
    return true;
  }
};

struct ConstantPrior {
  std::array<double, kConstant> sigma;
  template <class T>
  bool operator()(const T* x, T* out) const {
    for (std::size_t i = 0; i < kConstant; ++i) out[i] = x[i] / T(sigma[i]);
    return true;
  }
};

struct KnotPrior {
  double sigma;
  template <class T>
  bool operator()(const T* knot, T* out) const {
    for (int i = 0; i < 2; ++i) out[i] = knot[i] / T(sigma);
    return true;
  }
};

struct KnotStep {
  double keep, sigma;
  template <class T>
  bool operator()(const T* from, const T* to, T* out) const {
    for (int i = 0; i < 2; ++i) out[i] = (to[i] - T(keep) * from[i]) / T(sigma);
    return true;
  }
};

double Spread(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t n = values.size();
  return values[n - 1 - n / 20] - values[n / 20];  // Without the outermost 5 % at either end.
}

struct Diversity {
  double bearing_rad, range_m, velocity_m2ps2;
};

Diversity DiversityOf(const std::vector<RemotePair>& pairs) {
  std::vector<double> bearings, ranges;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  double square = 0.0;
  const double first = pairs.front().bearing_rad;
  double last = 0.0;  // Unwrapped, so that going round counts.
  for (const RemotePair& pair : pairs) {
    last += std::remainder(pair.bearing_rad - first - last, 2.0 * M_PI);
    bearings.push_back(last);
    ranges.push_back(pair.range_m);
    mean += pair.velocity_en_mps;
    square += pair.velocity_en_mps.squaredNorm();
  }
  const auto n = static_cast<double>(pairs.size());
  return {Spread(std::move(bearings)), Spread(std::move(ranges)),
          0.5 * (square / n - (mean / n).squaredNorm())};
}

void Judge(const Diversity& diversity, double slope_sigmas, const RemoteRules& rules,
           RemoteSolution& s) {
  const auto say = [&](CalibrationVerdict verdict, const char* reason) {
    s.verdict = verdict;
    s.reason = reason;
  };
  if (s.span_s < rules.min_span_s || s.pairs < rules.min_pairs) {
    return say(CalibrationVerdict::kPrior, "too few confirmed messages: 30 s and 200 are wanted");
  }
  if (s.bias_en.norm() > rules.noise.max_bias_m) {
    return say(CalibrationVerdict::kRejected, "farther off than a receiver may be");
  }
  if (std::abs(s.latency_s) > rules.max_latency_s) {
    return say(CalibrationVerdict::kRejected, "later than a sender may be");
  }
  if (s.wander_chi_square > rules.noise.null_chi_square) {
    return say(CalibrationVerdict::kRejected, "wanders as no receiver does");
  }
  if (s.slope_mps > rules.slope_mps && slope_sigmas > rules.slope_sigma) {
    return say(CalibrationVerdict::kRejected, "drifts as no receiver does");
  }
  if (diversity.bearing_rad < rules.min_bearing_spread_rad &&
      diversity.range_m < rules.min_range_spread_m) {
    return say(CalibrationVerdict::kPrior, "always seen in the same direction and distance");
  }
  if (diversity.velocity_m2ps2 < rules.min_velocity_variance_m2ps2) {
    return say(CalibrationVerdict::kWeak,
               "one velocity throughout: bias and latency are known together only");
  }
  say(CalibrationVerdict::kEstimated, "");
}

}  // namespace

RemoteSolution SolveRemote(SenderId sender, const std::vector<RemotePair>& pairs, double consider_m,
                           double consider_rad, const RemoteRules& rules) {
  RemoteSolution s;
  s.sender = sender;
  s.pairs = static_cast<int>(pairs.size());
  if (pairs.empty()) {
    Judge({}, 0.0, rules, s);
    return s;
  }
  const std::vector<Block> blocks = Blocks(pairs, rules.noise.white_hz);
  s.span_s = static_cast<double>(blocks.size());  // Seconds with pairs, silences left out.
  for (const Block& block : blocks) s.blocks.push_back({block.time_s, block.mean});

  const double knot_s = rules.noise.knot_s;
  const double keep = std::exp(-knot_s / rules.noise.wander_decay_s);
  const KnotStep step{keep, rules.noise.wander_sigma_m * std::sqrt(1.0 - keep * keep)};
  std::array<double, kConstant> x{};
  std::vector<std::array<double, 2>> knots(static_cast<std::size_t>(blocks.back().time_s / knot_s) +
                                           2);
  ceres::HuberLoss huber(rules.noise.huber);
  ceres::Problem::Options options;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(options);
  const double sigma_m = std::hypot(rules.noise.sender_sigma_m, rules.noise.common_sigma_m);
  const ConstantPrior prior{{sigma_m, sigma_m, rules.latency_sigma_s, rules.offset_sigma_m,
                             kSlopePrior_mps, kSlopePrior_mps}};
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<ConstantPrior, kConstant, kConstant>(
                               new ConstantPrior(prior)),
                           nullptr, x.data());
  problem.AddResidualBlock(
      new ceres::AutoDiffCostFunction<KnotPrior, 2, 2>(new KnotPrior{rules.noise.wander_sigma_m}),
      nullptr, knots[0].data());
  std::vector<ceres::ResidualBlockId> steps;
  for (std::size_t k = 1; k < knots.size(); ++k) {
    steps.push_back(problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<KnotStep, 2, 2, 2>(new KnotStep(step)), nullptr,
        knots[k - 1].data(), knots[k].data()));
  }
  std::vector<ceres::ResidualBlockId> data;
  for (const Block& block : blocks) {
    const double at = block.time_s / knot_s;
    const auto k = static_cast<std::size_t>(at);
    const Eigen::Matrix2d whiten =
        block.covariance.llt().matrixL().solve(Eigen::Matrix2d::Identity());
    data.push_back(problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<BlockCost, 2, kConstant, 2, 2>(
            new BlockCost{block, whiten, at - static_cast<double>(k), 0.5 * blocks.back().time_s}),
        &huber, x.data(), knots[k].data(), knots[k + 1].data()));
  }
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  if (knots.size() > 20) solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.max_num_iterations = kIterations;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);

  // Covariance of the constant part, knots eliminated.
  ceres::Problem::EvaluateOptions evaluate;
  evaluate.parameter_blocks.push_back(x.data());
  for (auto& knot : knots) evaluate.parameter_blocks.push_back(knot.data());
  ceres::CRSMatrix crs;
  problem.Evaluate(evaluate, nullptr, nullptr, nullptr, &crs);
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(crs.num_rows, crs.num_cols);
  for (int row = 0; row < crs.num_rows; ++row) {
    for (int i = crs.rows[static_cast<std::size_t>(row)];
         i < crs.rows[static_cast<std::size_t>(row) + 1]; ++i) {
      J(row, crs.cols[static_cast<std::size_t>(i)]) = crs.values[static_cast<std::size_t>(i)];
    }
  }
  const Eigen::MatrixXd H = J.transpose() * J;
  const Eigen::MatrixXd C =
      H.ldlt().solve(Eigen::MatrixXd::Identity(H.rows(), kConstant)).topRows<kConstant>();
  double range_square = 0.0;
  for (const RemotePair& pair : pairs) range_square += pair.range_m * pair.range_m;
  range_square /= static_cast<double>(pairs.size());
  s.bias_en = {x[0], x[1]};
  s.bias_covariance = C.topLeftCorner<2, 2>();
  s.bias_covariance += (consider_m * consider_m + consider_rad * consider_rad * range_square) *
                       Eigen::Matrix2d::Identity();
  s.latency_s = x[2];
  s.latency_std_s = std::sqrt(C(2, 2));
  s.offset_m = x[3];
  s.offset_std_m = std::sqrt(C(3, 3));
  const Eigen::Vector2d slope(x[4], x[5]);
  s.slope_mps = slope.norm();
  const double slope_sigmas = std::sqrt(slope.dot(C.block<2, 2>(4, 4).ldlt().solve(slope)));

  const auto squares = [&](const std::vector<ceres::ResidualBlockId>& of) {
    ceres::Problem::EvaluateOptions only;
    only.residual_blocks = of;
    only.apply_loss_function = false;
    std::vector<double> r;
    problem.Evaluate(only, nullptr, &r, nullptr, nullptr);
    return std::inner_product(r.begin(), r.end(), r.begin(), 0.0) /
           std::max(1.0, static_cast<double>(r.size()));
  };
  s.chi_square_per_dof = squares(data);
  s.wander_chi_square = steps.empty() ? 0.0 : squares(steps);
  Judge(DiversityOf(pairs), slope_sigmas, rules, s);
  return s;
}

std::vector<RemoteSolution> SolveRemotes(const std::vector<RemotePair>& pairs, double consider_m,
                                         double consider_rad, const RemoteRules& rules) {
  std::map<SenderId, std::vector<RemotePair>> by_sender;
  for (const RemotePair& pair : pairs) by_sender[pair.residual.sender].push_back(pair);
  std::vector<RemoteSolution> solutions;
  for (auto& [sender, of_sender] : by_sender) {
    std::ranges::stable_sort(of_sender, {},
                             [](const RemotePair& pair) { return pair.residual.stamp; });
    solutions.push_back(SolveRemote(sender, of_sender, consider_m, consider_rad, rules));
  }
  std::vector<RemoteSolution*> used;
  for (RemoteSolution& s : solutions) {
    if (s.verdict == CalibrationVerdict::kEstimated) used.push_back(&s);
  }
  // Whom the mean of the others, with the spread honest senders have, does not explain.
  const double own = rules.noise.sender_sigma_m * rules.noise.sender_sigma_m;
  std::vector<RemoteSolution*> leading;
  for (RemoteSolution* one : used) {
    if (used.size() < 3) break;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (const RemoteSolution* other : used) {
      if (other != one) mean += other->bias_en / static_cast<double>(used.size() - 1);
    }
    const Eigen::Matrix2d P =
        one->bias_covariance +
        own * (1.0 + 1.0 / static_cast<double>(used.size() - 1)) * Eigen::Matrix2d::Identity();
    const Eigen::Vector2d off = one->bias_en - mean;
    if (off.dot(P.ldlt().solve(off)) > rules.leave_one_out_gate) leading.push_back(one);
  }
  for (RemoteSolution* one : leading) {
    one->verdict = CalibrationVerdict::kRejected;
    one->reason = "what all have in common would hang on this one alone";
  }
  return solutions;
}

}  // namespace v2vouch
