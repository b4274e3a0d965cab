// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace v2vouch::obu {

/// What can lie round a message, or be it. Also the names of framings: a datagram's framing is its
/// outermost layer.
enum class Layer : std::uint8_t {
  // Of a capture file.
  kLinuxCooked,
  kIp,
  kUdp,
  // Whole radio packets.
  kEthernet,
  kRadiotap,
  kWlan,
  kLlc,
  kC2p,    ///< Commsignia capture protocol.
  kCohda,  ///< Cohda's ETSI interface: a BTP indication.
  kCv2x,   ///< The byte 01 before a WAVE short message of a C-V2X radio.
  // Network and security.
  kWsmp,
  kDot2,
  kGeo,
  kBtp,
  // Text.
  kHex,
  kRsuText,  ///< RSU 4.1 message file, "Version=0.7 ... Payload=0014...".
  // Messages.
  kFrame,  ///< SAE J2735 MessageFrame.
  kCam,
  kCount
};

/// Name as in configuration and output, e.g. "wsmp".
std::string_view LayerName(Layer layer);
std::optional<Layer> LayerOfName(std::string_view name);

/// The layers found, outermost first.
class LayerList {
 public:
  void Add(Layer layer) {
    if (count_ < layers_.size()) layers_[count_++] = layer;
  }
  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] const Layer* begin() const { return layers_.data(); }
  [[nodiscard]] const Layer* end() const { return layers_.data() + count_; }

 private:
  std::array<Layer, 16> layers_{};
  std::size_t count_ = 0;
};

}  // namespace v2vouch::obu
