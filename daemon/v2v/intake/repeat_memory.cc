// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/intake/repeat_memory.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace v2vouch {
namespace {

constexpr std::size_t kMostEntries = std::size_t{1} << 21;
constexpr int kTickShift = 14;  // 2^14 us.

// Without secMark a parked sender says the same again once msgCnt has gone round (12.8 s at 10 Hz):
// only closer repeats are repeats.
constexpr double kWindowWithoutTime_s = 5.0;

// Finaliser of splitmix64 (Steele, Lea, Flood 2014): every input bit reaches every output bit.
std::uint64_t Mix(std::uint64_t x) {
  x ^= x >> 30;
  x *= 0xbf58476d1ce4e5b9ULL;
  x ^= x >> 27;
  x *= 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

std::uint64_t CoreHash(const Bsm& bsm) {
  std::uint64_t h = 0x9e3779b97f4a7c15ULL;
  const auto add = [&h](std::uint64_t value) { h = Mix(h ^ value) + 0x9e3779b97f4a7c15ULL; };
  add(static_cast<std::uint64_t>(bsm.msg_count));
  add(static_cast<std::uint64_t>(bsm.sec_mark_ms.value_or(-1)));
  add(std::bit_cast<std::uint64_t>(bsm.latitude_rad.value_or(0.0)));
  add(std::bit_cast<std::uint64_t>(bsm.longitude_rad.value_or(0.0)));
  return Mix(h);
}

std::uint16_t TickOf(const Bsm& bsm) {
  return static_cast<std::uint16_t>(ToMicros(bsm.stamp) >> kTickShift);
}

std::uint32_t TagOf(std::uint64_t hash) { return static_cast<std::uint32_t>(hash >> 32) | 1U; }

std::uint16_t Ticks(double seconds) {
  return static_cast<std::uint16_t>(std::min(seconds * 1e6 / (1 << kTickShift), 65000.0));
}

}  // namespace

RepeatMemory::RepeatMemory(std::size_t capacity, double memory_s) : window_(Ticks(memory_s)) {
  const std::size_t entries = std::bit_ceil(std::clamp(capacity, std::size_t{1024}, kMostEntries));
  entries_.resize(entries);
  set_mask_ = entries / kWays - 1;
}

std::uint16_t RepeatMemory::IdTag(SenderId sender) {
  return static_cast<std::uint16_t>(Mix(sender + 0x9e3779b97f4a7c15ULL));
}

std::uint16_t RepeatMemory::WindowOf(const Bsm& bsm) const {
  return bsm.sec_mark_ms ? window_ : std::min(window_, Ticks(kWindowWithoutTime_s));
}

RepeatMemory::Answer RepeatMemory::Look(const Bsm& bsm) const {
  const std::uint64_t hash = CoreHash(bsm);
  const Entry* set = &entries_[(hash & set_mask_) * kWays];
  const std::uint16_t id_tag = IdTag(bsm.sender);
  const std::uint16_t now = TickOf(bsm);
  const std::uint16_t window = WindowOf(bsm);
  Answer answer;
  for (std::size_t way = 0; way < kWays; ++way) {
    if (set[way].tag != TagOf(hash)) continue;
    if (static_cast<std::uint16_t>(now - set[way].tick) > window) continue;
    if (set[way].id_tag == id_tag) return {Finding::kRepeat, id_tag};
    answer = {Finding::kOtherSender, set[way].id_tag};
  }
  return answer;
}

void RepeatMemory::Keep(const Bsm& bsm) {
  const std::uint64_t hash = CoreHash(bsm);
  Entry* set = &entries_[(hash & set_mask_) * kWays];
  const Entry entry{TagOf(hash), IdTag(bsm.sender), TickOf(bsm)};
  Entry* oldest = set;
  for (Entry* e = set; e != set + kWays; ++e) {
    if (e->tag == 0 || (e->tag == entry.tag && e->id_tag == entry.id_tag)) {
      oldest = e;
      break;
    }
    const auto age = [&entry](const Entry& of) {
      return static_cast<std::uint16_t>(entry.tick - of.tick);
    };
    if (age(*e) > age(*oldest)) oldest = e;
  }
  *oldest = entry;
}

}  // namespace v2vouch
