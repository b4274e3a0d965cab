// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "daemon/common/base/time.h"
#include "daemon/common/data/input.h"

namespace v2vouch {

/// Remembers which BSMs were heard, in fixed memory: a set-associative table of hashes, the oldest
/// of a set giving way. Eight bytes per message; 32 bits of hash beyond the set, so two different
/// messages are taken for one less than once in 10^8.
class RepeatMemory {
 public:
  /// Room for `capacity` messages, at most 2^21 (16 MB).
  RepeatMemory(std::size_t capacity, double memory_s);

  enum class Finding { kNew, kRepeat, kOtherSender };
  struct Answer {
    Finding finding = Finding::kNew;
    std::uint16_t id_tag = 0;  ///< Of the sender that was heard with the same core, if another.
  };

  /// Whether this (id, msgCnt, secMark, place) was heard, or the same core under another id.
  [[nodiscard]] Answer Look(const Bsm& bsm) const;
  /// Keeps it (anew). Call for messages that were not refused.
  void Keep(const Bsm& bsm);

  static std::uint16_t IdTag(SenderId sender);

 private:
  static constexpr std::size_t kWays = 8;  // One cache line.
  struct Entry {
    std::uint32_t tag = 0;  // Of the core; 0 = empty.
    std::uint16_t id_tag = 0;
    std::uint16_t tick = 0;  // Reception in units of 16.384 ms, wrapping after 17.9 minutes.
  };

  [[nodiscard]] std::uint16_t WindowOf(const Bsm& bsm) const;

  std::vector<Entry> entries_;
  std::size_t set_mask_ = 0;
  std::uint16_t window_ = 0;  // Memory in ticks.
};

}  // namespace v2vouch
