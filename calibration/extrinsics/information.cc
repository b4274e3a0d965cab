// SPDX-License-Identifier: Apache-2.0
#include "calibration/extrinsics/information.h"

#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace v2vouch {
namespace {

constexpr Eigen::Index kJackknifeBlocks = 20;
// Lengths of the blocks in which correlated noise is looked for.
constexpr std::array<double, 4> kBlocks_s = {2.0, 5.0, 10.0, 30.0};

double RobustSquare(std::vector<double> residuals) {
  if (residuals.empty()) return 0.0;
  const auto at = residuals.begin() +
                  static_cast<std::ptrdiff_t>(0.6827 * static_cast<double>(residuals.size() - 1));
  std::ranges::nth_element(residuals, at, {}, [](double r) { return std::abs(r); });
  return *at * *at;
}

// Block means against what independent residuals would give; only beyond sampling error.
double Inflation(const std::vector<double>& times_s, const std::vector<double>& residuals) {
  double mean = 0.0;
  for (const double r : residuals) mean += r;
  mean /= static_cast<double>(residuals.size());
  double variance = 0.0;
  for (const double r : residuals) variance += (r - mean) * (r - mean);
  variance /= static_cast<double>(residuals.size());
  if (variance <= 0.0) return 1.0;
  double most = 1.0;
  for (const double block_s : kBlocks_s) {
    std::map<std::int64_t, std::pair<double, int>> blocks;  // Sum, count.
    for (std::size_t i = 0; i < residuals.size(); ++i) {
      auto& block = blocks[static_cast<std::int64_t>(std::floor(times_s[i] / block_s))];
      block.first += residuals[i] - mean;
      ++block.second;
    }
    if (blocks.size() < 8) continue;
    // Each block's sum has variance count * variance if residuals are independent.
    double ratio = 0.0;
    for (const auto& [number, block] : blocks) {
      ratio += block.first * block.first / (variance * block.second);
    }
    const auto n = static_cast<double>(blocks.size());
    ratio /= n;
    if (ratio > 1.0 + 3.0 * std::sqrt(2.0 / n)) most = std::max(most, ratio);
  }
  return most;
}

// H = J'J without the mounting's priors; p the parameters, t everything else.
struct NormalEquations {
  Eigen::MatrixXd Hpp, Htp;
  Eigen::SparseMatrix<double> Htt;  // Its lower half.
};

NormalEquations NormalEquationsOf(const DriveProblem::Linear& linear, int first_row,
                                  const MountingParameters& parameters) {
  const int np = parameters.size();
  const int nt = linear.unknowns - np;
  const auto rows = static_cast<int>(linear.residuals.size());
  NormalEquations normal{.Hpp = Eigen::MatrixXd::Zero(np, np),
                         .Htp = Eigen::MatrixXd::Zero(nt, np),
                         .Htt = Eigen::SparseMatrix<double>(nt, nt)};
  std::vector<Eigen::Triplet<double>> triplets;
  std::vector<Eigen::Triplet<double>> cross;
  for (int row = first_row; row < rows; ++row) {
    const int begin = linear.row_begin[static_cast<std::size_t>(row)];
    const int end = linear.row_begin[static_cast<std::size_t>(row) + 1];
    for (int i = begin; i < end; ++i) {
      const int ci = linear.columns[static_cast<std::size_t>(i)];
      const double vi = linear.values[static_cast<std::size_t>(i)];
      if (vi == 0.0) continue;
      for (int k = begin; k < end; ++k) {
        const int ck = linear.columns[static_cast<std::size_t>(k)];
        const double v = vi * linear.values[static_cast<std::size_t>(k)];
        if (ci < np && ck < np) {
          normal.Hpp(ci, ck) += v;
        } else if (ci >= np && ck >= np) {
          if (ck <= ci) triplets.emplace_back(ci - np, ck - np, v);
        } else if (ci >= np && ck < np) {
          cross.emplace_back(ci - np, ck, v);
        }
      }
    }
  }
  normal.Htt.setFromTriplets(triplets.begin(), triplets.end());
  for (const auto& t : cross) normal.Htp(t.row(), t.col()) += t.value();
  return normal;
}

Eigen::MatrixXd CovarianceWithPriors(const Eigen::MatrixXd& S,
                                     const MountingParameters& parameters) {
  Eigen::VectorXd prior(parameters.size());
  for (int i = 0; i < parameters.size(); ++i) {
    const double s = parameters.descriptions()[static_cast<std::size_t>(i)].equation_std();
    prior(i) = 1.0 / (s * s);
  }
  return (S + prior.asDiagonal().toDenseMatrix()).inverse();
}

// Influence of every equation on the estimate: X' J' r, X = [I; -G] C, C = (S + priors)^-1. By
// group: shares (not yet normalised); by block of the drive: block_std.
void AddInfluence(const DriveProblem& problem, const DriveProblem::Linear& linear,
                  const Eigen::MatrixXd& C, const Eigen::MatrixXd& G,
                  MountingInformation& information) {
  const Eigen::Index np = C.rows();
  const Eigen::MatrixXd GC = G * C;
  information.shares =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(problem.groups().size()), np);
  Eigen::RowVectorXd w(np);
  Eigen::MatrixXd block_pull = Eigen::MatrixXd::Zero(kJackknifeBlocks, np);
  double last_s = 0.0;
  for (const Equation& equation : problem.equations()) last_s = std::max(last_s, equation.time_s);
  const auto rows = static_cast<int>(linear.residuals.size());
  for (int row = 0; row < rows; ++row) {
    const Equation& equation = problem.equations()[static_cast<std::size_t>(row)];
    w.setZero();
    for (int i = linear.row_begin[static_cast<std::size_t>(row)];
         i < linear.row_begin[static_cast<std::size_t>(row) + 1]; ++i) {
      const int c = linear.columns[static_cast<std::size_t>(i)];
      const double v = linear.values[static_cast<std::size_t>(i)];
      if (v == 0.0) continue;
      if (c < np) {
        w += v * C.row(c);
      } else {
        w -= v * GC.row(c - np);
      }
    }
    information.shares.row(equation.group) += w.cwiseProduct(w);
    if (row >= problem.prior_equations() && last_s > 0.0) {
      const auto block = std::min<Eigen::Index>(
          kJackknifeBlocks - 1,
          static_cast<Eigen::Index>(kJackknifeBlocks * equation.time_s / last_s));
      block_pull.row(block) += linear.residuals[static_cast<std::size_t>(row)] * w;
    }
  }
  const Eigen::MatrixXd centred = block_pull.rowwise() - block_pull.colwise().mean();
  information.block_std =
      centred.colwise().norm().transpose() * std::sqrt(kJackknifeBlocks / (kJackknifeBlocks - 1.0));
}

// How well each group of equations fits, and how correlated its residuals are.
void AddFits(const DriveProblem& problem, const DriveProblem::Linear& linear,
             MountingInformation& information) {
  const std::size_t groups = problem.groups().size();
  std::vector<std::vector<double>> times(groups), residuals(groups);
  for (std::size_t row = 0; row < linear.residuals.size(); ++row) {
    const Equation& equation = problem.equations()[row];
    times[static_cast<std::size_t>(equation.group)].push_back(equation.time_s);
    residuals[static_cast<std::size_t>(equation.group)].push_back(linear.residuals[row]);
  }
  information.inflation = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(groups));
  for (std::size_t g = 0; g < groups; ++g) {
    MountingInformation::Fit fit{static_cast<int>(residuals[g].size()), 0.0, 0.0};
    for (const double r : residuals[g]) fit.chi_square_per_equation += r * r;
    fit.chi_square_per_equation /= std::max(1, fit.equations);
    fit.robust_chi_square = RobustSquare(residuals[g]);
    information.fits.push_back(fit);
    if (problem.groups()[g] != "prior") {
      information.inflation(static_cast<Eigen::Index>(g)) = Inflation(times[g], residuals[g]);
    }
  }
}

// Grows each standard deviation by the correlation that the weights do not hold yet, and
// normalises the shares.
void AddStdFactor(const DriveProblem& problem, MountingInformation& information) {
  Eigen::VectorXd beyond = information.inflation;
  for (Eigen::Index g = 0; g < beyond.size(); ++g) {
    beyond(g) = std::max(1.0, beyond(g) / problem.weighed_inflation(static_cast<int>(g)));
  }
  const Eigen::Index np = information.shares.cols();
  information.std_factor = Eigen::VectorXd::Ones(np);
  for (Eigen::Index i = 0; i < np; ++i) {
    const double white = information.shares.col(i).sum();
    const double grown = information.shares.col(i).dot(beyond);
    if (white > 0.0) {
      information.std_factor(i) = std::sqrt(grown / white);
      information.shares.col(i) /= white;
    }
  }
}

}  // namespace

MountingInformation Reduce(const DriveProblem& problem, const MountingParameters& parameters,
                           bool with_loss) {
  const DriveProblem::Linear linear = problem.Linearised(with_loss);
  const NormalEquations normal = NormalEquationsOf(linear, problem.prior_equations(), parameters);
  MountingInformation information;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> solver(normal.Htt);
  if (solver.info() != Eigen::Success) return information;
  const Eigen::MatrixXd G = solver.solve(normal.Htp);  // H_tt^-1 H_tp
  if (!G.allFinite()) return information;
  information.S = normal.Hpp - normal.Htp.transpose() * G;
  information.S = 0.5 * (information.S + information.S.transpose()).eval();

  // The row of G is its own variance times what it and the parameters have in common.
  const auto considered = problem.considered();
  information.doubts.resize(parameters.size(), static_cast<Eigen::Index>(considered.size()));
  for (std::size_t i = 0; i < considered.size(); ++i) {
    const auto& one = considered[i];
    information.doubts.col(static_cast<Eigen::Index>(i)) =
        G.row(one.column - parameters.size()).transpose() *
        (one.sigma / (one.held_sigma * one.held_sigma));
  }
  AddInfluence(problem, linear, CovarianceWithPriors(information.S, parameters), G, information);
  AddFits(problem, linear, information);
  AddStdFactor(problem, information);
  return information;
}

}  // namespace v2vouch
