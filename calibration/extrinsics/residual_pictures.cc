// SPDX-License-Identifier: Apache-2.0
#include "calibration/extrinsics/residual_pictures.h"

#include <cmath>
#include <map>

#include "calibration/extrinsics/drive_costs.h"

namespace v2vouch {
namespace {

constexpr double kAzimuthBin_deg = 5.0;
constexpr double kRangeBin_m = 5.0;
constexpr std::size_t kMostPixels = 1500;

struct Sums {
  double n = 0.0, sum = 0.0, square = 0.0;
};
using Histogram = std::map<int, Sums>;

void Put(Histogram& histogram, double at, double width, double value) {
  Sums& sums = histogram[static_cast<int>(std::floor(at / width))];
  sums.n += 1.0;
  sums.sum += value;
  sums.square += value * value;
}

std::vector<ResidualPictures::Bin> Bins(const Histogram& histogram, double width) {
  std::vector<ResidualPictures::Bin> bins;
  for (const auto& [number, sums] : histogram) {
    if (sums.n < 10.0) continue;
    const double mean = sums.sum / sums.n;
    bins.push_back({(number + 0.5) * width, mean,
                    std::sqrt(std::max(0.0, sums.square / sums.n - mean * mean)),
                    static_cast<int>(sums.n)});
  }
  return bins;
}

// Per radar: range rate of stationary returns against what the ego's motion predicts, by azimuth.
std::vector<Histogram> DopplerOf(const DriveData& data, const MountingParameters& parameters) {
  std::vector<Histogram> doppler(data.vehicle->radars.size());
  for (const StaticReturn& one : data.returns) {
    const EgoTrack::Sample& sample = data.ego->samples()[one.epoch];
    const auto [speed, omega] = MotionAt(sample, parameters.Ego());
    const double v = speed + one.dt_s * sample.accel_mps2;
    const double* radar = parameters.Radar(one.radar);
    const double bearing = radar[2] + one.azimuth_rad;
    const double off = one.range_rate_mps + (v - omega * radar[1]) * std::cos(bearing) +
                       omega * radar[0] * std::sin(bearing);
    Put(doppler[static_cast<std::size_t>(one.radar)], ToDegrees(one.azimuth_rad), kAzimuthBin_deg,
        off);
  }
  return doppler;
}

// Per radar: range of moving vehicles against their solved positions, by range.
std::vector<Histogram> RangesOf(const DriveData& data, const DriveProblem& problem,
                                const MountingParameters& parameters) {
  std::vector<Histogram> range(data.vehicle->radars.size());
  for (std::size_t i = 0; i < data.windows.size(); ++i) {
    for (const auto& look : data.windows[i].radar_looks) {
      double x = 0.0;
      double y = 0.0;
      PlaceInLook(problem.targets()[i].data(), look.pose, x, y);
      const double* radar = parameters.Radar(look.radar);
      Put(range[static_cast<std::size_t>(look.radar)], look.range_m, kRangeBin_m,
          look.range_m - std::hypot(x - radar[0], y - radar[1]));
    }
  }
  return range;
}

// Feet of boxes against the solved positions; thinned to what a picture can hold.
void AddPixels(const DriveData& data, const DriveProblem& problem,
               const MountingParameters& parameters, ResidualPictures& pictures) {
  std::size_t looks = 0;
  for (const TargetWindow& window : data.windows) looks += window.camera_looks.size();
  const std::size_t step = 1 + looks / kMostPixels;
  std::size_t n = 0;
  for (std::size_t i = 0; i < data.windows.size(); ++i) {
    for (const auto& look : data.windows[i].camera_looks) {
      if (n++ % step != 0) continue;
      double x = 0.0;
      double y = 0.0;
      double u = 0.0;
      double v = 0.0;
      PlaceInLook(problem.targets()[i].data(), look.pose, x, y);
      if (!ProjectGround(data.vehicle->cameras[static_cast<std::size_t>(look.camera)],
                         parameters.Camera(look.camera), x, y, 0.0, u, v)) {
        continue;
      }
      pictures.cameras[static_cast<std::size_t>(look.camera)].pixels.push_back(
          {look.u_px, look.v_px, look.u_px - u, look.v_px - v});
    }
  }
}

}  // namespace

ResidualPictures DrawResiduals(const DriveData& data, const DriveProblem& problem,
                               const MountingParameters& parameters) {
  const std::vector<Histogram> doppler = DopplerOf(data, parameters);
  const std::vector<Histogram> range = RangesOf(data, problem, parameters);
  ResidualPictures pictures;
  for (int camera = 0; camera < parameters.cameras(); ++camera) {
    const CameraConfig& config = data.vehicle->cameras[static_cast<std::size_t>(camera)];
    pictures.cameras.push_back(
        {parameters.descriptions()[static_cast<std::size_t>(parameters.CameraAt(camera))].sensor,
         config.image_width_px,
         config.image_height_px,
         {}});
  }
  AddPixels(data, problem, parameters, pictures);
  for (int radar = 0; radar < parameters.radars(); ++radar) {
    const auto k = static_cast<std::size_t>(radar);
    pictures.radars.push_back(
        {parameters.descriptions()[static_cast<std::size_t>(parameters.RadarAt(radar))].sensor,
         Bins(doppler[k], kAzimuthBin_deg), Bins(range[k], kRangeBin_m)});
  }
  return pictures;
}

}  // namespace v2vouch
