// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/perception/claimed_size.h"

#include <cmath>

#include "daemon/v2v/trust/checks.h"

namespace v2vouch {
namespace {

// SAE J2735 gives length and width in centimetres; senders are configured by hand.
constexpr double kClaimedSigma_m = 0.15;

double Gain(double sigma_m) {
  return sigma_m * sigma_m / (sigma_m * sigma_m + kClaimedSigma_m * kClaimedSigma_m);
}

void Correct(double claimed_m, double gain, double& size_m, double& sigma_m) {
  size_m += gain * (claimed_m - size_m);
  sigma_m *= std::sqrt(1.0 - gain);
}

}  // namespace

LocalTrack GivenClaimedSize(const LocalTrack& track, const SenderRecord* record,
                            const TrustConfig& config) {
  LocalTrack given = track;
  if (record == nullptr || track.is_point) return given;
  if (!IsSizePlausible(record->length_m, record->width_m, track.extent, config)) return given;
  Extent& extent = given.extent;
  if (record->length_m) {
    const double gain = Gain(extent.length_sigma_m);
    const Eigen::Vector2d& by_length = track.centre_by_length_O;
    given.state_O.mean.head<2>() += gain * (*record->length_m - extent.length_m) * by_length;
    const double known = gain * extent.length_sigma_m * extent.length_sigma_m;
    given.state_O.covariance.topLeftCorner<2, 2>() -= known * by_length * by_length.transpose();
    Correct(*record->length_m, gain, extent.length_m, extent.length_sigma_m);
  }
  if (record->width_m) {
    Correct(*record->width_m, Gain(extent.width_sigma_m), extent.width_m, extent.width_sigma_m);
  }
  return given;
}

}  // namespace v2vouch
