// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "daemon/common/data/input.h"

namespace v2vouch {

/// The car's own odometry over a drive, ready to be asked at any time.
class EgoTrack {
 public:
  struct Sample {
    Timestamp stamp{};
    double speed_mps = 0.0;       ///< As measured.
    double yaw_rate_radps = 0.0;  ///< As measured.
    double accel_mps2 = 0.0;      ///< Slope of speed over 0.2 s around the sample.
    double yaw_accel_radps2 = 0.0;
    double x_m = 0.0;  ///< Dead reckoning from the first sample, drifting.
    double y_m = 0.0;
    double yaw_rad = 0.0;
  };

  /// The pose that dead reckoning gives.
  struct Place {
    double x_m = 0.0;
    double y_m = 0.0;
    double yaw_rad = 0.0;
  };

  /// @param motion in order of stamps; samples that repeat a stamp are passed over.
  explicit EgoTrack(const std::vector<EgoMotion>& motion);

  [[nodiscard]] const std::vector<Sample>& samples() const { return samples_; }
  /// Index of the sample nearest to `t`; nullopt where none is within 60 ms.
  [[nodiscard]] std::optional<std::size_t> Nearest(Timestamp t) const;
  [[nodiscard]] std::optional<Place> At(Timestamp t) const;

  /// White noise of one sample, 1 sigma: WhiteSigmaWithin what the messages state.
  [[nodiscard]] double speed_sigma_mps() const { return speed_sigma_mps_; }
  [[nodiscard]] double yaw_rate_sigma_radps() const { return yaw_rate_sigma_radps_; }

 private:
  std::vector<Sample> samples_;
  double speed_sigma_mps_ = 0.1;
  double yaw_rate_sigma_radps_ = 0.002;
};

}  // namespace v2vouch
