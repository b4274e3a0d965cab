// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/gps_bias/bias_problem.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "daemon/v2v/gps_bias/wander_terms.h"

namespace v2vouch {
namespace {

constexpr int kIterations = 10;  // At most; the problem is nearly linear.

using Block = std::array<double, 2>;

// A block mean, whitened: L^-1 (r - c - b - (1 - u) w_k - u w_k+1), P = L L'.
struct Residual {
  Eigen::Vector2d mean;
  Eigen::Matrix2d whiten;
  double u;

  template <class T>
  bool operator()(const T* c, const T* b, const T* from, const T* to, T* out) const {
    using Vector = Eigen::Matrix<T, 2, 1>;
    using Map = Eigen::Map<const Vector>;
    const Vector nu = mean.cast<T>() - Map(c) - Map(b) - T(1.0 - u) * Map(from) - T(u) * Map(to);
    Eigen::Map<Vector> whitened(out);
    whitened = whiten.cast<T>() * nu;
    return true;
  }
};

template <class Cost, int... kSizes>
ceres::CostFunction* AutoDiff(const Cost& cost) {
  return new ceres::AutoDiffCostFunction<Cost, 2, kSizes...>(new Cost(cost));
}

class Window {
 public:
  Window(const std::vector<SenderBlocks>& senders, Timestamp at, const GpsBiasConfig& config)
      : config_(config), wander_(config), huber_(config.huber) {
    ceres::Problem::Options options;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    problem_ = std::make_unique<ceres::Problem>(options);
    problem_->AddResidualBlock(AutoDiff<PriorTerm<2>, 2>(EastNorth(config.common_sigma_m)), nullptr,
                               common_.data());
    senders_.resize(senders.size());
    for (std::size_t j = 0; j < senders.size(); ++j) Add(senders[j], at, senders_[j]);
  }

  bool Solve() {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.max_num_iterations = kIterations;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, problem_.get(), &summary);
    return summary.IsSolutionUsable();
  }

  BiasSolution Read(const std::vector<SenderBlocks>& senders) {
    BiasSolution solution;
    Eigen::Matrix2d total =
        Eigen::Matrix2d::Identity() / (config_.common_sigma_m * config_.common_sigma_m);
    std::vector<Part> parts;
    for (Sender& sender : senders_) {
      parts.push_back(Reduce(sender));
      total += parts.back().on_common;
    }
    solution.common.mean_en = Eigen::Map<const Eigen::Vector2d>(common_.data());
    solution.common.covariance = total.inverse();
    double squares = 0.0;
    double freedom = 0.0;
    for (std::size_t j = 0; j < senders_.size(); ++j) {
      solution.senders.push_back(Read(senders_[j], parts[j], total));
      solution.senders.back().sender = senders[j].sender;
      squares += parts[j].squares;
      freedom += 2.0 * static_cast<double>(senders_[j].residuals.size());
    }
    solution.chi_square_per_dof = freedom > 0.0 ? squares / freedom : 0.0;
    solution.is_usable = total.allFinite();
    return solution;
  }

 private:
  struct Sender {
    Block constant{};
    std::vector<Block> knots;
    std::vector<ceres::ResidualBlockId> residuals;  // Of data ...
    std::vector<ceres::ResidualBlockId> priors;     // ... and the rest.
  };
  // Information of one sender's blocks: common first, then its own.
  struct Part {
    Eigen::MatrixXd H;
    Eigen::Matrix2d on_common;  // Its own part eliminated.
    Eigen::Vector2d pull;       // Gradient on the common part, likewise.
    double squares = 0.0;
  };

  void Add(const SenderBlocks& blocks, Timestamp at, Sender& sender) {
    const auto knots = static_cast<std::size_t>(std::ceil(config_.window_s / config_.knot_s)) + 1;
    sender.knots.resize(knots);
    const auto add_prior = [&](ceres::CostFunction* cost, auto*... x) {
      sender.priors.push_back(problem_->AddResidualBlock(cost, nullptr, x...));
    };
    add_prior(AutoDiff<PriorTerm<2>, 2>(EastNorth(config_.sender_sigma_m)), sender.constant.data());
    add_prior(AutoDiff<PriorTerm<2>, 2>(EastNorth(config_.wander_sigma_m)), sender.knots[0].data());
    for (std::size_t k = 1; k < knots; ++k) {
      add_prior(AutoDiff<WanderTerm, 2, 2>(wander_), sender.knots[k - 1].data(),
                sender.knots[k].data());
    }
    for (const BiasBlock& block : blocks.blocks) {
      // Knot `knots - 1` stands at the solve's own time.
      const double place =
          static_cast<double>(knots - 1) - ToSeconds(at - block.stamp) / config_.knot_s;
      const double clamped = std::clamp(place, 0.0, static_cast<double>(knots - 1) - 1e-9);
      const auto k = static_cast<std::size_t>(clamped);
      const Eigen::Matrix2d L = block.covariance.llt().matrixL();
      const Residual residual{block.mean_en, L.inverse(), clamped - static_cast<double>(k)};
      sender.residuals.push_back(problem_->AddResidualBlock(
          AutoDiff<Residual, 2, 2, 2, 2>(residual), &huber_, common_.data(), sender.constant.data(),
          sender.knots[k].data(), sender.knots[k + 1].data()));
    }
  }

  Part Reduce(Sender& sender) {
    ceres::Problem::EvaluateOptions options;
    options.num_threads = 1;
    options.parameter_blocks = {common_.data(), sender.constant.data()};
    for (Block& knot : sender.knots) options.parameter_blocks.push_back(knot.data());
    options.residual_blocks = sender.residuals;
    options.residual_blocks.insert(options.residual_blocks.end(), sender.priors.begin(),
                                   sender.priors.end());
    Part part;
    std::vector<double> r;
    ceres::CRSMatrix crs;
    problem_->Evaluate(options, nullptr, &r, nullptr, &crs);
    for (std::size_t i = 0; i < 2 * sender.residuals.size(); ++i) part.squares += r[i] * r[i];
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(crs.num_rows, crs.num_cols);
    for (int row = 0; row < crs.num_rows; ++row) {
      for (int i = crs.rows[static_cast<std::size_t>(row)];
           i < crs.rows[static_cast<std::size_t>(row) + 1]; ++i) {
        J(row, crs.cols[static_cast<std::size_t>(i)]) = crs.values[static_cast<std::size_t>(i)];
      }
    }
    const Eigen::VectorXd g = J.transpose() * Eigen::Map<const Eigen::VectorXd>(
                                                  r.data(), static_cast<Eigen::Index>(r.size()));
    part.H = J.transpose() * J;
    const Eigen::Index own = part.H.rows() - 2;
    const Eigen::LDLT<Eigen::MatrixXd> H_ll(part.H.bottomRightCorner(own, own));
    const Eigen::MatrixXd H_lc = part.H.bottomLeftCorner(own, 2);
    part.on_common = part.H.topLeftCorner<2, 2>() - H_lc.transpose() * H_ll.solve(H_lc);
    part.pull = g.head<2>() - H_lc.transpose() * H_ll.solve(g.tail(own));
    return part;
  }

  SenderSolution Read(const Sender& sender, const Part& part, const Eigen::Matrix2d& total) const {
    using Map = Eigen::Map<const Eigen::Vector2d>;
    SenderSolution out;
    out.bias.mean_en =
        Map(common_.data()) + Map(sender.constant.data()) + Map(sender.knots.back().data());
    // What the others and the prior say of the common part comes on top of its own information.
    const Eigen::Matrix2d others = total - part.on_common;
    Eigen::MatrixXd H = part.H;
    H.topLeftCorner<2, 2>() += others;
    Eigen::MatrixXd E = Eigen::MatrixXd::Zero(H.rows(), 2);
    E.topRows<2>().setIdentity();
    E.middleRows<2>(2).setIdentity();
    E.bottomRows<2>().setIdentity();
    out.bias.covariance = E.transpose() * H.ldlt().solve(E);

    double squares = 0.0;
    for (std::size_t k = 0; k < sender.knots.size(); ++k) {
      for (std::size_t i = 0; i < k; ++i) {
        out.change_m = std::max(out.change_m,
                                (Map(sender.knots[k].data()) - Map(sender.knots[i].data())).norm());
      }
      if (k == 0) continue;
      Eigen::Vector2d r;
      wander_(sender.knots[k - 1].data(), sender.knots[k].data(), r.data());
      squares += r.squaredNorm();
    }
    out.null_chi_square = squares / (2.0 * static_cast<double>(sender.knots.size() - 1));

    // One Newton step of the linear problem without this sender.
    const Eigen::Matrix2d without = others.inverse();
    const Eigen::Vector2d shift = without * part.pull;
    const Eigen::Matrix2d difference = without - total.inverse();
    out.leave_one_out = shift.dot(difference.ldlt().solve(shift));
    return out;
  }

  GpsBiasConfig config_;
  WanderTerm wander_;
  ceres::HuberLoss huber_;
  std::unique_ptr<ceres::Problem> problem_;
  Block common_{};
  std::vector<Sender> senders_;
};

}  // namespace

BiasSolution SolveBias(const std::vector<SenderBlocks>& senders, Timestamp at,
                       const GpsBiasConfig& config) {
  if (senders.empty()) return {};
  Window window(senders, at, config);
  if (!window.Solve()) return {};
  return window.Read(senders);
}

}  // namespace v2vouch
