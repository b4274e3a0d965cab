// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <unordered_map>
#include <vector>

#include "v2vouch/bsm_t.hpp"

namespace v2vouch::obu {

/// Tells copies of a message (two antennas, two forwarding rows) from messages. Where a signal
/// strength is told, the first copy waits for `merge_us` and takes the strongest copy's figure.
class CopyFilter {
 public:
  CopyFilter(std::int64_t window_us, std::int64_t merge_us)
      : window_us_(window_us), merge_us_(merge_us) {}

  /// Whether a message of this content was added within the window before `utime`.
  /// @param key of the content, equal for copies.
  [[nodiscard]] bool IsCopy(std::uint64_t key, std::int64_t utime);
  /// A copy's signal, for the message if it still waits.
  void Strengthen(std::uint64_t key, std::optional<int> rssi_dbm);
  /// A message that is no copy: appended to `out` now or by a later Flush().
  void Add(std::uint64_t key, const bsm_t& message, std::vector<bsm_t>& out);

  /// Hands over what has waited long enough.
  void Flush(std::int64_t utime, std::vector<bsm_t>& out);
  /// When Flush() is due next.
  [[nodiscard]] std::optional<std::int64_t> due() const;

 private:
  static constexpr std::size_t kMost = 1U << 16;
  struct Waiting {
    std::uint64_t key;
    bsm_t message;
  };
  void Forget(std::int64_t utime);

  std::int64_t window_us_;
  std::int64_t merge_us_;
  std::unordered_map<std::uint64_t, std::int64_t> heard_;  // Key -> reception.
  std::deque<std::pair<std::int64_t, std::uint64_t>> by_age_;
  std::deque<Waiting> waiting_;
};

}  // namespace v2vouch::obu
