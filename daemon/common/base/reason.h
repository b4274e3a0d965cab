// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace v2vouch {

/// Why an input, or a part of one, was refused. Each is counted and published.
enum class Reason : std::uint8_t {
  // Wire: the bytes are not a message of the expected type.
  kUnknownChannel,
  kTooLarge,
  kTooShort,
  kWrongType,
  kBadLength,      ///< A length field is negative, over its cap, or more than the bytes left.
  kTrailingBytes,  ///< The message ends before the buffer does.
  kBadString,
  kDecodeFailed,
  // Content: well-formed, but the values cannot be.
  kNotFinite,
  kOutOfRange,
  kFieldUnused,  ///< Not a refusal: the message was taken without this figure, which cannot be.
  kUnknownSensor,
  kSensorMismatch,  ///< The sensor named inside is not the one of the channel.
  // Time and order.
  kDuplicate,
  kTooOld,       ///< Older than the replay buffer.
  kFutureStamp,  ///< Too far ahead of what the own sensors agree on.
  kStuckStamp,   ///< One time of measurement over and over.
  kOverRate,     ///< More messages in a stretch of message time than any such sensor sends.
  kOverBudget,   ///< Late, and putting it in its place would cost more work than there is.
  kNoEgoMotion,
  kClockRestart,  ///< Not a refusal: the common clock was set, everything started again.
  // Camera.
  kNoDetector,
  kBadImage,
  kImageReplaced,  ///< A newer picture of the same camera came before the detector had time.
  // V2V.
  kBsmRange,        ///< A raw value J2735 does not define.
  kBsmUnavailable,  ///< Position, speed, heading or time missing: nothing to use.
  kBsmStale,
  kBsmFuture,
  kBsmRepeat,
  kBsmOwnEcho,
  kBsmRate,
  kBsmTableFull,
  kBsmSignature,
  kBsmImplausible,
  kBsmContradicted,  ///< Far from where the sensors see its sender: somebody else speaks in its
                     ///< name.
  kNoGnss,           ///< The car does not know yet where it is.
  kGnssUnusable,
  kGnssJump,
  // Numerical failures inside one track or sender, which was dropped.
  kTrackNumerics,
  kSenderNumerics,
  kTrackTableFull,
  kCount
};

inline constexpr std::size_t kReasonCount = static_cast<std::size_t>(Reason::kCount);

/// Snake-case name as published, e.g. "bsm_own_echo".
std::string_view ReasonName(Reason reason);

/// Why, and on account of which field.
struct Refusal {
  Reason reason = Reason::kCount;
  /// The field's name in its .lcm file, e.g. "speed_mps" or "detections.range_m"; "" = the message
  /// as a whole. Points at a literal.
  std::string_view field;

  constexpr Refusal() = default;
  constexpr Refusal(Reason why, std::string_view where = {})  // NOLINT(google-explicit-constructor)
      : reason(why), field(where) {}
  friend bool operator==(const Refusal&, const Refusal&) = default;
  friend bool operator==(const Refusal& a, Reason b) { return a.reason == b; }
};

/// One counter per reason.
using ReasonCounts = std::array<std::uint64_t, kReasonCount>;

}  // namespace v2vouch
