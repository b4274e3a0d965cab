// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>

#include "daemon/common/base/refusal_tally.h"
#include "daemon/common/base/time.h"

namespace v2vouch::wire {

/// Judges the figures of one message, each by its name in the .lcm file. A figure that the message
/// cannot do without refuses it (Need); any other is left unused by itself (Optional, Sigma), and
/// said so where it is not a documented "unavailable" but impossible.
class FieldJudge {
 public:
  explicit FieldJudge(RefusalTally& unused) : unused_(unused) {}

  /// The first fault is kept; later ones of the same message are of no matter.
  void Fail(Refusal refusal) {
    if (refusal_.reason == Reason::kCount) refusal_ = refusal;
  }
  void Need(bool condition, Refusal otherwise) {
    if (!condition) Fail(otherwise);
  }
  void Need(double value, double low, double high, std::string_view field) {
    if (!std::isfinite(value)) return Fail({Reason::kNotFinite, field});
    if (value < low || value > high) Fail({Reason::kOutOfRange, field});
  }
  /// NaN = unavailable.
  std::optional<double> Optional(double value, double low, double high, std::string_view field) {
    if (std::isnan(value)) return std::nullopt;
    if (value >= low && value <= high) return value;
    Unused(field);
    return std::nullopt;
  }
  /// A standard deviation: NaN and 0 = unknown.
  std::optional<double> Sigma(double value, double highest, std::string_view field) {
    if (std::isnan(value) || value == 0.0) return std::nullopt;
    if (value > 0.0 && value <= highest) return value;
    Unused(field);
    return std::nullopt;
  }
  void Unused(std::string_view field) { unused_.Add({Reason::kFieldUnused, field}); }

  /// nullptr: none.
  [[nodiscard]] const Refusal* refusal() const {
    return refusal_.reason == Reason::kCount ? nullptr : &refusal_;
  }

 private:
  RefusalTally& unused_;
  Refusal refusal_;  // kCount: none.
};

/// What is wrong with a time of measurement, in microseconds since 1970: the text for
/// Refusal::field ("utime", or "utime looks like milliseconds"), empty where it can be one. Other
/// units are told by what they would mean: a stamp that is this century in milliseconds is 1970 in
/// microseconds, where a clock that was never set may be, too. So that case is only taken for
/// milliseconds where this computer itself (`received`) does not live in 1970, and seconds only
/// where they are within a week of `received`.
std::string_view TimeFault(std::int64_t utime, Timestamp received);

/// The same for another field that holds a time: "" or one of the texts, which begin with `utime`.
inline bool IsTime(std::int64_t utime, Timestamp received) {
  return TimeFault(utime, received).empty();
}

/// A counter that may hold anything (never set, wrapped, negative): kept apart where differences
/// of two of them cannot overflow.
std::int64_t SafeSeq(std::int64_t seq);

}  // namespace v2vouch::wire
