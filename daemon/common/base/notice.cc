// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/base/notice.h"

namespace v2vouch {
namespace {

struct Words {
  std::string_view name;
  std::string_view advice;
};

constexpr std::array<Words, kNoticeKindCount> kWords = {{
    {"clock_ahead", "synchronise this source's clock, or configure its constant clock_offset_s"},
    {"clock_behind", "synchronise this source's clock, or shorten its way to the daemon"},
    {"clock_stuck", "this source repeats one time of measurement; restart it"},
    {"input_silent", "is the source running, and does it publish on this channel?"},
    {"over_rate", "this source sends far more often than such a sensor measures; lower its rate"},
    {"gyro_offset", "learnt at standstill and corrected; check the yaw rate sensor's offset"},
    {"gear_contradicts", "is the speed without sign, or the gear not connected?"},
    {"speed_deadband", "the wheel speed reads 0 at walking pace; radar Doppler is used instead"},
    {"speed_sign", "EGO_MOTION speed must be negative in reverse; corrected by gear and Doppler"},
    {"speed_scale", "check unit (m/s) and tyre size of EGO_MOTION speed; corrected by Doppler"},
    {"speed_frozen",
     "the speed source repeats one figure; restart it; radar Doppler is used instead"},
    {"speed_suspect",
     "EGO_MOTION speed disagrees with radar Doppler; check unit, sign and radar mounting"},
    {"yaw_rate_suspect", "EGO_MOTION yaw rate disagrees with radar Doppler; is the sensor frozen?"},
    {"foreign_outputs",
     "a second daemon on this bus, or a player of a recorded log that holds lists: whoever reads "
     "them gets both"},
    {"radio_flood",
     "more BSMs come than can be taken in; the oldest are dropped, own sensors are not"},
    {"height_offset",
     "set the GNSS receiver to height above the ellipsoid, not sea level; senders may do it wrong, "
     "too"},
    {"heights_apart",
     "a bridge, or heights above sea level here and the ellipsoid there: no V2V match"},
}};

static_assert(!kWords.back().name.empty(), "one entry per kind");

}  // namespace

std::string_view NoticeName(NoticeKind kind) {
  const auto index = static_cast<std::size_t>(kind);
  return index < kNoticeKindCount ? kWords[index].name : "invalid";
}

std::string_view NoticeAdvice(NoticeKind kind) {
  const auto index = static_cast<std::size_t>(kind);
  return index < kNoticeKindCount ? kWords[index].advice : "";
}

}  // namespace v2vouch
