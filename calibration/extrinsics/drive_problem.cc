// SPDX-License-Identifier: Apache-2.0
#include "calibration/extrinsics/drive_problem.h"

#include <ceres/ceres.h>

#include <utility>

#include "calibration/extrinsics/drive_equations.h"

namespace v2vouch {
namespace {

constexpr int kThreads = 2;

class Progress final : public ceres::IterationCallback {
 public:
  explicit Progress(const std::function<void(int)>& tell) : tell_(tell) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (tell_) tell_(summary.iteration);
    return ceres::SOLVER_CONTINUE;
  }

 private:
  const std::function<void(int)>& tell_;
};

}  // namespace

DriveProblem::DriveProblem(const DriveData& data, MountingParameters& parameters,
                           const ProblemOptions& options)
    : equations_(std::make_unique<DriveEquations>(data, parameters, options)) {}
DriveProblem::~DriveProblem() = default;

bool DriveProblem::Solve(const std::function<void(int)>& progress) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  options.max_num_iterations = equations_->options.iterations;
  options.function_tolerance = equations_->options.tolerance;
  options.num_threads = kThreads;
  options.logging_type = ceres::SILENT;
  options.initial_trust_region_radius = 1e8;  // The start is near, and damping slows it down.
  Progress callback(progress);
  options.callbacks.push_back(&callback);
  ceres::Solver::Summary summary;
  ceres::Solve(options, equations_->problem.get(), &summary);
  return summary.IsSolutionUsable();
}

const std::vector<std::array<double, 4>>& DriveProblem::targets() const {
  return equations_->targets;
}
const std::vector<std::string>& DriveProblem::groups() const { return equations_->groups; }
const std::vector<Equation>& DriveProblem::equations() const { return equations_->equations; }
double DriveProblem::weighed_inflation(int group) const { return equations_->InflationOf(group); }
std::vector<DriveProblem::Considered> DriveProblem::considered() const {
  std::vector<Considered> all;
  int column = 0;
  for (const double* block : equations_->blocks) {
    for (const auto& one : equations_->considered) {
      if (one.block != block) continue;
      all.push_back({column + one.index, one.sigma, DriveEquations::kHeld * one.sigma});
    }
    column += equations_->problem->ParameterBlockSize(block);
  }
  return all;
}
int DriveProblem::prior_equations() const { return equations_->priors; }

DriveProblem::Linear DriveProblem::Linearised(bool with_loss) const {
  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks = equations_->blocks;
  options.residual_blocks = equations_->ids;
  options.apply_loss_function = with_loss;
  options.num_threads = kThreads;
  Linear linear;
  ceres::CRSMatrix crs;
  equations_->problem->Evaluate(options, nullptr, &linear.residuals, nullptr, &crs);
  linear.row_begin = std::move(crs.rows);
  linear.columns = std::move(crs.cols);
  linear.values = std::move(crs.values);
  linear.unknowns = crs.num_cols;
  return linear;
}

}  // namespace v2vouch
