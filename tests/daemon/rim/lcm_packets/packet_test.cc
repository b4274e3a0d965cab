// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/lcm_packets/packet.h"

#include <gtest/gtest.h>

#include <set>
#include <utility>

#include "tests/support/lcm_datagrams.h"

namespace v2vouch::lcm_packets {
namespace {

using testing::FragmentDatagram;
using testing::FragmentHeader;
using testing::Octets;
using testing::ShortDatagram;
using testing::WithChannel;

constexpr std::size_t kMost = 1 << 20;

PacketFault FaultOf(const Octets& datagram) {
  Packet packet;
  return ReadPacket(datagram, kMost, packet);
}

TEST(LcmPacket, AShortMessageIsReadWhole) {
  const Octets datagram = ShortDatagram(0x01020304, "POSE", {7, 8, 9});
  Packet packet;
  ASSERT_EQ(ReadPacket(datagram, kMost, packet), PacketFault::kNone);
  EXPECT_FALSE(packet.is_fragment);
  EXPECT_EQ(packet.sequence, 0x01020304u);
  EXPECT_EQ(packet.channel, "POSE");
  EXPECT_EQ(Octets(packet.data.begin(), packet.data.end()), (Octets{7, 8, 9}));
  // Of no bytes, and of the longest name.
  EXPECT_EQ(FaultOf(ShortDatagram(1, "A", {})), PacketFault::kNone);
  EXPECT_EQ(FaultOf(ShortDatagram(1, std::string(63, 'A'), {})), PacketFault::kNone);
}

TEST(LcmPacket, AFragmentIsReadWhole) {
  const Octets datagram = FragmentDatagram({5, 1000, 400, 2, 3}, Octets(600, 1));
  Packet packet;
  ASSERT_EQ(ReadPacket(datagram, kMost, packet), PacketFault::kNone);
  EXPECT_TRUE(packet.is_fragment);
  EXPECT_FALSE(packet.has_channel);
  EXPECT_EQ(packet.message_size, 1000u);
  EXPECT_EQ(packet.offset, 400u);
  EXPECT_EQ(packet.number, 2);
  EXPECT_EQ(packet.count, 3);
  EXPECT_EQ(packet.data.size(), 600u);
}

TEST(LcmPacket, EveryPrefixOfAHeaderIsRefused) {
  const Octets whole = ShortDatagram(1, "POSE", {});
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const Octets prefix(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_EQ(FaultOf(prefix), size < 8 ? PacketFault::kDatagram : PacketFault::kChannel) << size;
  }
  const Octets fragment = FragmentDatagram({1, 100, 0, 0, 2}, WithChannel("POSE", {}));
  for (std::size_t size = 8; size < fragment.size(); ++size) {
    const Octets prefix(fragment.begin(), fragment.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_EQ(FaultOf(prefix), size < 20 ? PacketFault::kDatagram : PacketFault::kChannel) << size;
  }
  EXPECT_EQ(FaultOf(ShortDatagram(1, "A", Octets(65507))), PacketFault::kDatagram);
}

TEST(LcmPacket, EachFieldThatCannotBeIsNamed) {
  Octets magic = ShortDatagram(1, "POSE", {});
  magic[3] = '4';
  EXPECT_EQ(FaultOf(magic), PacketFault::kMagic);
  EXPECT_EQ(FaultOf(ShortDatagram(1, "", {1})), PacketFault::kChannel);
  EXPECT_EQ(FaultOf(ShortDatagram(1, std::string(64, 'A'), {})), PacketFault::kChannel);
  Octets endless = ShortDatagram(1, "POSE", {});
  endless.pop_back();
  EXPECT_EQ(FaultOf(endless), PacketFault::kChannel);

  const auto fragment = [](const FragmentHeader& header) {
    return FaultOf(FragmentDatagram(header, Octets(8, 'A')));
  };
  EXPECT_EQ(fragment({1, 100, 16, 1, 0}), PacketFault::kFragmentCount);
  EXPECT_EQ(fragment({1, 100, 16, 1, 102}), PacketFault::kFragmentCount);
  EXPECT_EQ(fragment({1, 100, 16, 2, 2}), PacketFault::kFragmentNumber);
  EXPECT_EQ(fragment({1, 100, 16, 0xFFFF, 2}), PacketFault::kFragmentNumber);
  EXPECT_EQ(fragment({1, 0, 0, 1, 2}), PacketFault::kMessageSize);
  EXPECT_EQ(fragment({1, 0xFFFFFFFF, 16, 1, 2}), PacketFault::kMessageSize);
  EXPECT_EQ(fragment({1, 0xFFFFFFFF, 16, 1, 0xFFFF}), PacketFault::kMessageSize);
  EXPECT_EQ(fragment({1, kMost + 1, 16, 1, 0xFFFF}), PacketFault::kTooLarge);
  // The one that kills liblcm 1.3.1, and its neighbours.
  for (const std::uint32_t offset :
       {0xFFFFFFF0u, 0xFFFFFFFFu, 0xFFFFFFF8u, 100u, 93u, 0x80000000u}) {
    EXPECT_EQ(fragment({1, 100, offset, 1, 2}), PacketFault::kFragmentOffset) << offset;
  }
  EXPECT_EQ(fragment({1, 100, 92, 1, 2}), PacketFault::kNone);
  EXPECT_EQ(FaultOf(FragmentDatagram({1, 100, 16, 1, 2}, {})), PacketFault::kEmptyFragment);
  EXPECT_EQ(FaultOf(FragmentDatagram({1, 100, 1, 0, 2}, WithChannel("A", {1}))),
            PacketFault::kFragmentOffset);
  EXPECT_EQ(FaultOf(FragmentDatagram({1, 100, 0, 0, 2}, WithChannel("", {1}))),
            PacketFault::kChannel);
  EXPECT_EQ(FaultOf(FragmentDatagram({1, 100, 0, 0, 2}, Octets(70, 'A'))), PacketFault::kChannel);
}

TEST(LcmPacket, EveryFaultHasAReasonAndAFieldOfItsOwn) {
  std::set<std::pair<std::string_view, std::string_view>> names;
  for (std::size_t i = 1; i < kPacketFaultCount; ++i) {
    const FaultName name = NameOf(static_cast<PacketFault>(i));
    EXPECT_FALSE(name.reason.empty());
    EXPECT_FALSE(name.field.empty());
    EXPECT_TRUE(names.emplace(name.reason, name.field).second) << name.field;
  }
}

}  // namespace
}  // namespace v2vouch::lcm_packets
