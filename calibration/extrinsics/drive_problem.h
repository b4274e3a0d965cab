// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "calibration/extrinsics/drive_log.h"
#include "calibration/extrinsics/ego_track.h"
#include "calibration/extrinsics/mounting_parameters.h"
#include "calibration/extrinsics/static_doppler.h"
#include "calibration/extrinsics/target_windows.h"
#include "daemon/common/data/vehicle.h"

namespace v2vouch {

/// What one drive says about the mounting, ready to be put into equations.
struct DriveData {
  const DriveLog* log = nullptr;
  const EgoTrack* ego = nullptr;
  const VehicleConfig* vehicle = nullptr;
  std::vector<StaticReturn> returns;
  std::vector<TargetWindow> windows;
  std::size_t chains = 0;  ///< Radar chains that the windows' looks are from.
};

struct ProblemOptions {
  bool doppler_loss = true;  ///< Cauchy on Doppler, too; off once it has been gated.
  double cauchy = 2.385;     ///< 95 % efficient on one-dimensional Gaussian residuals.
  /// Reflections of a vehicle wander about it, and a box's foot is not where they come from: 1
  /// sigma of each look along and across, and of what stays the same over a chain. 0 for point
  /// targets.
  double wander_m = 0.4;
  double offset_m = 0.4;
  double shape_m = 1.5;  ///< What is the same for all vehicles under one aspect.
  /// What stays the same for all that one radar sees, whatever the aspect: along and across the
  /// ray, and in proportion to the range.
  double lean_along_m = 0.6;
  double lean_across_m = 0.2;
  double lean_range = 0.03;
  double lean_rad = FromDegrees(0.1);
  /// Groups whose noise is correlated: by what their variance in blocks exceeds white noise
  /// (MountingInformation::inflation). Their equations weigh so much less.
  std::map<std::string, double> inflation;
  int iterations = 40;
  double tolerance = 2e-8;  ///< Of the cost, relative, from one iteration to the next.
};

/// One scalar equation: from which measurements, when, and how big its residual is at the solution.
struct Equation {
  int group = 0;  ///< Index into DriveProblem::groups().
  double time_s = 0.0;
};

struct DriveEquations;  // How they are made.

/// The equations of a drive as one sparse non-linear least-squares problem, every residual
/// whitened: priors of the mounting; per odometry sample that is used its true speed and yaw rate,
/// measured by odometer, gyro, GNSS velocity turned into the body by GNSS heading, and the static
/// returns' Doppler; per target window place and velocity, measured by radars and cameras; per
/// picture the body's nod. GNSS positions are not used: their error is correlated over minutes and
/// says less of the lever arm than velocity in turns.
class DriveProblem {
 public:
  DriveProblem(const DriveData& data, MountingParameters& parameters,
               const ProblemOptions& options);
  ~DriveProblem();
  DriveProblem(const DriveProblem&) = delete;
  DriveProblem& operator=(const DriveProblem&) = delete;

  /// Solves from where `parameters` stand, and leaves the solution there.
  /// @param progress called with the iteration's number.
  /// @return false when the solver found no usable solution.
  bool Solve(const std::function<void(int)>& progress);

  /// Place and velocity of every window's target as solved, in the windows' order.
  [[nodiscard]] const std::vector<std::array<double, 4>>& targets() const;
  [[nodiscard]] const std::vector<std::string>& groups() const;
  [[nodiscard]] const std::vector<Equation>& equations() const;  ///< Priors first.
  [[nodiscard]] int prior_equations() const;

  /// An unknown of the targets that is held at 0 although it is known with `sigma` only.
  struct Considered {
    int column = 0;  ///< Of Linearised().
    double sigma = 0.0;
    double held_sigma = 0.0;  ///< Its equation's.
  };
  [[nodiscard]] std::vector<Considered> considered() const;
  /// By how much a group's variance was taken for larger than stated.
  [[nodiscard]] double weighed_inflation(int group) const;

  /// The whitened equations at the current values: row i of the Jacobian belongs to equations()[i];
  /// columns are the parameters in their order, then everything else.
  struct Linear {
    std::vector<double> residuals;
    std::vector<int> row_begin;  ///< Of row i; one more at the end.
    std::vector<int> columns;
    std::vector<double> values;
    int unknowns = 0;  ///< Columns in all.
  };
  /// @param with_loss rows weighted by the loss, as the solver saw them.
  [[nodiscard]] Linear Linearised(bool with_loss) const;

 private:
  std::unique_ptr<DriveEquations> equations_;
};

}  // namespace v2vouch
