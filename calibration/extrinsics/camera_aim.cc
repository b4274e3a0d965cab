// SPDX-License-Identifier: Apache-2.0
#include "calibration/extrinsics/camera_aim.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "calibration/extrinsics/box_feet.h"

namespace v2vouch {
namespace {

constexpr double kReach_rad = FromDegrees(5.0);
constexpr double kBin_rad = FromDegrees(0.25);
constexpr int kBins = 40;      // Each way: 2 kReach_rad / kBin_rad.
constexpr int kNeighbour = 4;  // Bins this near belong to the peak.
constexpr double kLeastVotes = 30.0;
constexpr double kStandsOut = 1.5;  // Against the best peak that is not its neighbour.

std::size_t Bin(int i, int k) { return static_cast<std::size_t>(i * kBins + k); }

// Of every box against every window's prediction: how far it lies to the right (first index) and
// below (second).
std::vector<double> Votes(const DriveLog& log, const EgoTrack& ego, const CameraConfig& config,
                          int camera, const std::vector<RadarChain>& chains,
                          const double* mounting) {
  std::vector<TargetWindow> windows = MakeWindows(ego, chains);
  std::vector<double> votes(kBins * kBins, 0.0);
  ForEachPicture(
      log, camera, windows, [&](const CameraDetections& picture, std::size_t, auto& open) {
        const auto at = ego.At(picture.stamp);
        if (!at) return;
        const std::vector<Foot> feet = FeetOf(picture, config);
        for (const TargetWindow* window : open) {
          const auto middle = ego.At(window->middle);
          const LookPose pose = PoseOf(*at, *middle, ToSeconds(picture.stamp - window->middle));
          const auto predicted = Predicted(*window, pose, config, mounting);
          if (!predicted) continue;
          for (const Foot& foot : feet) {
            const int i = static_cast<int>(
                std::floor(((foot.u - predicted->u) / config.fx_px + kReach_rad) / kBin_rad));
            const int k = static_cast<int>(
                std::floor(((foot.v - predicted->v) / config.fy_px + kReach_rad) / kBin_rad));
            if (i >= 0 && i < kBins && k >= 0 && k < kBins) votes[Bin(i, k)] += 1.0;
          }
        }
      });
  return votes;
}

struct Peak {
  int i = 0, k = 0;
};

// The bin that most votes surround; nullopt where none stands out.
std::optional<Peak> PeakOf(const std::vector<double>& votes) {
  // Three by three bins together, so that a peak on a bin's edge counts.
  double best = 0.0;
  Peak peak;
  std::vector<double> smooth(votes.size(), 0.0);
  for (int i = 1; i + 1 < kBins; ++i) {
    for (int k = 1; k + 1 < kBins; ++k) {
      double sum = 0.0;
      for (int di = -1; di <= 1; ++di) {
        for (int dk = -1; dk <= 1; ++dk) sum += votes[Bin(i + di, k + dk)];
      }
      smooth[Bin(i, k)] = sum;
      if (sum > best) {
        best = sum;
        peak = {i, k};
      }
    }
  }
  double second = 0.0;
  for (int i = 1; i + 1 < kBins; ++i) {
    for (int k = 1; k + 1 < kBins; ++k) {
      if (std::abs(i - peak.i) <= kNeighbour && std::abs(k - peak.k) <= kNeighbour) continue;
      second = std::max(second, smooth[Bin(i, k)]);
    }
  }
  if (best < kLeastVotes || best < kStandsOut * second) return std::nullopt;
  return peak;
}

}  // namespace

void AimCamera(const DriveLog& log, const EgoTrack& ego, const VehicleConfig& vehicle, int camera,
               const std::vector<RadarChain>& chains, MountingParameters& parameters) {
  const CameraConfig& config = vehicle.cameras[static_cast<std::size_t>(camera)];
  const auto peak = PeakOf(Votes(log, ego, config, camera, chains, parameters.Camera(camera)));
  if (!peak) return;
  // A camera that points farther left or down has everything farther right or up.
  parameters.Camera(camera)[3] += (peak->i + 0.5) * kBin_rad - kReach_rad;
  parameters.Camera(camera)[4] -= (peak->k + 0.5) * kBin_rad - kReach_rad;
}

}  // namespace v2vouch
