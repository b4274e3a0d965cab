// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "daemon/base/reason.h"

namespace v2vouch {

/// How often each reason and field came up: detections left out of a scan, figures left unused.
/// Bounded: fields are literals, and beyond kMost of them the field is no longer told apart.
class RefusalTally {
 public:
  struct Entry {
    Refusal refusal;
    std::uint64_t count = 0;
  };
  static constexpr std::size_t kMost = 64;

  void Add(Refusal refusal, std::uint64_t count = 1) {
    auto at = std::ranges::find(entries_, refusal, &Entry::refusal);
    if (at == entries_.end() && entries_.size() >= kMost) {
      refusal.field = {};
      at = std::ranges::find(entries_, refusal, &Entry::refusal);
    }
    if (at == entries_.end()) {
      entries_.push_back({refusal, count});
    } else {
      at->count += count;
    }
  }
  void Clear() { entries_.clear(); }

  [[nodiscard]] std::span<const Entry> entries() const { return entries_; }
  /// Of one reason, whatever the field.
  [[nodiscard]] std::uint64_t CountOf(Reason reason) const {
    std::uint64_t sum = 0;
    for (const Entry& entry : entries_) sum += entry.refusal.reason == reason ? entry.count : 0;
    return sum;
  }
  [[nodiscard]] std::uint64_t CountOf(const Refusal& refusal) const {
    const auto at = std::ranges::find(entries_, refusal, &Entry::refusal);
    return at == entries_.end() ? 0 : at->count;
  }

 private:
  std::vector<Entry> entries_;
};

}  // namespace v2vouch
