// SPDX-License-Identifier: Apache-2.0
#include "calibration/extrinsics/drive_problem.h"

#include <ceres/ceres.h>

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "calibration/extrinsics/drive_costs.h"
#include "calibration/extrinsics/white_noise.h"

namespace v2vouch {
namespace {

constexpr int kThreads = 2;
constexpr double kMinSpeed_mps = 2.0;  // Slower, the direction of GNSS velocity says little.

template <class Cost, int... kSizes>
ceres::CostFunction* AutoDiff(const Cost& cost) {
  return new ceres::AutoDiffCostFunction<Cost, 1, kSizes...>(new Cost(cost));
}

// The direction a window's target moves in, against the ray from the ego to it.
Aspect AspectOf(const TargetWindow& window, const LookPose& pose) {
  const double ray = std::atan2(window.state[1] + pose.dt_s * window.state[3] - pose.y_m,
                                window.state[0] + pose.dt_s * window.state[2] - pose.x_m);
  const double aspect = std::atan2(window.state[3], window.state[2]) - ray;
  return {std::cos(aspect), std::cos(2.0 * aspect), std::sin(aspect), std::sin(2.0 * aspect)};
}

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

struct DriveProblem::State {
  State(const DriveData& d, MountingParameters& p, const ProblemOptions& o)
      : data(d), parameters(p), options(o), cauchy(o.cauchy) {
    ceres::Problem::Options problem_options;
    problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    problem = std::make_unique<ceres::Problem>(problem_options);
    epochs.resize(data.ego->samples().size());
    targets.resize(data.windows.size());
    offsets.resize(data.chains);
    nods.resize(data.log->pictures.size());
    AddPriors();
    AddDoppler();
    AddGnss();
    AddTargets();
  }

  // The index of a group of equations, made when first met.
  int Group(const std::string& name) {
    const auto [it, is_new] = group_of.try_emplace(name, static_cast<int>(groups.size()));
    if (is_new) groups.push_back(name);
    return it->second;
  }

  [[nodiscard]] double SecondsOf(Timestamp t) const {
    return ToSeconds(t - data.ego->samples().front().stamp);
  }

  // The loss of a group's equations, scaled where its noise is correlated.
  ceres::LossFunction* Weighed(ceres::LossFunction* loss, int group) {
    const double inflation = InflationOf(group);
    if (inflation <= 1.0) return loss;
    auto& weighed = weighed_losses[{group, loss}];
    if (!weighed) {
      weighed =
          std::make_unique<ceres::ScaledLoss>(loss, 1.0 / inflation, ceres::DO_NOT_TAKE_OWNERSHIP);
    }
    return weighed.get();
  }
  [[nodiscard]] double InflationOf(int group) const {
    const auto at = options.inflation.find(groups[static_cast<std::size_t>(group)]);
    return at == options.inflation.end() ? 1.0 : at->second;
  }

  template <class... Blocks>
  void Add(ceres::CostFunction* cost, ceres::LossFunction* loss, int group, double time_s,
           Blocks*... unknowns) {
    ids.push_back(problem->AddResidualBlock(cost, Weighed(loss, group), unknowns...));
    equations.push_back({group, time_s});
  }

  void AddPriors() {
    const int group = Group("prior");
    const auto& descriptions = parameters.descriptions();
    const auto add = [&]<int kSize>(double* block, int at) {
      for (int i = 0; i < kSize; ++i) {
        const auto& d = descriptions[static_cast<std::size_t>(at + i)];
        Add(AutoDiff<PriorCost, kSize>({i, d.prior, d.equation_std()}), nullptr, group, 0.0, block);
      }
      blocks.push_back(block);
    };
    for (int i = 0; i < parameters.radars(); ++i) {
      add.template operator()<MountingParameters::kPerRadar>(parameters.Radar(i),
                                                             parameters.RadarAt(i));
    }
    for (int i = 0; i < parameters.cameras(); ++i) {
      add.template operator()<MountingParameters::kPerCamera>(parameters.Camera(i),
                                                              parameters.CameraAt(i));
    }
    add.template operator()<MountingParameters::kEgo>(parameters.Ego(), parameters.EgoAt());
    priors = static_cast<int>(ids.size());
  }

  // The unknowns of an odometry sample, with its own two measurements when first asked for.
  double* Epoch(std::size_t index) {
    auto& epoch = epochs[index];
    if (!epoch) {
      const EgoTrack::Sample& sample = data.ego->samples()[index];
      const double* ego = parameters.Ego();
      epoch = {sample.speed_mps / ego[MountingParameters::kSpeedScale],
               sample.yaw_rate_radps - ego[MountingParameters::kYawRateBias]};
      blocks.push_back(epoch->data());
      Add(AutoDiff<SpeedCost, 2, MountingParameters::kEgo>(
              {sample.speed_mps, data.ego->speed_sigma_mps()}),
          &cauchy, Group("odometry.speed"), SecondsOf(sample.stamp), epoch->data(),
          parameters.Ego());
      Add(AutoDiff<YawRateCost, 2, MountingParameters::kEgo>(
              {sample.yaw_rate_radps, data.ego->yaw_rate_sigma_radps()}),
          &cauchy, Group("odometry.yaw_rate"), SecondsOf(sample.stamp), epoch->data(),
          parameters.Ego());
    }
    return epoch->data();
  }

  [[nodiscard]] std::string RadarName(int radar) const {
    return parameters.descriptions()[static_cast<std::size_t>(parameters.RadarAt(radar))].sensor;
  }
  [[nodiscard]] std::string CameraName(int camera) const {
    return parameters.descriptions()[static_cast<std::size_t>(parameters.CameraAt(camera))].sensor;
  }

  void AddDoppler() {
    for (const StaticReturn& one : data.returns) {
      const RadarConfig& radar = data.vehicle->radars[static_cast<std::size_t>(one.radar)];
      double* const epoch = Epoch(one.epoch);
      Add(new DopplerCost(ResidualOf(one, *data.ego, radar)),
          options.doppler_loss ? &cauchy : nullptr, Group(RadarName(one.radar) + ".doppler"),
          SecondsOf(data.ego->samples()[one.epoch].stamp), parameters.Radar(one.radar), epoch,
          parameters.Ego());
    }
  }

  // What reflections of all vehicles have in common, with its prior when first asked for.
  double* Shape(double time_s) {
    if (!shape) {
      shape.emplace();
      blocks.push_back(shape->data());
      for (int i = 0; i < kShape; ++i) {
        Add(AutoDiff<PriorCost, kShape>({i, 0.0, options.shape_m}), nullptr, Group("shape"), time_s,
            shape->data());
      }
    }
    return shape->data();
  }

  void AddGnss();
  void AddGyroDrift(double heading_sigma);
  void AddTargets();

  const DriveData& data;
  MountingParameters& parameters;
  ProblemOptions options;
  ceres::CauchyLoss cauchy;
  std::map<std::pair<int, ceres::LossFunction*>, std::unique_ptr<ceres::LossFunction>>
      weighed_losses;
  std::unique_ptr<ceres::Problem> problem;
  std::vector<std::optional<std::array<double, 2>>> epochs;   // Speed, yaw rate.
  std::vector<std::array<double, 4>> targets;                 // Place, velocity.
  std::vector<std::optional<std::array<double, 2>>> offsets;  // Per chain: along, across.
  std::optional<std::array<double, kShape>> shape;
  std::vector<std::optional<double>> nods;    // Per picture.
  std::vector<std::optional<double>> drifts;  // Heading minus gyro, per knot.
  std::vector<double*> blocks;                // In the order of the Jacobian's columns.
  std::vector<ceres::ResidualBlockId> ids;
  std::vector<Equation> equations;
  std::vector<std::string> groups;
  std::map<std::string, int> group_of;
  int priors = 0;
};

void DriveProblem::State::AddGnss() {
  // White noise of heading and speed, against the odometry's smooth signals.
  std::vector<double> headings, speeds, heading_sigmas, speed_sigmas;
  for (const GnssFix& fix : data.log->fixes) {
    const Timestamp t = fix.stamp - FromSeconds(data.vehicle->gnss_latency_s);
    const auto nearest = data.ego->Nearest(t);
    if (!nearest || !fix.velocity_en_mps ||
        data.ego->samples()[*nearest].speed_mps < kMinSpeed_mps) {
      continue;
    }
    const EgoTrack::Sample& sample = data.ego->samples()[*nearest];
    speeds.push_back(fix.velocity_en_mps->norm() - sample.speed_mps);
    speed_sigmas.push_back(fix.velocity_sigma_mps);
    if (fix.yaw_rad) {
      const double off = *fix.yaw_rad - data.ego->At(t)->yaw_rad;
      headings.push_back(
          headings.empty() ? off : headings.back() + AngleDifference(off, headings.back()));
      heading_sigmas.push_back(fix.yaw_sigma_rad);
    }
  }
  const double speed_sigma = WhiteSigmaWithin(speeds, std::move(speed_sigmas), 0.1);
  const double heading_sigma =
      WhiteSigmaWithin(headings, std::move(heading_sigmas), FromDegrees(0.5));

  for (const GnssFix& fix : data.log->fixes) {
    const Timestamp t = fix.stamp - FromSeconds(data.vehicle->gnss_latency_s);
    const auto nearest = data.ego->Nearest(t);
    if (!nearest || !fix.velocity_en_mps) continue;
    const EgoTrack::Sample& sample = data.ego->samples()[*nearest];
    const Eigen::Vector2d& velocity = *fix.velocity_en_mps;
    if (sample.speed_mps < kMinSpeed_mps || velocity.norm() < kMinSpeed_mps) continue;
    // Without a heading the body is taken to point along the velocity: the length alone speaks.
    const double yaw = fix.yaw_rad ? *fix.yaw_rad : std::atan2(velocity.y(), velocity.x());
    GnssVelocityCost cost{.velocity_e = velocity.x(),
                          .velocity_n = velocity.y(),
                          .yaw_rad = yaw,
                          .dt_s = ToSeconds(t - sample.stamp),
                          .accel_mps2 = sample.accel_mps2,
                          .yaw_accel_radps2 = sample.yaw_accel_radps2,
                          .sigma_mps = speed_sigma,
                          .across = false};
    double* const epoch = Epoch(*nearest);
    Add(AutoDiff<GnssVelocityCost, 2, MountingParameters::kEgo>(cost), &cauchy,
        Group("gnss.velocity"), SecondsOf(t), epoch, parameters.Ego());
    if (!fix.yaw_rad) continue;
    cost.across = true;
    cost.sigma_mps = std::hypot(speed_sigma, velocity.norm() * heading_sigma);
    Add(AutoDiff<GnssVelocityCost, 2, MountingParameters::kEgo>(cost), &cauchy,
        Group("gnss.heading"), SecondsOf(t), epoch, parameters.Ego());
  }
  AddGyroDrift(heading_sigma);
}

// Single headings say nothing of the gyro's bias; their drift against its integral does. Where the
// receiver has no heading, its course on straight stretches serves.
void DriveProblem::State::AddGyroDrift(double heading_sigma) {
  constexpr double kKnot_s = 5.0;
  constexpr double kStraight_radps = 0.02;
  const auto& samples = data.ego->samples();
  const double sample_s = ToSeconds(samples.back().stamp - samples.front().stamp) /
                          static_cast<double>(samples.size() - 1);
  const double walk = data.ego->yaw_rate_sigma_radps() * std::sqrt(sample_s * kKnot_s);
  drifts.resize(static_cast<std::size_t>(SecondsOf(samples.back().stamp) / kKnot_s) + 2);
  const auto knot = [&](std::size_t k, double start) {
    if (!drifts[k]) {
      drifts[k] = start;
      blocks.push_back(&*drifts[k]);
    }
    return &*drifts[k];
  };
  std::optional<double> last;
  for (const GnssFix& fix : data.log->fixes) {
    const Timestamp t = fix.stamp - FromSeconds(data.vehicle->gnss_latency_s);
    const auto place = data.ego->At(t);
    if (!place || t < samples.front().stamp || t > samples.back().stamp) continue;
    double yaw = 0.0;
    double sigma = heading_sigma;
    if (fix.yaw_rad) {
      yaw = *fix.yaw_rad;
    } else if (fix.velocity_en_mps && fix.velocity_en_mps->norm() > kMinSpeed_mps &&
               std::abs(samples[*data.ego->Nearest(t)].yaw_rate_radps) < kStraight_radps) {
      yaw = std::atan2(fix.velocity_en_mps->y(), fix.velocity_en_mps->x());
      sigma = std::max(heading_sigma, fix.velocity_sigma_mps / fix.velocity_en_mps->norm());
    } else {
      continue;
    }
    const double off = yaw - place->yaw_rad;
    const double drift = last ? *last + AngleDifference(off, *last) : off;
    last = drift;
    const double at = SecondsOf(t) / kKnot_s;
    const auto k = static_cast<std::size_t>(at);
    double* const from = knot(k, drift);
    double* const to = knot(k + 1, drift);
    Add(AutoDiff<HeadingDriftCost, 1, 1>({drift, sigma, at - static_cast<double>(k)}), &cauchy,
        Group("gnss.heading"), SecondsOf(t), from, to);
  }
  for (std::size_t k = 0; k + 1 < drifts.size(); ++k) {
    if (!drifts[k] || !drifts[k + 1]) continue;
    Add(AutoDiff<GyroDriftCost, 1, 1, MountingParameters::kEgo>({kKnot_s, walk}), &cauchy,
        Group("odometry.yaw_rate"), kKnot_s * static_cast<double>(k), &*drifts[k], &*drifts[k + 1],
        parameters.Ego());
  }
}

void DriveProblem::State::AddTargets() {
  for (std::size_t i = 0; i < data.windows.size(); ++i) {
    const TargetWindow& window = data.windows[i];
    auto& target = targets[i];
    std::copy(std::begin(window.state), std::end(window.state), target.begin());
    blocks.push_back(target.data());
    const double time_s = SecondsOf(window.middle);
    for (const auto& look : window.radar_looks) {
      const RadarConfig& radar = data.vehicle->radars[static_cast<std::size_t>(look.radar)];
      const int range_group = Group(RadarName(look.radar) + ".target_range");
      const int azimuth_group = Group(RadarName(look.radar) + ".target_azimuth");
      const double across_m = options.wander_m;
      const Aspect aspect = AspectOf(window, look.pose);
      const RadarTargetCost range{.pose = look.pose,
                                  .measured = look.range_m,
                                  .sigma = std::hypot(radar.range_sigma_m, across_m),
                                  .is_azimuth = false,
                                  .aspect = aspect};
      const RadarTargetCost azimuth{
          .pose = look.pose,
          .measured = look.azimuth_rad,
          .sigma = std::hypot(radar.azimuth_sigma_rad, across_m / std::max(1.0, look.range_m)),
          .is_azimuth = true,
          .aspect = aspect};
      constexpr int kR = MountingParameters::kPerRadar;
      if (options.offset_m <= 0.0) {
        Add(AutoDiff<RadarTargetCost, kR, 4>(range), &cauchy, range_group, time_s,
            parameters.Radar(look.radar), target.data());
        Add(AutoDiff<RadarTargetCost, kR, 4>(azimuth), &cauchy, azimuth_group, time_s,
            parameters.Radar(look.radar), target.data());
        continue;
      }
      auto& offset = offsets[look.chain];
      if (!offset) {
        offset = {0.0, 0.0};
        blocks.push_back(offset->data());
        for (int k = 0; k < 2; ++k) {
          Add(AutoDiff<PriorCost, 2>({k, 0.0, options.offset_m}), nullptr,
              k == 0 ? range_group : azimuth_group, time_s, offset->data());
        }
      }
      double* const of_all = Shape(time_s);
      Add(AutoDiff<RadarTargetCost, kR, 4, 2, kShape>(range), &cauchy, range_group, time_s,
          parameters.Radar(look.radar), target.data(), offset->data(), of_all);
      Add(AutoDiff<RadarTargetCost, kR, 4, 2, kShape>(azimuth), &cauchy, azimuth_group, time_s,
          parameters.Radar(look.radar), target.data(), offset->data(), of_all);
    }
    for (const auto& look : window.camera_looks) {
      const CameraConfig& camera = data.vehicle->cameras[static_cast<std::size_t>(look.camera)];
      auto& nod = nods[look.picture];
      if (!nod) {
        nod = 0.0;
        blocks.push_back(&*nod);
        Add(AutoDiff<PriorCost, 1>({0, 0.0, camera.pitch_sigma_rad}), nullptr,
            Group(CameraName(look.camera) + ".nod"), time_s, &*nod);
      }
      for (const bool is_row : {false, true}) {
        Add(AutoDiff<BoxCost, MountingParameters::kPerCamera, 4, 1>(
                {&camera, look.pose, is_row ? look.v_px : look.u_px, camera.edge_sigma_px, is_row}),
            &cauchy, Group(CameraName(look.camera) + (is_row ? ".box_row" : ".box_column")), time_s,
            parameters.Camera(look.camera), target.data(), &*nod);
      }
    }
  }
}

DriveProblem::DriveProblem(const DriveData& data, MountingParameters& parameters,
                           const ProblemOptions& options)
    : state_(std::make_unique<State>(data, parameters, options)) {}
DriveProblem::~DriveProblem() = default;

bool DriveProblem::Solve(const std::function<void(int)>& progress) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  options.max_num_iterations = state_->options.iterations;
  options.function_tolerance = state_->options.tolerance;
  options.num_threads = kThreads;
  options.logging_type = ceres::SILENT;
  options.initial_trust_region_radius = 1e8;  // The start is near, and damping slows it down.
  Progress callback(progress);
  options.callbacks.push_back(&callback);
  ceres::Solver::Summary summary;
  ceres::Solve(options, state_->problem.get(), &summary);
  return summary.IsSolutionUsable();
}

const std::vector<std::array<double, 4>>& DriveProblem::targets() const { return state_->targets; }
const std::vector<std::string>& DriveProblem::groups() const { return state_->groups; }
const std::vector<Equation>& DriveProblem::equations() const { return state_->equations; }
double DriveProblem::weighed_inflation(int group) const { return state_->InflationOf(group); }
int DriveProblem::prior_equations() const { return state_->priors; }

DriveProblem::Linear DriveProblem::Linearised(bool with_loss) const {
  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks = state_->blocks;
  options.residual_blocks = state_->ids;
  options.apply_loss_function = with_loss;
  options.num_threads = kThreads;
  Linear linear;
  ceres::CRSMatrix crs;
  state_->problem->Evaluate(options, nullptr, &linear.residuals, nullptr, &crs);
  linear.row_begin = std::move(crs.rows);
  linear.columns = std::move(crs.cols);
  linear.values = std::move(crs.values);
  linear.unknowns = crs.num_cols;
  return linear;
}

}  // namespace v2vouch
