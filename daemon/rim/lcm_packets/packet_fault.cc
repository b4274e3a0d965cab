// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/lcm_packets/packet_fault.h"

namespace v2vouch::lcm_packets {

Refusal RefusalOf(PacketFault fault) {
  switch (fault) {
    case PacketFault::kDatagram:
      return {Reason::kPacketMalformed, "datagram size"};
    case PacketFault::kMagic:
      return {Reason::kPacketMalformed, "magic"};
    case PacketFault::kChannel:
      return {Reason::kPacketMalformed, "channel"};
    case PacketFault::kMessageSize:
      return {Reason::kPacketMalformed, "msg_size"};
    case PacketFault::kTooLarge:
      return {Reason::kPacketTooLarge, "msg_size"};
    case PacketFault::kFragmentCount:
      return {Reason::kPacketMalformed, "fragments_in_msg"};
    case PacketFault::kFragmentNumber:
      return {Reason::kPacketMalformed, "fragment_no"};
    case PacketFault::kFragmentOffset:
      return {Reason::kPacketMalformed, "fragment_offset"};
    case PacketFault::kEmptyFragment:
      return {Reason::kPacketMalformed, "empty fragment"};
    case PacketFault::kOtherSize:
      return {Reason::kPacketContradicts, "msg_size"};
    case PacketFault::kOtherCount:
      return {Reason::kPacketContradicts, "fragments_in_msg"};
    case PacketFault::kOverlap:
      return {Reason::kPacketContradicts, "fragment_offset overlaps"};
    case PacketFault::kGap:
      return {Reason::kPacketContradicts, "fragments leave a gap"};
    case PacketFault::kDuplicate:
      return {Reason::kPacketDuplicate, "fragment_no"};
    case PacketFault::kAfterTheMessage:
      return {Reason::kPacketDuplicate, "msg_seqno"};
    case PacketFault::kSource:
      return {Reason::kPacketSource, "sender's address"};
    case PacketFault::kSilent:
      return {Reason::kMessageIncomplete, "no further fragment"};
    case PacketFault::kAge:
      return {Reason::kMessageIncomplete, "fragments too slow"};
    case PacketFault::kRoom:
      return {Reason::kMessageIncomplete, "no room"};
    case PacketFault::kMemory:
      return {Reason::kMessageIncomplete, "no memory"};
    case PacketFault::kNone:
    case PacketFault::kCount:
      break;
  }
  return {};
}

}  // namespace v2vouch::lcm_packets
