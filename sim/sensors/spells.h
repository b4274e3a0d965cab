// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/base/random.h"
#include "sim/world/geometry.h"
#include "sim/world/radio_specs.h"

namespace v2vouch::sim {

/// Spells of a large position error of one receiver (ErrorBurstSpec).
class ErrorBursts {
 public:
  ErrorBursts(const ErrorBurstSpec& spec, const Random& random);

  /// The error at `time_s`, which never goes back.
  Vec2 At(double time_s);

 private:
  void DrawNext(double from_s);

  ErrorBurstSpec spec_;
  Random random_;
  double begins_s_ = 0.0;
  Vec2 whole_ = Vec2::Zero();
};

/// Silences of one sender (RadioSpec::gap_every_s): an exponential time apart, gap_max_s u^4 long.
class RadioGaps {
 public:
  RadioGaps(const RadioSpec& spec, const Random& random);

  /// Whether it is silent at `time_s`, which never goes back.
  bool IsSilent(double time_s);

 private:
  void DrawNext(double from_s);

  RadioSpec spec_;
  Random random_;
  double begins_s_ = 0.0;
  double ends_s_ = 0.0;
};

}  // namespace v2vouch::sim
