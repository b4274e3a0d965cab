// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/odometry/speed_check.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "daemon/common/data/kinematic_limits.h"

namespace v2vouch {
namespace {

constexpr double kStill_mps = 0.05;
constexpr double kNoise_mps = 0.2;
constexpr double kSmooth_s = 0.3;
constexpr double kRolls_mps = 0.3;  // From here on a sign means something.
constexpr double kFade_s = 0.5;
constexpr double kLongestStep_s = 0.5;
// Two speeds differ if by more than this; radars and wheels disagree by 1 to 2 % as it is.
constexpr double kDiffer_mps = 0.4;
constexpr double kDifferShare = 0.02;
constexpr double kLeastSpeed_mps = -kMostRoadSpeed_mps;
constexpr double kMostSpeed_mps = 90.0;
// A world: over half a second of three radars, three cells a scan, and some on either side.
constexpr double kWorldCells = 24.0;
constexpr double kWorldSide = 5.0;
constexpr int kLeastCells = 3;      // Of one scan, to count at all.
constexpr double kCreep_mps = 3.0;  // Wheel speeds that read 0 do so below 0.5 to 1.5 m/s.
// Wheels do not stop faster [m/s^2]; a sensor that fails does.
constexpr double kHardestStop_mps2 = 15.0;
// A car whose sensor has always read 0 drives at any speed. Three vehicles that circle before it
// give 25 to 75 cells, at most a quarter of them on one side; a street gives more, on both.
constexpr double kDriveCells = 72.0;
constexpr double kDriveSide = 0.25;
constexpr double kReverse_mps = 6.0;
constexpr double kMirrorShare = 0.05;
constexpr double kLost_s = 1.0;
// km/h, mph and m/s taken for each other.
constexpr std::array<double, 6> kUnits{3.6, 1.0 / 3.6, 2.23694, 0.44704, 1.60934, 0.621371};
constexpr double kUnitShare = 0.06;
constexpr double kRatioSpeed_mps = 1.0;  // Below, noise decides.
constexpr double kScaleSpan = 0.12;
constexpr double kScaleOn = 0.02;
constexpr double kScaleOff = 0.012;
constexpr double kScaleSpread = 0.012;
constexpr double kScaleMemory_s = 20.0;
constexpr double kScaleLearn_s = 8.0;
constexpr double kScaleSpeed_mps = 4.0;
constexpr int kScaleCells = 5;

double Gate(double speed_mps) { return kDiffer_mps + kDifferShare * std::abs(speed_mps); }

}  // namespace

bool SpeedCheck::IsWorld(const Sum& sum) const {
  return sum.cells >= kWorldCells && std::min(sum.left, sum.right) >= kWorldSide;
}

// Lanes of traffic on both sides of a car that stands look like one that rolls backwards.
bool SpeedCheck::MayBeEgo(double speed_mps) const {
  if (gear_ == Gear::kPark) return false;
  return speed_mps > 0.0 || (gear_ != Gear::kForward && speed_mps >= -kCreep_mps);
}

// Below the deadband a car sets off from 0: a speed that was not there and is all at once is
// somebody else's.
bool SpeedCheck::MayDrive() const {
  if (std::abs(other_began_) <= kCreep_mps) return true;
  return !wheels_work_ && other_sum_.cells >= kDriveCells &&
         std::min(other_sum_.left, other_sum_.right) >= kDriveSide * other_sum_.cells;
}

bool SpeedCheck::may_roll() const {
  return is_replaced_ ||
         (IsWorld(other_sum_) && MayBeEgo(other_) && other_sum_.cells > used_sum_.cells &&
          (!is_still_ || std::abs(other_) <= kCreep_mps || MayDrive()));
}

bool SpeedCheck::is_seen_standing() const {
  return !is_replaced_ && is_still_ && IsWorld(used_sum_) &&
         used_sum_.cells > 2.0 * other_sum_.cells;
}

SpeedCorrection SpeedCheck::correction() const {
  if (is_replaced_) return is_frozen_ ? SpeedCorrection::kFrozen : SpeedCorrection::kDeadband;
  if (unit_ * scale_ != 1.0) return SpeedCorrection::kScale;
  return sign_ < 0.0 && !is_still_ ? SpeedCorrection::kSign : SpeedCorrection::kNone;
}

void SpeedCheck::Forget() {
  used_sum_ = {};
  other_sum_ = {};
  other_ = 0.0;
  other_since_ = {};
  is_suspect_ = false;
}

double SpeedCheck::Read(const EgoMotion& sample) {
  const bool is_first = sampled_ == Timestamp{};
  const double dt_s =
      is_first ? 0.0 : std::clamp(ToSeconds(sample.stamp - sampled_), 0.0, kLongestStep_s);
  const double speed = sample.speed_mps;
  smooth_ += (1.0 - std::exp(-dt_s / kSmooth_s)) * (speed - smooth_);
  // A sensor that says 0 says 0; one with noise does so on average.
  is_still_ =
      std::abs(speed) < 0.01 || (std::abs(smooth_) <= kStill_mps && std::abs(speed) <= kNoise_mps);
  const bool is_still = is_still_;
  same_s_ = !is_first && speed == told_ ? same_s_ + dt_s : 0.0;
  still_s_ = is_still ? still_s_ + dt_s : 0.0;
  if (same_s_ == 0.0) other_low_ = other_high_ = other_;

  const bool gear_changed = !is_first && sample.gear != gear_;
  // Which way the car rolls may change where it stops or shifts: nothing of before is held to.
  if (gear_changed || (is_still && still_s_ > 0.3)) {
    if (sign_ < 0.0) Forget();
    sign_ = 1.0;
    sign_is_seen_ = false;
  }
  if (is_replaced_ && same_s_ == 0.0 && !is_still) {
    is_replaced_ = false;
    Forget();
  }
  const double lost = std::abs(told_) - std::abs(speed);
  if (lost > kRolls_mps + kHardestStop_mps2 * std::max(dt_s, 0.02)) {
    wheels_work_ = false;
  } else if (std::abs(speed) > kRolls_mps) {
    wheels_work_ = true;
  }
  sampled_ = sample.stamp;
  told_ = speed;
  gear_ = sample.gear;
  // Most wheel speeds have no sign: in reverse gear a positive one is taken for backwards until
  // Doppler says otherwise. A negative one in forward gear has a sign: a car may roll back.
  if (!sign_is_seen_ && !is_still && sign_ > 0.0 && gear_ == Gear::kReverse && speed > 0.0) {
    sign_ = -1.0;
    Forget();
  }
  const bool is_opposed = (gear_ == Gear::kReverse && speed > kRolls_mps) ||
                          (gear_ == Gear::kForward && speed < -kRolls_mps);
  contradicted_s_ = is_opposed ? contradicted_s_ + dt_s : 0.0;
  return used_speed_mps();
}

void SpeedCheck::OnScan(Timestamp stamp, StandingWorld& world) {
  if (sampled_ == Timestamp{}) return;
  const double dt_s =
      scanned_ == Timestamp{} ? 0.0 : std::clamp(ToSeconds(stamp - scanned_), 0.0, kLongestStep_s);
  scanned_ = stamp;
  misread_since_.reset();
  if (is_replaced_) {
    Track(stamp, world);
    return;
  }
  Compare(stamp, dt_s, world);
  LearnScale(dt_s, world);
  Decide(stamp);
}

// Doppler's speed is in use: follow it.
void SpeedCheck::Track(Timestamp stamp, StandingWorld& world) {
  constexpr double kReach_mps = 0.8;
  const SpeedSupport seen = world.Strongest(doppler_ - kReach_mps, doppler_ + kReach_mps);
  const SpeedSupport told = world.Of(is_frozen_ ? unit_ * scale_ * told_ : 0.0);
  if (seen.cells >= kLeastCells && seen.cells >= told.cells) {
    doppler_ += 0.7 * (seen.speed_mps - doppler_);
    doppler_seen_ = stamp;
  }
  const bool is_lost = ToSeconds(stamp - doppler_seen_) > kLost_s;
  const bool stands = !is_frozen_ && std::abs(doppler_) < 0.5 * kDiffer_mps;
  if (is_lost || stands) {
    is_replaced_ = false;
    Forget();
  }
}

// Adds this scan to what speaks for the speed in use and for another one.
void SpeedCheck::Compare(Timestamp stamp, double dt_s, StandingWorld& world) {
  const double used = used_speed_mps();
  const double gate = Gate(used);
  const double share = std::exp(-dt_s / kFade_s);
  used_sum_.Fade(share);
  other_sum_.Fade(share);
  const SpeedSupport mine = world.Strongest(used - gate, used + gate);
  used_sum_.Add(mine);

  const SpeedSupport strongest = world.Strongest(kLeastSpeed_mps, kMostSpeed_mps);
  const bool has_other = other_since_ != Timestamp{};
  const double reach = 0.4 + 8.0 * dt_s;
  SpeedSupport other;
  if (has_other) other = world.Strongest(other_ - reach, other_ + reach);
  const bool is_strange =
      strongest.cells >= kLeastCells && std::abs(strongest.speed_mps - used) > gate;
  // One scan of a side radar full of a passing lorry does not push out what all others agree on.
  rival_ *= share;
  if (is_strange && !(has_other && std::abs(strongest.speed_mps - other_) <= reach)) {
    rival_ += std::max(0, strongest.cells - other.cells);
    if (!has_other || rival_ > 0.5 * other_sum_.cells) {
      rival_ = 0.0;
      other = strongest;
      other_since_ = stamp;
      other_sum_ = {};
      other_ = strongest.speed_mps;
      other_began_ = other_low_ = other_high_ = other_;
      told_low_ = told_high_ = told_;
      ratio_low_ = 1e9;
      ratio_high_ = -1e9;
    }
  }
  if (other_since_ == Timestamp{} || other.cells == 0) {
    if (other_sum_.cells < 1.0) other_since_ = {};
    return;
  }
  if (std::abs(other.speed_mps - used) <= gate) {  // It has come to the same.
    other_since_ = {};
    other_sum_ = {};
    return;
  }
  other_sum_.Add(other);
  other_ = other.speed_mps;
  other_low_ = std::min(other_low_, other_);
  other_high_ = std::max(other_high_, other_);
  told_low_ = std::min(told_low_, told_);
  told_high_ = std::max(told_high_, told_);
  if (std::min(std::abs(told_), std::abs(other_)) > kRatioSpeed_mps) {
    ratio_low_ = std::min(ratio_low_, other_ / told_);
    ratio_high_ = std::max(ratio_high_, other_ / told_);
  }
}

void SpeedCheck::Decide(Timestamp stamp) {
  if (other_since_ == Timestamp{}) {
    if (used_sum_.cells > kWorldCells) is_suspect_ = false;
    return;
  }
  const double held_s = ToSeconds(stamp - other_since_);
  if (is_still_) {
    if (still_s_ >= 0.2) DecideStill(stamp, held_s);
  } else if (std::abs(told_) >= kRolls_mps) {
    DecideRolling(stamp, held_s);
  }
  if (used_sum_.cells > other_sum_.cells) is_suspect_ = false;
}

void SpeedCheck::Replace(Timestamp stamp, bool is_frozen) {
  is_replaced_ = true;
  is_frozen_ = is_frozen;
  doppler_ = other_;
  doppler_seen_ = stamp;
  misread_since_ = other_since_;
  Forget();
}

void SpeedCheck::DecideStill(Timestamp stamp, double held_s) {
  const bool is_creep = std::abs(other_) <= kCreep_mps;
  double share = 1.5;
  double hold_s = is_creep ? 0.3 : 1.0;
  if (!IsWorld(other_sum_) || !MayBeEgo(other_)) return;
  if (!is_creep && !MayDrive()) return;
  if (other_ < 0.0) {
    share = gear_ == Gear::kReverse ? 2.0 : 3.0;
    if (gear_ != Gear::kReverse) hold_s = 1.5;
  } else if (gear_ == Gear::kReverse) {
    share = 3.0;
  }
  if (IsWorld(used_sum_)) share = 3.0;  // What stands on both sides stands.
  if (held_s >= hold_s && other_sum_.cells > share * used_sum_.cells) Replace(stamp, false);
}

void SpeedCheck::DecideRolling(Timestamp stamp, double held_s) {
  const double used = used_speed_mps();
  const bool is_mirror =
      std::abs(other_ + used) <= std::max(kDiffer_mps, kMirrorShare * std::abs(used));
  if (is_mirror) {
    const bool is_opposed = (gear_ == Gear::kReverse) == (used > 0.0) &&
                            (gear_ == Gear::kReverse || gear_ == Gear::kForward);
    const bool is_known = is_opposed || sign_ < 0.0;
    const bool is_open = gear_ != Gear::kForward && gear_ != Gear::kPark;
    // A street built on one side only: nothing else shows exactly the opposite speed for long.
    const bool is_one_sided = other_sum_.cells >= 2.0 * kWorldCells &&
                              other_sum_.cells > 5.0 * used_sum_.cells && held_s >= 1.0;
    const bool is_seen = is_one_sided || (IsWorld(other_sum_) && held_s >= 0.4 &&
                                          other_sum_.cells > 3.0 * used_sum_.cells);
    const bool is_settled = is_known ? other_sum_.cells > 0.5 * kWorldCells && held_s >= 0.15 &&
                                           other_sum_.cells > 1.5 * used_sum_.cells
                                     : is_open && std::abs(used) <= kReverse_mps && is_seen;
    if (is_settled) {
      sign_ = -sign_;
      sign_is_seen_ = true;
      misread_since_ = other_since_;
      Forget();
      return;
    }
  }
  if (!IsWorld(other_sum_) || other_sum_.cells < 3.0 * used_sum_.cells) return;
  const bool told_varies = told_high_ - told_low_ > 0.25 * std::abs(told_);
  const double middle = 0.5 * (ratio_low_ + ratio_high_);
  const bool is_steady = ratio_high_ - ratio_low_ <= 0.12 * std::abs(middle);
  if (held_s >= 1.0 && told_varies && is_steady && middle > 0.0) {
    for (const double unit : kUnits) {
      if (std::abs(middle / unit - 1.0) > kUnitShare) continue;
      unit_ = unit;
      scale_ = 1.0;
      ratio_ = 1.0;
      ratio_s_ = 0.0;
      misread_since_ = other_since_;
      Forget();
      return;
    }
  }
  if (same_s_ >= 2.0 && held_s >= 1.0 && other_high_ - other_low_ > 1.0) {
    Replace(stamp, true);
    return;
  }
  // Traffic that drives along shows a speed near 0, and needs no explanation.
  const bool is_traffic = std::abs(other_) < 0.3 * std::abs(used);
  if (held_s >= 2.0 && !is_traffic) is_suspect_ = true;
}

// Tyres and wheel sensors are off by some per cent; learnt slowly, over changing surroundings.
void SpeedCheck::LearnScale(double dt_s, StandingWorld& world) {
  const double base = sign_ * unit_ * told_;
  if (std::abs(base) < kScaleSpeed_mps) return;
  const double span = kScaleSpan * std::abs(base);
  const SpeedSupport near = world.Strongest(base - span, base + span);
  if (near.cells < kScaleCells) return;
  const double ratio = near.speed_mps / base;
  ratio_s_ += dt_s;
  const double gain = std::max(dt_s / kScaleMemory_s, std::min(1.0, dt_s / ratio_s_));
  const double off = ratio - ratio_;
  if (ratio_s_ > 1.0) ratio_spread_ += gain * (std::abs(off) - ratio_spread_);
  ratio_ += gain * off;
  const double from_one = std::abs(ratio_ - 1.0);
  const bool is_learnt = ratio_s_ >= kScaleLearn_s && ratio_spread_ <= kScaleSpread;
  const double before = scale_;
  if (is_learnt && from_one > kScaleOn) scale_ = ratio_;
  if (from_one < kScaleOff) scale_ = 1.0;
  // From a changed speed on, what was counted for the old one says nothing.
  if (std::abs(scale_ - before) > 0.5 * kScaleOn) {
    misread_since_ = scanned_ - FromSeconds(kScaleLearn_s);
    Forget();
  }
}

}  // namespace v2vouch
