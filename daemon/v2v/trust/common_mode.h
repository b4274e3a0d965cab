// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "daemon/common/base/time.h"
#include "daemon/common/base/visit.h"
#include "daemon/common/data/input.h"

namespace v2vouch {

/// Common mode: whose fault a residual is, the sender's or our own.
struct CommonModeConfig {
  int senders = 3;         ///< So many that are off in the same way blame the ego or the area.
  double shift_m = 2.5;    ///< Off: the mean of their residuals is longer than this ...
  double agree_m = 1.5;    ///< ... and each lies within this of it.
  double witness_m = 2.5;  ///< A sender whose residual is shorter vouches for the ego's place.
  double hold_s = 10.0;    ///< The suspicion lasts so long after it was last seen.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("senders", senders, {.at_least = 2, .at_most = 100});
    a.Field("shift_m", shift_m, {.above = 0.0, .at_most = 50.0});
    a.Field("agree_m", agree_m, {.above = 0.0, .at_most = 50.0});
    a.Field("witness_m", witness_m, {.above = 0.0, .at_most = 50.0});
    a.Field("hold_s", hold_s, {.at_least = 0.0, .at_most = 600.0});
  }
};

/// A sender beside the LOCAL track it is taken for.
struct SenderResidual {
  SenderId sender = 0;
  Eigen::Vector2d mean_O = Eigen::Vector2d::Zero();  ///< Claimed minus sensed, raw, over a second.
};

/// What the residuals of all senders say together. Sensor tracks are relative to the ego and know
/// nothing of its place, so a wrong place or heading of the ego moves every sender's residual
/// alike, and a liar only its own.
class CommonMode {
 public:
  CommonMode() = default;
  CommonMode(std::span<const SenderResidual> residuals, const CommonModeConfig& config);

  /// At least `senders` of them, and more than half of all, are shifted together.
  [[nodiscard]] bool is_shifted() const { return is_shifted_; }
  [[nodiscard]] const Eigen::Vector2d& shift_O() const { return shift_; }
  /// Whether another sender than `sender` confirms the ego's position. Without such a witness a
  /// position residual withdraws, but never accuses.
  [[nodiscard]] bool HasWitnessAgainst(SenderId sender) const;

 private:
  bool is_shifted_ = false;
  Eigen::Vector2d shift_ = Eigen::Vector2d::Zero();
  int witnesses_ = 0;
  SenderId only_witness_ = 0;
};

/// The common mode over time: once seen, a shift of all senders is held for
/// CommonModeConfig::hold_s.
class CommonModeMonitor {
 public:
  /// @param residuals of all senders whose residuals have settled, at `now`.
  void Judge(std::span<const SenderResidual> residuals, Timestamp now,
             const CommonModeConfig& config);
  [[nodiscard]] bool IsShifted(Timestamp now, const CommonModeConfig& config) const {
    return shifted_ && ToSeconds(now - *shifted_) <= config.hold_s;
  }
  [[nodiscard]] const CommonMode& mode() const { return mode_; }

 private:
  CommonMode mode_;
  std::optional<Timestamp> shifted_;  // When all senders were last off alike.
};

}  // namespace v2vouch
