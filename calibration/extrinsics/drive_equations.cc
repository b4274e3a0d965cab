// SPDX-License-Identifier: Apache-2.0
#include "calibration/extrinsics/drive_equations.h"

namespace v2vouch {

DriveEquations::DriveEquations(const DriveData& drive, MountingParameters& mounting,
                               const ProblemOptions& given)
    : data(drive), parameters(mounting), options(given), cauchy(given.cauchy) {
  ceres::Problem::Options problem_options;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem = std::make_unique<ceres::Problem>(problem_options);
  epochs.resize(data.ego->samples().size());
  targets.resize(data.windows.size());
  offsets.resize(data.chains);
  leans.resize(data.vehicle->radars.size());
  nods.resize(data.log->pictures.size());
  AddPriors();
  AddDoppler();
  AddGnss();
  AddTargets();
}

int DriveEquations::Group(const std::string& name) {
  const auto [it, is_new] = group_of.try_emplace(name, static_cast<int>(groups.size()));
  if (is_new) groups.push_back(name);
  return it->second;
}

double DriveEquations::SecondsOf(Timestamp t) const {
  return ToSeconds(t - data.ego->samples().front().stamp);
}

ceres::LossFunction* DriveEquations::Weighed(ceres::LossFunction* loss, int group) {
  const double inflation = InflationOf(group);
  if (inflation <= 1.0) return loss;
  auto& weighed = weighed_losses[{group, loss}];
  if (!weighed) {
    weighed =
        std::make_unique<ceres::ScaledLoss>(loss, 1.0 / inflation, ceres::DO_NOT_TAKE_OWNERSHIP);
  }
  return weighed.get();
}

double DriveEquations::InflationOf(int group) const {
  const auto at = options.inflation.find(groups[static_cast<std::size_t>(group)]);
  return at == options.inflation.end() ? 1.0 : at->second;
}

std::string DriveEquations::RadarName(int radar) const {
  return parameters.descriptions()[static_cast<std::size_t>(parameters.RadarAt(radar))].sensor;
}

std::string DriveEquations::CameraName(int camera) const {
  return parameters.descriptions()[static_cast<std::size_t>(parameters.CameraAt(camera))].sensor;
}

void DriveEquations::AddPriors() {
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

double* DriveEquations::Epoch(std::size_t index) {
  auto& epoch = epochs[index];
  if (!epoch) {
    const EgoTrack::Sample& sample = data.ego->samples()[index];
    const double* ego = parameters.Ego();
    epoch = {sample.speed_mps / ego[MountingParameters::kSpeedScale],
             sample.yaw_rate_radps - ego[MountingParameters::kYawRateBias]};
    blocks.push_back(epoch->data());
    Add(AutoDiff<SpeedCost, 2, MountingParameters::kEgo>(
            {sample.speed_mps, data.ego->speed_sigma_mps()}),
        &cauchy, Group("odometry.speed"), SecondsOf(sample.stamp), epoch->data(), parameters.Ego());
    Add(AutoDiff<YawRateCost, 2, MountingParameters::kEgo>(
            {sample.yaw_rate_radps, data.ego->yaw_rate_sigma_radps()}),
        &cauchy, Group("odometry.yaw_rate"), SecondsOf(sample.stamp), epoch->data(),
        parameters.Ego());
  }
  return epoch->data();
}

void DriveEquations::AddDoppler() {
  for (const StaticReturn& one : data.returns) {
    const RadarConfig& radar = data.vehicle->radars[static_cast<std::size_t>(one.radar)];
    double* const epoch = Epoch(one.epoch);
    Add(new DopplerCost(ResidualOf(one, *data.ego, radar)),
        options.doppler_loss ? &cauchy : nullptr, Group(RadarName(one.radar) + ".doppler"),
        SecondsOf(data.ego->samples()[one.epoch].stamp), parameters.Radar(one.radar), epoch,
        parameters.Ego());
  }
}

double* DriveEquations::Shape(double time_s) {
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

double* DriveEquations::Lean(int radar, double time_s) {
  auto& lean = leans[static_cast<std::size_t>(radar)];
  if (!lean) {
    lean.emplace();
    blocks.push_back(lean->data());
    const double sigmas[kLean] = {options.lean_along_m,  options.lean_along_m,  options.lean_range,
                                  options.lean_across_m, options.lean_across_m, options.lean_rad};
    for (int i = 0; i < kLean; ++i) {
      considered.push_back({lean->data(), i, sigmas[i]});
      Add(AutoDiff<PriorCost, kLean>({i, 0.0, kHeld * sigmas[i]}), nullptr,
          Group(RadarName(radar) + ".lean"), time_s, lean->data());
    }
  }
  return lean->data();
}

}  // namespace v2vouch
