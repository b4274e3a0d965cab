// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "daemon/common/base/visit.h"

namespace v2vouch {

/// What a calibration says of one of its parameters.
enum class CalibrationVerdict : std::int8_t {
  kEstimated,  ///< The drive alone knows it three times better than the prior, or more.
  kWeak,       ///< The drive alone knows it better than the prior, but not three times.
  kPrior,      ///< The drive knows it no better than the prior, whose value stands.
  kAtBound,    ///< Farther from the prior than three of its standard deviations: not believed.
  kRejected,   ///< The measurements that it rests on do not fit the model.
};

/// One parameter, all in the unit that its name ends with. Frames and signs are those of
/// vehicle.yaml (data/vehicle.h). `<sensor>` is the configured name in lower case:
///
///     radar_<sensor>.x_m, .y_m, .yaw_deg
///     camera_<sensor>.x_m, .y_m, .z_m, .yaw_deg, .pitch_deg, .roll_deg
///     ego.antenna_x_m, ego.antenna_y_m, ego.heading_bias_deg, ego.speed_scale,
///     ego.yaw_rate_bias_degps
///     ego.odometer_y_m  where across the car its speed is measured; told, applied to nothing
///     ego.slip_s2pm     rear-axle slip k: v_y = -k v^2 w; likewise
struct CalibratedParameter {
  std::string name;
  double value = 0.0;
  double std = 0.0;  ///< 1 sigma, above 0.
  double prior = 0.0;
  double prior_std = 0.0;
  CalibrationVerdict verdict = CalibrationVerdict::kPrior;
  std::string determined_by;  ///< In words, for people.

  template <class Archive>
  void Visit(Archive& a) {
    a.Text("name", name);
    a.Field("value", value);
    a.Field("std", std);
    a.Field("prior", prior);
    a.Field("prior_std", prior_std);
    a.Choice("verdict", verdict,
             {{"ESTIMATED", CalibrationVerdict::kEstimated},
              {"WEAK", CalibrationVerdict::kWeak},
              {"PRIOR", CalibrationVerdict::kPrior},
              {"AT_BOUND", CalibrationVerdict::kAtBound},
              {"REJECTED", CalibrationVerdict::kRejected}});
    a.Text("determined_by", determined_by);
  }
};

}  // namespace v2vouch
