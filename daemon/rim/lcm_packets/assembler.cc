// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/lcm_packets/assembler.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <new>
#include <utility>

namespace v2vouch::lcm_packets {
namespace {

// What a half message takes beside its bytes; one bit per fragment comes to it.
constexpr std::size_t kPerMessage = 512;
constexpr std::size_t kLargestSpare = 16U << 20U;
constexpr std::int64_t kLookPeriod_us = 50'000;

}  // namespace

struct Assembler::Half {
  std::uint32_t size = 0;
  std::uint16_t count = 0;
  std::uint16_t taken = 0;
  bool is_unwanted = false;  // Followed to its end without keeping a byte.
  std::string channel;       // "" until the first fragment is here.
  std::vector<bool> has;
  Body body;
  std::size_t reserved = 0;
  std::int64_t began_us = 0;
  std::int64_t latest_us = 0;
};

Assembler::Assembler(std::function<bool(std::string_view)> wants, AssemblerLimits limits)
    : wants_(std::move(wants)), limits_(limits) {}

Assembler::~Assembler() = default;

std::optional<Message> Assembler::Take(std::span<const std::uint8_t> datagram, const Sender& from,
                                       std::int64_t now_us) {
  fault_ = PacketFault::kNone;
  if (delivered_.capacity() > spare_.capacity() && delivered_.capacity() <= kLargestSpare) {
    spare_ = std::move(delivered_);
  }
  delivered_ = {};
  if (now_us - looked_us_ >= kLookPeriod_us) Expire(now_us);
  Packet packet;
  const PacketFault fault = ReadPacket(datagram, limits_.message_bytes, packet);
  if (fault != PacketFault::kNone) return Refuse(fault);
  if (packet.is_fragment) return TakeFragment(packet, {from, packet.sequence}, now_us);
  if (!wants_(packet.channel)) return std::nullopt;
  return Message{packet.channel, packet.data};
}

std::optional<Message> Assembler::Refuse(PacketFault fault) {
  fault_ = fault;
  ++counts_[static_cast<std::size_t>(fault)];
  return std::nullopt;
}

std::optional<Message> Assembler::TakeFragment(const Packet& packet, const Key& key,
                                               std::int64_t now_us) {
  auto at = halves_.find(key);
  if (at == halves_.end()) {
    if (IsFinished(key, now_us)) return Refuse(PacketFault::kAfterTheMessage);
    at = Begin(packet, key, now_us);
  }
  Half& half = at->second;
  if (packet.message_size != half.size) return Refuse(PacketFault::kOtherSize);
  if (packet.count != half.count) return Refuse(PacketFault::kOtherCount);
  try {
    if (half.has.empty()) half.has.resize(half.count);
    if (half.has[packet.number]) return Refuse(PacketFault::kDuplicate);
    if (packet.has_channel && !half.is_unwanted) {
      half.channel = packet.channel;
      if (!wants_(packet.channel)) Empty(half);
    }
    if (!half.is_unwanted && !half.body.Add(packet.offset, packet.data)) {
      return Refuse(PacketFault::kOverlap);
    }
  } catch (const std::bad_alloc&) {
    GiveUp(at, PacketFault::kMemory);
    fault_ = PacketFault::kMemory;
    return std::nullopt;
  }
  half.has[packet.number] = true;
  ++half.taken;
  half.latest_us = now_us;
  if (half.taken == half.count) return Complete(at, now_us);
  Account(half);
  if (!MakeRoom(key, now_us)) fault_ = PacketFault::kRoom;
  return std::nullopt;
}

Assembler::Halves::iterator Assembler::Begin(const Packet& packet, const Key& key,
                                             std::int64_t now_us) {
  const auto at = halves_.try_emplace(key).first;
  Half& half = at->second;
  half.size = packet.message_size;
  half.count = packet.count;
  half.began_us = half.latest_us = now_us;
  half.is_unwanted = packet.has_channel && !wants_(packet.channel);
  if (!half.is_unwanted) half.body = Body(packet.message_size, std::exchange(spare_, {}));
  return at;
}

std::optional<Message> Assembler::Complete(Halves::iterator at, std::int64_t now_us) {
  Half& half = at->second;
  const bool is_filled = half.is_unwanted || half.body.is_complete();
  const bool is_unwanted = half.is_unwanted;
  const std::size_t size = half.size;
  delivered_channel_ = std::move(half.channel);
  delivered_ = half.body.Release();
  finished_[next_finished_] = {at->first, now_us, true};
  next_finished_ = (next_finished_ + 1) % finished_.size();
  Erase(at);
  if (!is_filled) return Refuse(PacketFault::kGap);
  if (is_unwanted) return std::nullopt;
  return Message{delivered_channel_, {delivered_.data(), size}};
}

bool Assembler::IsFinished(const Key& key, std::int64_t now_us) const {
  return std::ranges::any_of(finished_, [&](const Finished& each) {
    return each.is_set && each.key == key && now_us - each.at_us <= limits_.silence_us;
  });
}

// Until both the newest one's sender and all together are within the limits. False where the newest
// itself had to go.
bool Assembler::MakeRoom(const Key& newest, std::int64_t now_us) {
  const Key first{newest.sender, 0};
  const Key last{newest.sender, std::numeric_limits<std::uint32_t>::max()};
  for (;;) {
    const auto begin = halves_.lower_bound(first);
    const auto end = halves_.upper_bound(last);
    std::size_t bytes = 0;
    std::size_t count = 0;
    for (auto each = begin; each != end; ++each) {
      bytes += each->second.reserved;
      ++count;
    }
    auto victim = halves_.end();
    if (bytes > limits_.sender_bytes || count > limits_.sender_messages) {
      victim = MostInTheWay(begin, end, bytes > limits_.sender_bytes, now_us);
    } else if (reserved_ > limits_.all_bytes || halves_.size() > limits_.all_messages) {
      victim = MostInTheWay(halves_.begin(), halves_.end(), reserved_ > limits_.all_bytes, now_us);
    } else {
      return true;
    }
    const bool is_newest = victim->first == newest;
    GiveUp(victim, PacketFault::kRoom);
    if (is_newest) return false;
  }
}

// Which has been silent for long and brought little; where bytes are short, and holds many.
Assembler::Halves::iterator Assembler::MostInTheWay(Halves::iterator begin, Halves::iterator end,
                                                    bool is_for_bytes, std::int64_t now_us) {
  const auto weight = [&](const Half& half) {
    constexpr double kDatagram = 1400.0;
    const double silence_us = 1.0 + static_cast<double>(now_us - half.latest_us);
    if (is_for_bytes) return static_cast<double>(half.reserved) * silence_us;
    return silence_us / (static_cast<double>(half.body.received()) + kDatagram);
  };
  return std::max_element(begin, end, [&](const auto& a, const auto& b) {
    return weight(a.second) < weight(b.second);
  });
}

void Assembler::Expire(std::int64_t now_us) {
  looked_us_ = now_us;
  for (auto at = halves_.begin(); at != halves_.end();) {
    const auto here = at++;
    if (now_us - here->second.latest_us > limits_.silence_us) {
      GiveUp(here, PacketFault::kSilent);
    } else if (now_us - here->second.began_us > limits_.age_us) {
      GiveUp(here, PacketFault::kAge);
    }
  }
}

void Assembler::Empty(Half& half) {
  half.is_unwanted = true;
  half.body = Body();
}

void Assembler::Account(Half& half) {
  const std::size_t reserved = kPerMessage + half.count / 8U + half.body.held();
  reserved_ += reserved - half.reserved;
  half.reserved = reserved;
}

// A message without a subscriber does not count as lost.
void Assembler::GiveUp(Halves::iterator at, PacketFault fault) {
  if (!at->second.is_unwanted) ++counts_[static_cast<std::size_t>(fault)];
  Erase(at);
}

void Assembler::Erase(Halves::iterator at) {
  reserved_ -= at->second.reserved;
  halves_.erase(at);
}

}  // namespace v2vouch::lcm_packets
