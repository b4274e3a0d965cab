// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/ceres.h>

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibration/extrinsics/drive_costs.h"
#include "calibration/extrinsics/drive_problem.h"

namespace v2vouch {

/// A cost (drive_costs.h) as Ceres takes it.
template <class Cost, int... kSizes>
ceres::CostFunction* AutoDiff(const Cost& cost) {
  return new ceres::AutoDiffCostFunction<Cost, 1, kSizes...>(new Cost(cost));
}

/// The equations and unknowns of a DriveProblem as it makes them: one kind of measurement after the
/// other, each unknown when the first equation asks for it.
struct DriveEquations {
  DriveEquations(const DriveData& drive, MountingParameters& mounting, const ProblemOptions& given);

  /// The index of a group of equations, made when first met.
  int Group(const std::string& name);
  /// By how much a group's variance is taken for larger than stated.
  [[nodiscard]] double InflationOf(int group) const;
  [[nodiscard]] std::string RadarName(int radar) const;
  [[nodiscard]] std::string CameraName(int camera) const;
  /// Since the first odometry sample.
  [[nodiscard]] double SecondsOf(Timestamp t) const;

  template <class... Blocks>
  void Add(ceres::CostFunction* cost, ceres::LossFunction* loss, int group, double time_s,
           Blocks*... unknowns) {
    ids.push_back(problem->AddResidualBlock(cost, Weighed(loss, group), unknowns...));
    equations.push_back({group, time_s});
  }

  /// The loss of a group's equations, scaled where its noise is correlated.
  ceres::LossFunction* Weighed(ceres::LossFunction* loss, int group);
  /// The unknowns of an odometry sample, with its own two measurements when first asked for.
  double* Epoch(std::size_t index);
  /// What reflections of all vehicles have in common, with its prior when first asked for.
  double* Shape(double time_s);
  /// What reflections that one radar sees have in common, held at 0.
  double* Lean(int radar, double time_s);

  void AddPriors();
  void AddDoppler();
  void AddGnss();
  void AddGyroDrift(double heading_sigma);
  void AddTargets();
  void AddRadarTarget(const TargetWindow& window, const TargetWindow::RadarLook& look,
                      double* target);
  void AddCameraTarget(const TargetWindow& window, const TargetWindow::CameraLook& look,
                       double* target);

  const DriveData& data;
  MountingParameters& parameters;
  ProblemOptions options;
  ceres::CauchyLoss cauchy;
  std::map<std::pair<int, ceres::LossFunction*>, std::unique_ptr<ceres::LossFunction>>
      weighed_losses;
  std::unique_ptr<ceres::Problem> problem;
  std::vector<std::optional<std::array<double, 2>>> epochs;   ///< Speed, yaw rate.
  std::vector<std::array<double, 4>> targets;                 ///< Place, velocity.
  std::vector<std::optional<std::array<double, 2>>> offsets;  ///< Per chain: along, across.
  std::optional<std::array<double, kShape>> shape;
  std::vector<std::optional<std::array<double, kLean>>> leans;  ///< Per radar.
  struct Considered {
    const double* block;
    int index;
    double sigma;
  };
  /// Sigma of what is considered, as an equation, against what is known of it.
  static constexpr double kHeld = 1e-4;
  std::vector<Considered> considered;
  std::vector<std::optional<double>> nods;    ///< Per picture.
  std::vector<std::optional<double>> drifts;  ///< Heading minus gyro, per knot.
  std::vector<double*> blocks;                ///< In the order of the Jacobian's columns.
  std::vector<ceres::ResidualBlockId> ids;
  std::vector<Equation> equations;
  std::vector<std::string> groups;
  std::map<std::string, int> group_of;
  int priors = 0;
};

}  // namespace v2vouch
