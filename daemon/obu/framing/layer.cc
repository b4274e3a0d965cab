// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/framing/layer.h"

namespace v2vouch::obu {
namespace {

constexpr std::array<std::string_view, static_cast<std::size_t>(Layer::kCount)> kNames = {
    "linux_cooked", "ip",   "udp",  "ethernet", "radiotap", "wlan", "llc",      "c2p",   "cohda",
    "cv2x",         "wsmp", "dot2", "geo",      "btp",      "hex",  "rsu_text", "frame", "cam"};

}  // namespace

std::string_view LayerName(Layer layer) { return kNames.at(static_cast<std::size_t>(layer)); }

std::optional<Layer> LayerOfName(std::string_view name) {
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (kNames[i] == name) return static_cast<Layer>(i);
  }
  return std::nullopt;
}

}  // namespace v2vouch::obu
