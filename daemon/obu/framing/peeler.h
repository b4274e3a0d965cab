// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/obu/framing/datagram.h"

namespace v2vouch::obu {

/// Takes one layer after the other off, each by its own lengths. No layer can contain itself, so
/// the depth is bounded by their number.
class Peeler {
 public:
  explicit Peeler(Datagram& datagram) : datagram_(datagram) {}

  /// @param may_trail bytes that may follow the layer.
  Fault Peel(Layer layer, Bytes bytes, std::size_t may_trail);
  /// What a link layer carries, by its Ethernet type.
  Fault PeelLink(const LinkPayload& payload);

 private:
  Fault PeelFrame(Bytes bytes, std::size_t may_trail);
  Fault PeelDot2(Bytes bytes, std::size_t may_trail);
  Fault PeelWsmp(Bytes bytes, std::size_t may_trail);
  Fault PeelC2p(Bytes bytes, std::size_t may_trail);
  Fault PeelWlan(Bytes bytes);
  Fault PeelGeo(Bytes bytes, std::size_t may_trail);
  Fault PeelGeoCommon(Bytes bytes, std::size_t may_trail);
  Fault PeelBtp(Bytes bytes);
  Fault PeelCohda(Bytes bytes);
  Fault PeelCam(Bytes bytes);
  Fault CheckTrailing(std::size_t trailing, std::size_t may_trail, std::string_view where);

  Datagram& datagram_;
};

}  // namespace v2vouch::obu
