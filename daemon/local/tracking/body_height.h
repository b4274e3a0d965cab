// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/data/measurement.h"
#include "daemon/local/tracking/sensor_look.h"

namespace v2vouch {

/// How high a vehicle stands above the ground, learnt from the upper edges of its boxes at a range
/// that radar has measured:
///
///     h = z_camera - range tan(depression of the upper edge)
///
/// Names of a network are wrong for seconds; a lorry is never as low as a car. A mean with a
/// variance [m^2]: errors of pitch last for some pictures, so that one box counts for less.
class BodyHeight {
 public:
  /// One box whose vehicle begins `range_m` from the camera. An upper edge at the picture's border
  /// and a height that no vehicle has (something else stands behind it) say nothing.
  void Add(const CameraLook& look, const CameraMeasurement& z, double range_m);

  /// The class that fits the height: a car, van, lorry or bus that is too low or too high for its
  /// name gets another one of these. Others, and where the height is not known, as named. What has
  /// been told stays until the height clearly says otherwise.
  [[nodiscard]] ObjectClass Plausible(ObjectClass named) const;

 private:
  enum class Kind { kOpen, kLow, kMiddle, kHigh };
  double mean_m_ = 0.0;
  double variance_m2_ = 0.0;  // 0: no box yet.
  Kind kind_ = Kind::kOpen;
};

}  // namespace v2vouch
