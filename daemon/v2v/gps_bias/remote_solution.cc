// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/gps_bias/remote_solution.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>

#include "daemon/v2v/gps_bias/remote_terms.h"
#include "daemon/v2v/gps_bias/wander_terms.h"

namespace v2vouch {
namespace {

using remote::Block;
using remote::BlockCost;
using remote::Blocks;
using remote::kConstant;

constexpr int kIterations = 20;
constexpr double kSlopePrior_mps = 1.0;  // Of a bias that drifts.
constexpr double kAtBoundSigmas = 2.0;   // Added to a latency before it meets its limit.
constexpr double kTurnPrior_rad = 0.5;   // Hardly any: the data decide.

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

// How clearly what no receiver does is seen, in standard deviations.
struct Oddities {
  double slope_sigmas = 0.0;
  double turn_sigmas = 0.0;
};

// Of the first `wanted` unknowns, the others eliminated.
Eigen::MatrixXd CovarianceOf(ceres::Problem& problem, const std::vector<double*>& unknowns,
                             Eigen::Index wanted) {
  ceres::Problem::EvaluateOptions evaluate;
  evaluate.parameter_blocks = unknowns;
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
  return H.ldlt().solve(Eigen::MatrixXd::Identity(H.rows(), wanted)).topRows(wanted);
}

void Judge(const Diversity& diversity, const Oddities& odd, const RemoteRules& rules,
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
  if (s.slope_mps > rules.slope_mps && odd.slope_sigmas > rules.slope_sigma) {
    return say(CalibrationVerdict::kRejected, "drifts as no receiver does");
  }
  if (std::abs(s.turn_rad) > rules.turn_rad && odd.turn_sigmas > rules.turn_sigma) {
    return say(CalibrationVerdict::kRejected, "turned about the ego as no receiver is");
  }
  // What the messages alone say of the latency; the prior draws a liar's below the limit.
  const double told = 1.0 - std::pow(s.latency_std_s / rules.latency_sigma_s, 2);
  const double latest_s = (std::abs(s.latency_s) / std::max(told, 0.1)) +
                          kAtBoundSigmas * s.latency_std_s / std::sqrt(std::max(told, 0.1));
  if (std::abs(s.latency_s) > 0.5 * rules.max_latency_s && latest_s > rules.max_latency_s) {
    return say(CalibrationVerdict::kAtBound, "as late as a sender may be, or later");
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

struct Unknowns {
  std::array<double, kConstant> x{};
  double turn_rad = 0.0;
  std::vector<std::array<double, 2>> knots;
};

using Residuals = std::vector<ceres::ResidualBlockId>;

void AddPriors(const RemoteRules& rules, ceres::Problem& problem, Unknowns& u) {
  const double sigma_m = std::hypot(rules.noise.sender_sigma_m, rules.noise.common_sigma_m);
  const PriorTerm<kConstant> prior{{sigma_m, sigma_m, rules.latency_sigma_s, rules.offset_sigma_m,
                                    kSlopePrior_mps, kSlopePrior_mps}};
  problem.AddResidualBlock(
      new ceres::AutoDiffCostFunction<PriorTerm<kConstant>, kConstant, kConstant>(
          new PriorTerm<kConstant>(prior)),
      nullptr, u.x.data());
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PriorTerm<2>, 2, 2>(
                               new PriorTerm<2>(EastNorth(rules.noise.wander_sigma_m))),
                           nullptr, u.knots[0].data());
  problem.AddResidualBlock(
      new ceres::AutoDiffCostFunction<PriorTerm<1>, 1, 1>(new PriorTerm<1>{{kTurnPrior_rad}}),
      nullptr, &u.turn_rad);
  problem.SetParameterBlockConstant(&u.turn_rad);
}

Residuals AddSteps(const RemoteRules& rules, ceres::Problem& problem, Unknowns& u) {
  const WanderTerm step(rules.noise);
  Residuals steps;
  for (std::size_t k = 1; k < u.knots.size(); ++k) {
    steps.push_back(problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<WanderTerm, 2, 2, 2>(new WanderTerm(step)), nullptr,
        u.knots[k - 1].data(), u.knots[k].data()));
  }
  return steps;
}

Residuals AddBlocks(const std::vector<Block>& blocks, double knot_s, ceres::LossFunction& huber,
                    ceres::Problem& problem, Unknowns& u) {
  Residuals data;
  for (const Block& block : blocks) {
    const double at = block.time_s / knot_s;
    const auto k = static_cast<std::size_t>(at);
    const Eigen::Matrix2d whiten =
        block.covariance.llt().matrixL().solve(Eigen::Matrix2d::Identity());
    data.push_back(problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<BlockCost, 2, kConstant, 1, 2, 2>(
            new BlockCost{block, whiten, at - static_cast<double>(k), 0.5 * blocks.back().time_s}),
        &huber, u.x.data(), &u.turn_rad, u.knots[k].data(), u.knots[k + 1].data()));
  }
  return data;
}

double MeanSquare(ceres::Problem& problem, const Residuals& of) {
  ceres::Problem::EvaluateOptions only;
  only.residual_blocks = of;
  only.apply_loss_function = false;
  std::vector<double> r;
  problem.Evaluate(only, nullptr, &r, nullptr, nullptr);
  return std::inner_product(r.begin(), r.end(), r.begin(), 0.0) /
         std::max(1.0, static_cast<double>(r.size()));
}

void SetEstimate(const Unknowns& u, const Eigen::MatrixXd& C, RemoteSolution& s, Oddities& odd) {
  s.bias_en = {u.x[0], u.x[1]};
  s.bias_covariance = C.topLeftCorner<2, 2>();
  s.latency_s = u.x[2];
  s.latency_std_s = std::sqrt(C(2, 2));
  s.offset_m = u.x[3];
  s.offset_std_m = std::sqrt(C(3, 3));
  const Eigen::Vector2d slope(u.x[4], u.x[5]);
  s.slope_mps = slope.norm();
  odd.slope_sigmas = std::sqrt(slope.dot(C.block<2, 2>(4, 4).ldlt().solve(slope)));
}

}  // namespace

RemoteSolution SolveRemote(SenderId sender, const std::vector<RemotePair>& pairs, double consider_m,
                           double consider_rad, const RemoteRules& rules) {
  RemoteSolution s;
  s.sender = sender;
  s.pairs = static_cast<int>(pairs.size());
  if (pairs.empty()) {
    Judge({}, {}, rules, s);
    return s;
  }
  const std::vector<Block> blocks = Blocks(pairs, rules.noise.white_hz);
  s.span_s = static_cast<double>(blocks.size());  // Seconds with pairs, silences left out.
  for (const Block& block : blocks) s.blocks.push_back({block.time_s, block.mean});

  const double knot_s = rules.noise.knot_s;
  Unknowns u;
  u.knots.resize(static_cast<std::size_t>(blocks.back().time_s / knot_s) + 2);
  ceres::HuberLoss huber(rules.noise.huber);
  ceres::Problem::Options options;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(options);
  AddPriors(rules, problem, u);
  const Residuals steps = AddSteps(rules, problem, u);
  const Residuals data = AddBlocks(blocks, knot_s, huber, problem, u);
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  if (u.knots.size() > 20) solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.max_num_iterations = kIterations;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);

  std::vector<double*> unknowns{u.x.data()};
  for (auto& knot : u.knots) unknowns.push_back(knot.data());
  const Eigen::MatrixXd C = CovarianceOf(problem, unknowns, kConstant);
  double range_square = 0.0;
  for (const RemotePair& pair : pairs) range_square += pair.range_m * pair.range_m;
  range_square /= static_cast<double>(pairs.size());
  Oddities odd;
  SetEstimate(u, C, s, odd);
  s.bias_covariance += (consider_m * consider_m + consider_rad * consider_rad * range_square) *
                       Eigen::Matrix2d::Identity();
  s.chi_square_per_dof = MeanSquare(problem, data);
  s.wander_chi_square = steps.empty() ? 0.0 : MeanSquare(problem, steps);

  // Once more with the sender's world free to turn about the ego. Without, a turn passes for an
  // offset that wanders with the ego's direction; always free, it would take from what is known of
  // the bias.
  problem.SetParameterBlockVariable(&u.turn_rad);
  ceres::Solve(solver, &problem, &summary);
  unknowns.insert(unknowns.begin(), &u.turn_rad);
  s.turn_rad = u.turn_rad;
  s.turn_std_rad = std::hypot(std::sqrt(CovarianceOf(problem, unknowns, 1)(0, 0)), consider_rad);
  odd.turn_sigmas = std::abs(s.turn_rad) / s.turn_std_rad;
  Judge(DiversityOf(pairs), odd, rules, s);
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
  // Senders that the mean of the others, with the spread of honest senders, does not explain.
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
