// SPDX-License-Identifier: Apache-2.0
// What the messages of all own sensors have in common; for this room's conversions only.
#pragma once

#include <cmath>
#include <optional>
#include <string>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/refusal_tally.h"
#include "daemon/common/data/input.h"
#include "daemon/rim/wire/class_names.h"
#include "daemon/rim/wire/field_judge.h"

namespace v2vouch::wire {

/// No sensor of a road vehicle sees farther: past it a number is a fault, not a measurement.
inline constexpr double kMaxRange_m = 1000.0;
/// Angles may be counted from -pi to pi or from 0 to 2 pi, in single precision.
inline constexpr double kTurn_rad = 2.0 * kPi + 1e-5;

template <class Message>
MessageHeader Header(const Message& message, double clock_offset_s, Timestamp received) {
  return {FromMicros(message.utime) + FromSeconds(clock_offset_s), received, SafeSeq(message.seq)};
}

template <class Message>
void JudgeTime(const Message& message, Timestamp received, FieldJudge& judge) {
  if (const auto fault = TimeFault(message.utime, received); !fault.empty()) {
    judge.Fail({Reason::kOutOfRange, fault});
  }
}

/// The channel says which sensor speaks; a driver may leave the name inside empty.
inline void JudgeSensor(const std::string& name, const std::string& configured, FieldJudge& judge) {
  judge.Need(name.empty() || name == configured, {Reason::kSensorMismatch, "sensor"});
}

inline bool LooksLikeDegrees(double angle) {
  return std::abs(angle) > kTurn_rad && std::abs(angle) <= 360.0;
}

/// A box without a score, or with 0, was published all the same: its detector is sure enough.
double Score(double score, std::string_view field, std::string_view percent_field,
             FieldJudge& judge);

/// What a detector calls its box; nullopt: no road user, the box is left out.
std::optional<ObjectClass> Class(const std::string& name, std::string_view field,
                                 RefusalTally& dropped);

}  // namespace v2vouch::wire
