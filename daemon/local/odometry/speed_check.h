// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "daemon/common/base/time.h"
#include "daemon/common/data/input.h"
#include "daemon/local/odometry/standing_world.h"

namespace v2vouch {

/// What is done about the reported speed.
enum class SpeedCorrection {
  kNone,
  kDeadband,  ///< It reads 0 while the car rolls: Doppler's speed is used.
  kSign,      ///< Its sign contradicts gear or Doppler: turned round.
  kScale,     ///< Wrong by a factor (unit, tyre size): multiplied.
  kFrozen,    ///< The same figure again and again while Doppler's speed changes: Doppler's is used.
};

/// Reported speed against the Doppler of the standing world (StandingWorld), and against the gear.
///
/// Many vehicles at one speed look like a standing world to Doppler. What tells them apart:
/// - The world stands on both sides of the ego's path. A column beside a standing ego is on one.
/// - Lanes of one direction on both sides of a standing ego look like an ego that rolls backwards,
///   which a car in forward gear does not.
/// - A car sets off from 0: while the wheels read 0, a speed above 3 m/s must have begun below
/// that.
///   Vehicles on a roundabout before a standing ego show one from the first moment on. A sensor
///   that has always read 0, or fell to it at once, needs a street on both sides.
/// - Buildings, posts and parked cars go on agreeing with a speed that is right. A correction needs
///   several times as many grid cells as the reported speed has.
/// - Wheel speed that is not 0 is believed, unless its fault is of a known kind: the sign (up to
///   6 m/s, or contradicted by the gear), a factor that stays the same while the speed changes, a
///   figure that never changes while Doppler's does. Other disagreement of 2 s is reported as
///   suspect, and the reported speed stays in use.
///
/// A correction ends when the reported speed has more support again, when its cause is over (the
/// wheel speed is not 0 any more, the gear changed), or, where Doppler's speed is in use, after 1 s
/// without support. Copyable, fixed size; a function of samples and scans in order of time.
class SpeedCheck {
 public:
  /// @return the speed to use [m/s].
  double Read(const EgoMotion& sample);
  void OnScan(Timestamp stamp, StandingWorld& world);

  [[nodiscard]] SpeedCorrection correction() const;
  /// Sign and scale together; 1 where neither is corrected.
  [[nodiscard]] double factor() const { return sign_ * unit_ * scale_; }
  /// Doppler's idea of the speed, where it differs from the reported one [m/s].
  [[nodiscard]] double doppler_speed_mps() const { return is_replaced_ ? doppler_ : other_; }
  [[nodiscard]] double used_speed_mps() const { return is_replaced_ ? doppler_ : factor() * told_; }
  [[nodiscard]] double reported_speed_mps() const { return told_; }
  [[nodiscard]] bool is_suspect() const { return is_suspect_; }
  /// Forward gear and negative speed, or reverse gear and positive speed, for 0.5 s.
  [[nodiscard]] bool gear_contradicts() const { return contradicted_s_ >= 0.5; }

  /// Set by the scan that changed how the speed is read: since when it had been misread.
  [[nodiscard]] std::optional<Timestamp> misread_since() const { return misread_since_; }

  /// The wheel speed has been 0 for so long [s].
  [[nodiscard]] double still_s() const { return still_s_; }
  /// Doppler shows that the car rolls, or is about to.
  [[nodiscard]] bool may_roll() const;
  /// The standing world agrees with a speed of 0.
  [[nodiscard]] bool is_seen_standing() const;

 private:
  struct Sum {  // Grid cells of the last half second, fading.
    double cells = 0.0;
    double left = 0.0;
    double right = 0.0;
    void Fade(double share) {
      cells *= share;
      left *= share;
      right *= share;
    }
    void Add(const SpeedSupport& support) {
      cells += support.cells;
      left += support.left;
      right += support.right;
    }
  };
  [[nodiscard]] bool IsWorld(const Sum& sum) const;
  void Track(Timestamp stamp, StandingWorld& world);
  void Compare(Timestamp stamp, double dt_s, StandingWorld& world);
  void Decide(Timestamp stamp);
  void DecideStill(Timestamp stamp, double held_s);
  void DecideRolling(Timestamp stamp, double held_s);
  [[nodiscard]] bool MayBeEgo(double speed_mps) const;
  [[nodiscard]] bool MayDrive() const;
  void LearnScale(double dt_s, StandingWorld& world);
  void Replace(Timestamp stamp, bool is_frozen);
  void Forget();

  // Of the samples.
  Timestamp sampled_{};
  double told_ = 0.0;
  double smooth_ = 0.0;
  bool is_still_ = false;
  bool wheels_work_ = false;  // They have read another speed than 0, and came to 0 as a car does.
  Gear gear_ = Gear::kUnknown;
  double still_s_ = 0.0;
  double same_s_ = 0.0;  // How long the figure has been the same to the bit.
  double contradicted_s_ = 0.0;
  // In force.
  double sign_ = 1.0;
  bool sign_is_seen_ = false;  // By Doppler, not only from the gear.
  double unit_ = 1.0;
  double scale_ = 1.0;
  bool is_replaced_ = false;
  bool is_frozen_ = false;
  double doppler_ = 0.0;
  Timestamp doppler_seen_{};
  bool is_suspect_ = false;
  // Of the scans.
  Timestamp scanned_{};
  std::optional<Timestamp> misread_since_;
  Sum used_sum_, other_sum_;
  double other_ = 0.0;
  double other_began_ = 0.0;  // Its first figure.
  double rival_ = 0.0;        // Cells of a third speed beyond the other's.
  Timestamp other_since_{};
  double other_low_ = 0.0, other_high_ = 0.0;  // Its range while the reported one was the same.
  double told_low_ = 0.0, told_high_ = 0.0;    // Range of the reported one since then,
  double ratio_low_ = 0.0, ratio_high_ = 0.0;  // and of the other over it.
  double ratio_ = 1.0;                         // Learnt slowly while both agree roughly.
  double ratio_spread_ = 0.0;
  double ratio_s_ = 0.0;
};

}  // namespace v2vouch
