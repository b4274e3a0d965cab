// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/engine/refusal_table.h"

#include <algorithm>

namespace v2vouch {

RefusalTable::Row* RefusalTable::Find(std::string_view channel, const Refusal& refusal,
                                      std::string_view text) {
  const auto at = std::ranges::find_if(rows_, [&](const Row& row) {
    return row.refusal == refusal && row.channel == channel && row.text == text;
  });
  return at == rows_.end() ? nullptr : &*at;
}

void RefusalTable::Add(std::string_view channel, const Refusal& refusal, std::uint64_t count,
                       std::string_view text) {
  if (Row* row = Find(channel, refusal, text)) {
    row->count += count;
    return;
  }
  const bool is_unknown = refusal.reason == Reason::kUnknownChannel;
  if (is_unknown && channel != kOtherChannels && unknown_channels_ >= kMostUnknownChannels) {
    return Add(kOtherChannels, refusal, count);
  }
  if (!text.empty() && text != kOtherChannels && names_ >= kMostNames) {
    return Add(channel, refusal, count, kOtherChannels);
  }
  if (rows_.size() >= kMostRows && !(channel.empty() && refusal.field.empty())) {
    return Add({}, refusal.reason, count);
  }
  if (is_unknown) ++unknown_channels_;
  if (!text.empty()) ++names_;
  rows_.push_back({std::string(channel), refusal, count, std::string(text)});
}

Refusal WithField(Refusal refusal, wire::InputKind kind) {
  if (!refusal.field.empty()) return refusal;
  const bool is_bsm = kind == wire::InputKind::kBsm || kind == wire::InputKind::kOwnBsm;
  switch (refusal.reason) {
    case Reason::kWrongType:
      refusal.field = "fingerprint";
      break;
    case Reason::kTooOld:
    case Reason::kFutureStamp:
    case Reason::kStuckStamp:
    case Reason::kOverRate:
    case Reason::kOverBudget:
    case Reason::kClockRestart:
      refusal.field = is_bsm ? "rx_utime" : "utime";
      break;
    case Reason::kDuplicate:
      refusal.field = "seq";
      break;
    case Reason::kNoEgoMotion:
      refusal.field = is_bsm ? "rx_utime without EGO_MOTION" : "utime without EGO_MOTION";
      break;
    case Reason::kBsmStale:
    case Reason::kBsmFuture:
      refusal.field = "secMark";
      break;
    case Reason::kBsmRepeat:
      refusal.field = "msgCnt";
      break;
    case Reason::kBsmRate:
    case Reason::kBsmTableFull:
      refusal.field = "id";
      break;
    case Reason::kBsmSignature:
      refusal.field = "signature_state";
      break;
    case Reason::kBsmOwnEcho:
    case Reason::kBsmImplausible:
    case Reason::kBsmContradicted:
      refusal.field = "lat and long_";
      break;
    case Reason::kNoGnss:
      refusal.field = "lat and long_ without EGO_GNSS";
      break;
    case Reason::kGnssUnusable:
    case Reason::kGnssJump:
      refusal.field = "latitude_rad and longitude_rad";
      break;
    case Reason::kNoDetector:
    case Reason::kBadImage:
    case Reason::kImageReplaced:
      refusal.field = "data";
      break;
    default:
      break;
  }
  return refusal;
}

}  // namespace v2vouch
