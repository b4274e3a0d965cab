// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/base/reason.h"

namespace v2vouch {
namespace {

constexpr std::array<std::string_view, kReasonCount> kNames = {
    "unknown_channel", "too_large",      "too_short",       "wrong_type",      "bad_length",
    "trailing_bytes",  "bad_string",     "decode_failed",   "not_finite",      "out_of_range",
    "field_unused",    "unknown_sensor", "sensor_mismatch", "duplicate",       "too_old",
    "future_stamp",    "stuck_stamp",    "over_rate",       "over_budget",     "no_ego_motion",
    "clock_restart",   "no_detector",    "bad_image",       "image_replaced",  "bsm_range",
    "bsm_unavailable", "bsm_stale",      "bsm_future",      "bsm_repeat",      "bsm_own_echo",
    "bsm_rate",        "bsm_table_full", "bsm_signature",   "bsm_implausible", "bsm_contradicted",
    "no_gnss",         "gnss_unusable",  "gnss_jump",       "track_numerics",  "sender_numerics",
    "track_table_full"};

static_assert(kNames.back() == "track_table_full", "one name per reason");

}  // namespace

std::string_view ReasonName(Reason reason) {
  const auto index = static_cast<std::size_t>(reason);
  return index < kReasonCount ? kNames[index] : "invalid";
}

}  // namespace v2vouch
