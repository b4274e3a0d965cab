// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/lcm_packets/packet_fault.h"

namespace v2vouch::lcm_packets {

FaultName NameOf(PacketFault fault) {
  switch (fault) {
    case PacketFault::kDatagram:
      return {"packet_malformed", "datagram size"};
    case PacketFault::kMagic:
      return {"packet_malformed", "magic"};
    case PacketFault::kChannel:
      return {"packet_malformed", "channel"};
    case PacketFault::kMessageSize:
      return {"packet_malformed", "msg_size"};
    case PacketFault::kTooLarge:
      return {"packet_too_large", "msg_size"};
    case PacketFault::kFragmentCount:
      return {"packet_malformed", "fragments_in_msg"};
    case PacketFault::kFragmentNumber:
      return {"packet_malformed", "fragment_no"};
    case PacketFault::kFragmentOffset:
      return {"packet_malformed", "fragment_offset"};
    case PacketFault::kEmptyFragment:
      return {"packet_malformed", "empty fragment"};
    case PacketFault::kOtherSize:
      return {"packet_contradicts", "msg_size"};
    case PacketFault::kOtherCount:
      return {"packet_contradicts", "fragments_in_msg"};
    case PacketFault::kOverlap:
      return {"packet_contradicts", "fragment_offset overlaps"};
    case PacketFault::kGap:
      return {"packet_contradicts", "fragments leave a gap"};
    case PacketFault::kDuplicate:
      return {"packet_duplicate", "fragment_no"};
    case PacketFault::kAfterTheMessage:
      return {"packet_duplicate", "msg_seqno"};
    case PacketFault::kSource:
      return {"packet_source", "sender's address"};
    case PacketFault::kSilent:
      return {"message_incomplete", "no further fragment"};
    case PacketFault::kAge:
      return {"message_incomplete", "fragments too slow"};
    case PacketFault::kRoom:
      return {"message_incomplete", "no room"};
    case PacketFault::kMemory:
      return {"message_incomplete", "no memory"};
    case PacketFault::kNone:
    case PacketFault::kCount:
      break;
  }
  return {};
}

}  // namespace v2vouch::lcm_packets
