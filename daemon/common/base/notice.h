// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>

namespace v2vouch {

/// A condition that is in force and that whoever runs the daemon should know. Each is published in
/// V2VOUCH_STATUS as long as it holds, and logged when it begins and ends.
enum class NoticeKind : std::uint8_t {
  kClockAhead,       ///< The source's stamps are ahead of what the other own sensors agree on [s].
  kClockBehind,      ///< The same, behind: its frames are too late to be used [s].
  kClockStuck,       ///< The source's stamps stand still while messages arrive [s of arrival].
  kInputSilent,      ///< Nothing has arrived from a configured own source for so long [s].
  kOverRate,         ///< The source sends more messages than any such sensor; some are refused.
  kGyroOffset,       ///< Learnt at standstill and taken off, where worth telling [deg/s].
  kGearContradicts,  ///< Gear and sign of the speed disagree [m/s as reported].
  kSpeedDeadband,    ///< The speed reads 0 while the world moves by: Doppler's is used [m/s].
  kSpeedSign,        ///< The speed is turned round [m/s as reported].
  kSpeedScale,       ///< The speed is multiplied by this factor.
  kSpeedFrozen,      ///< The reported speed does not change any more: Doppler's is used [m/s].
  kSpeedSuspect,     ///< Doppler of the standing world shows another speed; not corrected [m/s].
  kYawRateSuspect,   ///< Doppler of the standing world shows another yaw rate, by [deg/s].
  kForeignOutputs,   ///< Somebody else publishes on our output channels [messages in a second].
  kRadioFlood,       ///< BSMs dropped by our full queue [in a second].
  kHeightOffset,     ///< All heights differ from the ego's by a constant, which is taken out [m].
  kHeightsApart,     ///< All senders tell another height: taken for another level [m].
  kCount
};

inline constexpr std::size_t kNoticeKindCount = static_cast<std::size_t>(NoticeKind::kCount);

/// Snake-case name as published, e.g. "clock_ahead".
std::string_view NoticeName(NoticeKind kind);

/// What to do about it, one sentence.
std::string_view NoticeAdvice(NoticeKind kind);

/// What a notice is about.
struct NoticeSubject {
  enum class Kind : std::uint8_t { kCar, kEgoMotion, kGnss, kRadar, kCamera, kV2v, kSender };
  Kind kind = Kind::kCar;
  std::uint32_t index = 0;  ///< Of the radar or camera in the configuration; id of the sender.
  friend bool operator==(const NoticeSubject&, const NoticeSubject&) = default;
};

struct Notice {
  NoticeKind kind = NoticeKind::kCount;
  NoticeSubject subject;
  double value = std::numeric_limits<double>::quiet_NaN();  ///< In the unit of the kind; NaN: none.
};

}  // namespace v2vouch
