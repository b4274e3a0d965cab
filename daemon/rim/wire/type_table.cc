// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/wire/type_table.h"

#include <algorithm>
#include <vector>

#include "v2vouch/bsm_t.hpp"
#include "v2vouch/bsm_verdict_t.hpp"
#include "v2vouch/calibration_t.hpp"
#include "v2vouch/camera_detections_t.hpp"
#include "v2vouch/camera_image_t.hpp"
#include "v2vouch/daemon_status_t.hpp"
#include "v2vouch/ego_intent_t.hpp"
#include "v2vouch/ego_motion_t.hpp"
#include "v2vouch/gnss_fix_t.hpp"
#include "v2vouch/misbehavior_report_t.hpp"
#include "v2vouch/object_list_t.hpp"
#include "v2vouch/obu_status_t.hpp"
#include "v2vouch/radar_scan_t.hpp"
#include "v2vouch/text_t.hpp"
#include "v2vouch/track_list_t.hpp"
#include "v2vouch/truth_bsm_t.hpp"
#include "v2vouch/truth_list_t.hpp"
#include "v2vouch/warning_list_t.hpp"

namespace v2vouch::wire {
namespace {

template <class... Types>
std::vector<WireType> TableOf() {
  return {WireType{static_cast<std::uint64_t>(Types::getHash()), &LayoutOf<Types>()}...};
}

}  // namespace

std::span<const WireType> ChannelTypes() {
  static const std::vector<WireType> table =
      TableOf<bsm_t, bsm_verdict_t, calibration_t, camera_detections_t, camera_image_t,
              daemon_status_t, ego_intent_t, ego_motion_t, gnss_fix_t, misbehavior_report_t,
              object_list_t, obu_status_t, radar_scan_t, text_t, track_list_t, truth_bsm_t,
              truth_list_t, warning_list_t>();
  return table;
}

const WireType* TypeOf(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 8) return nullptr;
  std::uint64_t fingerprint = 0;
  for (std::size_t i = 0; i < 8; ++i) fingerprint = (fingerprint << 8) | bytes[i];
  const auto table = ChannelTypes();
  const auto found = std::ranges::find(table, fingerprint, &WireType::fingerprint);
  return found == table.end() ? nullptr : &*found;
}

}  // namespace v2vouch::wire
