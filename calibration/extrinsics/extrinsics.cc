// SPDX-License-Identifier: Apache-2.0
#include "calibration/extrinsics/extrinsics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <map>
#include <memory>

#include "calibration/extrinsics/camera_aim.h"
#include "calibration/extrinsics/information.h"
#include "calibration/extrinsics/verdicts.h"

namespace v2vouch {
namespace {

constexpr double kMoving_mps = 3.0;
constexpr std::size_t kLeastEgoSamples = 50;
constexpr double kLeastShare = 0.01;  // Of an estimate's variance; less is not listed.
// A group whose mean squared whitened residual is beyond these does not fit its model. Below: the
// stated noise is far too large, which misleads no one but wastes information.
constexpr double kMostChiSquare = 2.0;
// Vehicles that are no points: the cost's last digits are spent on where each reflects.
constexpr double kLeastExtendedTolerance = 2e-6;

struct Pass {
  DopplerSelection doppler;
  std::size_t every_window;  // Thinned: the first passes only have to come near.
  double pairing_gate_rad;
  bool doppler_loss;
  double tolerance;
  double from, to;  // Of all the work.
  const char* name;
};

const std::array<Pass, 3> kPasses = {{
    {.doppler = {.max_per_radar = 8'000, .slack_rad = FromDegrees(3.0), .slack_speed = 0.03},
     .every_window = 6,
     .pairing_gate_rad = 0.06,
     .doppler_loss = true,
     .tolerance = 1e-6,
     .from = 0.05,
     .to = 0.15,
     .name = "first solution"},
    {.doppler = {.max_per_radar = 15'000, .slack_rad = FromDegrees(0.1), .slack_speed = 0.002},
     .every_window = 4,
     .pairing_gate_rad = 0.025,
     .doppler_loss = false,
     .tolerance = 1e-6,
     .from = 0.15,
     .to = 0.35,
     .name = "second solution"},
    {.doppler = {.max_per_radar = 60'000},
     .every_window = 1,
     .pairing_gate_rad = 0.025,
     .doppler_loss = false,
     .tolerance = 2e-8,
     .from = 0.35,
     .to = 0.8,
     .name = "last solution"},
}};

Excitation ExcitationOf(const EgoTrack& ego, const DriveData& data) {
  Excitation e;
  if (ego.samples().empty()) return e;
  constexpr double kPause_s = 10.0;  // Longer ones lie between two logs.
  for (std::size_t i = 1; i < ego.samples().size(); ++i) {
    const double step_s = ToSeconds(ego.samples()[i].stamp - ego.samples()[i - 1].stamp);
    if (step_s <= kPause_s) e.duration_s += step_s;
  }
  double n = 0.0, v = 0.0, vv = 0.0, ww = 0.0;
  std::complex<double> heading;
  for (const EgoTrack::Sample& sample : ego.samples()) {
    if (sample.speed_mps < kMoving_mps) continue;
    n += 1.0;
    v += sample.speed_mps;
    vv += sample.speed_mps * sample.speed_mps;
    ww += sample.yaw_rate_radps * sample.yaw_rate_radps;
    heading += std::polar(1.0, sample.yaw_rad);
  }
  if (n > 0.0) {
    e.moving_s = e.duration_s * n / static_cast<double>(ego.samples().size());
    e.speed_rms_mps = std::sqrt(std::max(0.0, vv / n - v * v / (n * n)));
    e.yaw_rate_rms_radps = std::sqrt(ww / n);
    e.heading_resultant = std::abs(heading) / n;
  }
  e.static_returns = static_cast<int>(data.returns.size());
  double m = 0.0, b = 0.0, bb = 0.0, d = 0.0, dd = 0.0;
  for (const TargetWindow& window : data.windows) {
    if (window.camera_looks.empty()) continue;
    const double bearing = std::atan2(window.state[1], window.state[0]);
    const double inverse = 1.0 / std::max(1.0, std::hypot(window.state[0], window.state[1]));
    m += 1.0;
    b += bearing;
    bb += bearing * bearing;
    d += inverse;
    dd += inverse * inverse;
  }
  e.target_windows = static_cast<int>(m);
  if (m > 0.0) {
    e.bearing_spread_rad = std::sqrt(std::max(0.0, bb / m - b * b / (m * m)));
    e.inverse_range_spread_pm = std::sqrt(std::max(0.0, dd / m - d * d / (m * m)));
  }
  return e;
}

std::map<std::string, int> MessagesOf(const DriveLog& log, const VehicleConfig& vehicle) {
  std::map<std::string, int> messages;
  std::vector<std::string> radars, cameras;
  for (const RadarConfig& radar : vehicle.radars) {
    messages[radars.emplace_back("radar_" + LowerCaseName(radar.name))] = 0;
  }
  for (const CameraConfig& camera : vehicle.cameras) {
    messages[cameras.emplace_back("camera_" + LowerCaseName(camera.name))] = 0;
  }
  for (const RadarScan& scan : log.scans) ++messages[radars[static_cast<std::size_t>(scan.radar)]];
  for (const CameraDetections& picture : log.pictures) {
    ++messages[cameras[static_cast<std::size_t>(picture.camera)]];
  }
  messages["gnss"] = static_cast<int>(log.fixes.size());
  messages["gnss_heading"] = static_cast<int>(
      std::ranges::count_if(log.fixes, [](const GnssFix& fix) { return fix.yaw_rad.has_value(); }));
  return messages;
}

// The measurements that weigh most in an estimate.
std::string DeterminedBy(const MountingInformation& information,
                         const std::vector<std::string>& groups, int parameter) {
  Eigen::Index best = 0;
  information.shares.col(parameter).maxCoeff(&best);
  return groups[static_cast<std::size_t>(best)];
}

bool Fits(const std::string& sensor, const std::vector<GroupFit>& groups) {
  return std::ranges::none_of(groups, [&](const GroupFit& group) {
    return group.name.starts_with(sensor + ".") && group.robust_chi_square > kMostChiSquare;
  });
}

// What a pass works on, chosen with what the pass before it learnt.
void Select(const Pass& pass, bool is_first, MountingParameters& parameters, DriveData& data) {
  data.returns = SelectStaticReturns(*data.log, *data.ego, *data.vehicle, parameters, pass.doppler);
  const auto chains = ChainMovingReturns(*data.log, *data.ego, *data.vehicle, parameters);
  data.chains = chains.size();
  for (int camera = 0; is_first && camera < parameters.cameras(); ++camera) {
    AimCamera(*data.log, *data.ego, *data.vehicle, camera, chains, parameters);
  }
  data.windows =
      PairTargets(*data.log, *data.ego, *data.vehicle, parameters, chains, pass.pairing_gate_rad);
  std::size_t n = 0;
  std::erase_if(data.windows, [&](const TargetWindow&) { return n++ % pass.every_window != 0; });
}

// By group, where its noise is not white.
std::map<std::string, double> InflationOf(const MountingInformation& information,
                                          const std::vector<std::string>& groups) {
  std::map<std::string, double> inflation;
  for (std::size_t g = 0; information.S.size() > 0 && g < groups.size(); ++g) {
    const double of_group = information.inflation(static_cast<Eigen::Index>(g));
    if (of_group > 1.0) inflation[groups[g]] = of_group;
  }
  return inflation;
}

// Value, verdict and figures of parameter `i`, which takes the value that its verdict gives it.
MountingEstimate EstimateOf(int i, const HeldPosterior& held, const HeldPosterior& bound,
                            const MountingInformation& information,
                            const std::vector<std::string>& groups, MountingParameters& parameters,
                            const ExtrinsicsResult& result) {
  const auto& d = parameters.descriptions()[static_cast<std::size_t>(i)];
  MountingEstimate estimate;
  estimate.name = d.name;
  const double data_std = held.data_std(i) * information.std_factor(i);
  double value = held.values[static_cast<std::size_t>(i)];
  estimate.verdict = VerdictOf(parameters.values()[static_cast<std::size_t>(i)], data_std, d.prior,
                               d.prior_std, Fits(d.sensor, result.groups));
  if (d.is_anchor || d.is_considered) estimate.verdict = CalibrationVerdict::kPrior;
  if (estimate.verdict == CalibrationVerdict::kPrior) value = d.prior;
  parameters.values()[static_cast<std::size_t>(i)] = value;
  estimate.value = value * d.to_unit;
  estimate.prior = d.prior * d.to_unit;
  estimate.prior_std = d.prior_std * d.to_unit;
  estimate.std = std::sqrt(result.covariance(i, i)) * d.to_unit;
  if (estimate.verdict == CalibrationVerdict::kPrior) estimate.std = estimate.prior_std;
  estimate.crlb = bound.crlb(i) * d.to_unit;
  estimate.data_std = data_std * d.to_unit;
  estimate.determined_by = DeterminedBy(information, groups, i);
  estimate.block_std = information.block_std(i) * d.to_unit;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const double share = information.shares(static_cast<Eigen::Index>(g), i);
    if (share >= kLeastShare) estimate.shares.emplace_back(groups[g], share);
  }
  std::ranges::stable_sort(estimate.shares, std::greater{},
                           &std::pair<std::string, double>::second);
  estimate.hint = d.is_considered
                      ? "vehicles are no points: only targets at known places could tell more"
                      : HintFor(d.name, estimate.verdict, result.excitation);
  return estimate;
}

// The figures of the groups and of every parameter, and whether the result is accepted.
void Conclude(const MountingInformation& information, const MountingInformation& gaussian,
              const std::vector<std::string>& groups, MountingParameters& parameters,
              ExtrinsicsResult& result) {
  for (std::size_t g = 0; g < groups.size(); ++g) {
    result.groups.push_back(
        {groups[g], information.fits[g].equations, information.fits[g].chi_square_per_equation,
         gaussian.fits[g].robust_chi_square, information.inflation(static_cast<Eigen::Index>(g))});
  }
  const HeldPosterior held = HoldWeakDirections(information.S, information.doubts, parameters);
  const HeldPosterior bound = HoldWeakDirections(gaussian.S, gaussian.doubts, parameters);
  result.weak = held.weak;
  const Eigen::VectorXd& factor = information.std_factor;
  result.covariance = factor.asDiagonal() * held.covariance * factor.asDiagonal();
  bool knows_something = false;
  for (int i = 0; i < parameters.size(); ++i) {
    MountingEstimate estimate = EstimateOf(i, held, bound, information, groups, parameters, result);
    const auto& d = parameters.descriptions()[static_cast<std::size_t>(i)];
    if (estimate.verdict == CalibrationVerdict::kAtBound) {
      result.problems.push_back(d.name + " is farther from the vehicle file than 3 sigma of it");
    } else if (estimate.verdict == CalibrationVerdict::kRejected) {
      result.problems.push_back(d.name + ": the measurements of " + d.sensor +
                                " do not fit the model");
    } else if (estimate.verdict != CalibrationVerdict::kPrior) {
      knows_something = true;
    }
    result.parameters.push_back(std::move(estimate));
  }
  if (!knows_something) {
    result.problems.push_back("nothing could be estimated: every parameter stays at its prior");
  }
  result.mounting = parameters;
  result.accepted = result.problems.empty();
}

}  // namespace

ExtrinsicsResult CalibrateExtrinsics(const DriveLog& log, const VehicleConfig& vehicle,
                                     const ExtrinsicsOptions& options,
                                     const std::function<void(double, const char*)>& progress) {
  const auto tell = [&](double share, const char* what) {
    if (progress) progress(share, what);
  };
  MountingParameters parameters(vehicle, options.priors, options.point_targets);
  ExtrinsicsResult result(parameters);
  const EgoTrack ego(log.motion);
  if (ego.samples().size() < kLeastEgoSamples) {
    result.problems.push_back("no EGO_MOTION to calibrate from: under 50 samples");
    return result;
  }
  ProblemOptions problem_options;
  if (options.point_targets) problem_options.wander_m = problem_options.offset_m = 0.0;

  DriveData data{.log = &log, .ego = &ego, .vehicle = &vehicle, .returns = {}, .windows = {}};
  std::unique_ptr<DriveProblem> problem;
  const auto solve = [&](double from, double to, const char* name) {
    problem = std::make_unique<DriveProblem>(data, parameters, problem_options);
    const bool is_usable = problem->Solve(
        [&](int iteration) { tell(from + (to - from) * std::min(1.0, iteration / 15.0), name); });
    if (!is_usable) result.problems.push_back(std::string("no usable ") + name);
    return is_usable;
  };
  for (std::size_t i = 0; i < kPasses.size(); ++i) {
    const Pass& pass = kPasses[i];
    tell(pass.from, pass.name);
    Select(pass, i == 0, parameters, data);
    problem_options.doppler_loss = pass.doppler_loss;
    problem_options.tolerance =
        options.point_targets ? pass.tolerance : std::max(pass.tolerance, kLeastExtendedTolerance);
    if (!solve(pass.from, pass.to, pass.name)) return result;
  }
  // Correlated measurements weigh what they are worth, or the prior would be outvoted by
  // repetition.
  MountingInformation information = Reduce(*problem, parameters, true);
  problem_options.inflation = InflationOf(information, problem->groups());
  const bool is_weighed = !problem_options.inflation.empty();
  if (is_weighed && !solve(0.8, 0.95, "weighed solution")) return result;
  tell(0.95, "observability");
  if (is_weighed) information = Reduce(*problem, parameters, true);
  result.pictures = DrawResiduals(data, *problem, parameters);
  result.excitation = ExcitationOf(ego, data);
  result.excitation.messages = MessagesOf(log, vehicle);
  const MountingInformation gaussian = Reduce(*problem, parameters, false);
  if (information.S.size() == 0 || gaussian.S.size() == 0) {
    result.problems.push_back("the equations have no unique solution");
    return result;
  }
  Conclude(information, gaussian, problem->groups(), parameters, result);
  tell(1.0, "done");
  return result;
}

}  // namespace v2vouch
