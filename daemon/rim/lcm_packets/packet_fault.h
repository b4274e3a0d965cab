// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace v2vouch::lcm_packets {

/// Why a datagram, or what had come of a message, was thrown away.
enum class PacketFault : std::uint8_t {
  kNone,
  // The header cannot be.
  kDatagram,        ///< Shorter than a header, or longer than UDP allows.
  kMagic,           ///< Neither LC02 nor LC03.
  kChannel,         ///< Empty, longer than 63 bytes, or without an end.
  kMessageSize,     ///< 0, or more than so many fragments can carry.
  kTooLarge,        ///< More than a message may have.
  kFragmentCount,   ///< 0 fragments, or more fragments than bytes.
  kFragmentNumber,  ///< At or beyond the number of fragments.
  kFragmentOffset,  ///< Reaches outside the message, or the first one does not begin it.
  kEmptyFragment,
  // The header disagrees with what came before of the same message.
  kOtherSize,
  kOtherCount,
  kOverlap,  ///< Bytes that another fragment has brought already.
  kGap,      ///< All fragments are here and do not fill the message, which is dropped.
  // Seen before.
  kDuplicate,        ///< The same fragment again.
  kAfterTheMessage,  ///< A fragment of a message that is complete.
  kSource,           ///< Not from an allowed address.
  // Half a message, given up. Counted once for each message.
  kSilent,  ///< No further fragment came in time.
  kAge,     ///< Fragments came, but not all in time.
  kRoom,    ///< Others needed the room.
  kMemory,  ///< The system gave none.
  kCount
};

inline constexpr std::size_t kPacketFaultCount = static_cast<std::size_t>(PacketFault::kCount);

/// One counter per fault.
using PacketCounts = std::array<std::uint64_t, kPacketFaultCount>;

/// As it is counted and published: a reason, and the header's field under LCM's own name.
struct FaultName {
  std::string_view reason;
  std::string_view field;
};
FaultName NameOf(PacketFault fault);

}  // namespace v2vouch::lcm_packets
