// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/base/angle.h"
#include "daemon/common/base/time.h"

namespace v2vouch {

/// Whether the car stands, as far as wheels and radar can say.
enum class Standstill {
  kNo,      ///< It rolls, or may.
  kWheels,  ///< The wheel speed has been 0 for kSettle_s; some sensors read 0 while a car creeps.
  kSeen,    ///< The standing world shows no motion either.
};

/// Offset of the yaw rate sensor, learnt while the car stands: a car that does not roll does not
/// turn, so what the sensor reads then is its offset.
///
///     b' = b + K (w - b),  K = P / (P + R),  P grows by q per second
///
/// At standstill the yaw rate is 0; otherwise w - b. *Bounded*: an offset beyond kMost_radps is
/// none (a turntable, a lift, a car that turns below what its wheel speed can show). Once an offset
/// is known, a rate that suddenly differs from it by more than kTurn_radps is read as a turn unless
/// radar has seen the car stand, or it has been steady for kSteady_s. Copyable, fixed size.
class GyroOffset {
 public:
  /// One sample in order of time. @return the yaw rate without offset [rad/s].
  double Read(Timestamp stamp, double yaw_rate_radps, Standstill standstill);

  [[nodiscard]] double offset_radps() const { return offset_; }
  [[nodiscard]] double sigma_radps() const;
  /// Learnt over kSettle_s of standing at least.
  [[nodiscard]] bool is_learnt() const { return learnt_s_ >= kSettle_s; }
  /// The last sample was taken as one of a car that does not turn.
  [[nodiscard]] bool is_held() const { return is_held_; }

  static constexpr double kSettle_s = 0.5;
  static constexpr double kMost_radps = FromDegrees(3.0);
  static constexpr double kTurn_radps = FromDegrees(0.3);
  static constexpr double kSteady_s = 10.0;

 private:
  double offset_ = 0.0;
  double variance_ = kStart_radps * kStart_radps;
  double learnt_s_ = 0.0;
  double innovation_ = 0.0;  // Smoothed w - b of this standstill.
  double beyond_s_ = 0.0;    // How long it has looked like a turn, steadily.
  bool is_held_ = false;
  Timestamp last_{};
  static constexpr double kStart_radps = FromDegrees(1.5);
};

}  // namespace v2vouch
