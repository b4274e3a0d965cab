// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "daemon/common/base/time.h"

namespace v2vouch {

/// Whether a sender reports that its position is bad right now.
///
/// A phone that always reports 4 m is used as it is: its residuals show how good it is. A receiver
/// of 0.8 m that reports 4 m in a street canyon tells that it is lost. Its position is of no use
/// while it reports more than is believed, and more than kWorse times its usual accuracy:
///
///     usual = min(reported, usual * 2^(dt / kDoubling_s))
///
/// A sender that is first heard while it is bad shows that by getting better fast (a message below
/// kBetter of a usual accuracy worse than believed): until the reported accuracy settles, its
/// position moves by errors that end. Fixed size.
class AccuracyWatch {
 public:
  /// A message with its reported accuracy (nullopt: unavailable). @return whether its position is
  /// of no use.
  bool IsBadNow(Timestamp stamp, std::optional<double> reported_m, double believed_m);

  static constexpr double kWorse = 2.0;
  static constexpr double kBetter = 0.85;
  static constexpr double kDoubling_s = 20.0;

 private:
  std::optional<double> usual_m_;
  Timestamp last_{};
  bool is_improving_ = false;
};

}  // namespace v2vouch
