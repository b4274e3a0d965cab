// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "daemon/obu/etsi/cam.h"
#include "daemon/obu/etsi/geonetworking.h"
#include "daemon/obu/framing/device.h"
#include "daemon/obu/framing/layer.h"
#include "daemon/obu/framing/link.h"
#include "daemon/obu/ieee1609/dot2.h"
#include "daemon/obu/ieee1609/wsmp.h"
#include "daemon/obu/j2735/message_frame.h"
#include "daemon/obu/octets/hex_text.h"

namespace v2vouch::obu {

struct DatagramOptions {
  std::optional<Layer> framing;  ///< Only this one; nullopt: whichever fits.
  bool allow_text = false;       ///< Hex text and RSU message files too.
  std::uint16_t port = 0;        ///< UDP port it came to, where that is known.
};

/// One datagram or captured packet, taken apart. Points into its bytes, and into the scratch memory
/// where it was text.
struct Datagram {
  LayerList layers;  ///< Outermost first.
  Fault fault;       ///< Why there is no message to use; the layers tell how far it went.
  std::optional<UdpPacket> udp;
  std::optional<Radiotap> radiotap;
  std::optional<C2p> c2p;
  std::optional<Cohda> cohda;
  std::optional<Wsmp> wsmp;
  std::optional<Dot2Data> dot2;
  std::optional<GeoNetworking> geo;
  std::optional<std::uint16_t> btp_port;
  std::optional<MessageFrame> frame;
  std::optional<Bsm> bsm;  ///< Also where the fault is kOwnTransmission or kWrongPsid.
  std::optional<Cam> cam;
  std::size_t trailing = 0;  ///< Bytes behind the outermost layer that were let pass.

  /// Strongest signal that any layer tells of.
  [[nodiscard]] std::optional<int> rssi_dbm() const;
};

/// The framings that a datagram can have, in the order in which they are tried.
std::span<const Layer> Framings();

/// Takes a datagram apart by structure: a finite set of framings in a fixed order, each of which
/// must fit its lengths to the end; nothing is searched for.
///
///   | first bytes | framing |
///   | 00 14, another message's id, and a length that fits | bare MessageFrame |
///   | 03 80 .. 03 83 | IEEE 1609.2 |
///   | 03 00 .. 03 05, 0B | WSMP |
///   | 01 03, 01 0B | C-V2X family byte, WSMP |
///   | 01, 02, 11, 12 and an 802.11 frame or a type behind the header | Commsignia capture |
///   | Ethernet type 88DC or 8947; 00 00 (radiotap); 08, 88 (802.11); AA AA 03 | radio packets |
///   | 04 01 | Cohda's ETSI interface |
///   | 11 00, 12 00 | GeoNetworking |
///   | 07 D1 .. .. 01/02 02; 01/02 02 | BTP with a CAM; bare CAM |
///   | text, where allowed | hex of any of these, RSU 4.1 message files |
///
/// Up to four bytes may follow the outermost layer (the check sequence of 802.11).
/// @param scratch at least kLongestDatagram bytes, used for text.
void ReadDatagram(Bytes bytes, const DatagramOptions& options, std::span<std::uint8_t> scratch,
                  Datagram& datagram);

/// A packet of a capture file. Link types as libpcap numbers them: 0, 1, 101, 105, 108, 113, 127,
/// 228, 229, 276.
void ReadPacket(int link_type, Bytes bytes, const DatagramOptions& options,
                std::span<std::uint8_t> scratch, Datagram& datagram);

}  // namespace v2vouch::obu
