// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/rim/lcm_packets/body.h"
#include "daemon/rim/lcm_packets/packet.h"
#include "daemon/rim/lcm_packets/packet_fault.h"

namespace v2vouch::lcm_packets {

/// Who sent a datagram: an LCM instance has a port of its own.
struct Sender {
  std::uint32_t address = 0;
  std::uint16_t port = 0;
  friend auto operator<=>(const Sender&, const Sender&) = default;
};

/// What half messages may take: of memory for what has come of them, not for what they announce.
struct AssemblerLimits {
  std::size_t message_bytes = 64U << 20U;
  std::size_t sender_bytes = 96U << 20U;
  std::size_t all_bytes = 160U << 20U;
  std::size_t sender_messages = 16;
  std::size_t all_messages = 256;
  std::int64_t silence_us = 1'000'000;  ///< Since the latest fragment.
  std::int64_t age_us = 10'000'000;     ///< Since the first.
};

/// A complete message. Valid until the next call of the assembler.
struct Message {
  std::string_view channel;
  std::span<const std::uint8_t> bytes;
};

/// Puts datagrams together to messages. Fragments may come in any order, twice, and mixed with
/// those of other messages and senders; a message is known by sender and sequence number, and
/// complete when each fragment has come and every byte exactly once. Whatever comes, no more memory
/// is taken than the limits say: beyond them the half message with the largest size x silence goes,
/// of its sender or of all, so that neither a few enormous announcements nor many small ones push
/// out a message that is on its way.
///
/// Reads no clock and opens no socket. Not for several threads.
class Assembler {
 public:
  /// @param wants tells whether anybody listens to a channel; the others' messages take no memory.
  explicit Assembler(std::function<bool(std::string_view)> wants, AssemblerLimits limits = {});
  ~Assembler();
  Assembler(const Assembler&) = delete;
  Assembler& operator=(const Assembler&) = delete;

  /// @param now_us of a clock that never jumps.
  /// @return the message that this datagram completes, where somebody wants it.
  std::optional<Message> Take(std::span<const std::uint8_t> datagram, const Sender& from,
                              std::int64_t now_us);
  /// Gives up what has waited too long; Take() does so too.
  void Expire(std::int64_t now_us);

  /// What the last Take() refused its datagram for; kNone where it is part of a message.
  [[nodiscard]] PacketFault fault() const { return fault_; }
  /// Everything refused or given up so far.
  [[nodiscard]] const PacketCounts& counts() const { return counts_; }
  [[nodiscard]] std::size_t half_messages() const { return halves_.size(); }
  [[nodiscard]] std::size_t reserved_bytes() const { return reserved_; }

 private:
  struct Key {
    Sender sender;
    std::uint32_t sequence = 0;
    friend auto operator<=>(const Key&, const Key&) = default;
  };
  struct Half;
  struct Finished {
    Key key;
    std::int64_t at_us = 0;
    bool is_set = false;
  };
  using Halves = std::map<Key, Half>;

  std::optional<Message> TakeFragment(const Packet& packet, const Key& key, std::int64_t now_us);
  Halves::iterator Begin(const Packet& packet, const Key& key, std::int64_t now_us);
  std::optional<Message> Complete(Halves::iterator at, std::int64_t now_us);
  std::optional<Message> Refuse(PacketFault fault);
  bool MakeRoom(const Key& newest, std::int64_t now_us);
  static Halves::iterator MostInTheWay(Halves::iterator begin, Halves::iterator end,
                                       bool is_for_bytes, std::int64_t now_us);
  static void Empty(Half& half);
  void Account(Half& half);
  void GiveUp(Halves::iterator at, PacketFault fault);
  void Erase(Halves::iterator at);
  [[nodiscard]] bool IsFinished(const Key& key, std::int64_t now_us) const;

  std::function<bool(std::string_view)> wants_;
  AssemblerLimits limits_;
  PacketFault fault_ = PacketFault::kNone;
  PacketCounts counts_{};
  Halves halves_;
  std::size_t reserved_ = 0;
  std::int64_t looked_us_ = 0;  // For what has waited too long.
  std::array<Finished, 64> finished_{};
  std::size_t next_finished_ = 0;
  std::string delivered_channel_;
  Buffer delivered_;
  Buffer spare_;  // Of an earlier message: its memory is at hand.
};

}  // namespace v2vouch::lcm_packets
