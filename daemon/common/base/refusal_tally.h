// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/common/base/reason.h"

namespace v2vouch {

/// How often each reason and field came up: detections left out of a scan, figures left unused.
/// Bounded: fields are literals, and beyond kMost entries neither field nor text is told apart.
class RefusalTally {
 public:
  struct Entry {
    Refusal refusal;
    std::uint64_t count = 0;
    std::string text;  ///< What the field held, where that is a name; "" otherwise.
  };
  static constexpr std::size_t kMost = 64;

  void Add(Refusal refusal, std::uint64_t count = 1) { AddNamed(refusal, {}, count); }
  void AddNamed(Refusal refusal, std::string_view text, std::uint64_t count = 1) {
    const auto find = [&] {
      return std::ranges::find_if(entries_, [&](const Entry& entry) {
        return entry.refusal == refusal && entry.text == text;
      });
    };
    auto at = find();
    if (at == entries_.end() && entries_.size() >= kMost) {
      refusal.field = {};
      text = {};
      at = find();
    }
    if (at == entries_.end()) {
      entries_.push_back({refusal, count, std::string(text)});
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
  /// Of one reason and field, whatever the text.
  [[nodiscard]] std::uint64_t CountOf(const Refusal& refusal) const {
    std::uint64_t sum = 0;
    for (const Entry& entry : entries_) sum += entry.refusal == refusal ? entry.count : 0;
    return sum;
  }

 private:
  std::vector<Entry> entries_;
};

}  // namespace v2vouch
