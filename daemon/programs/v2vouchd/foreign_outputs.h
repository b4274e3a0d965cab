// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <span>

namespace v2vouch {

/// Tells messages on our own output channels that are not ours: a second daemon's on the same bus,
/// or those of a recorded log that somebody plays. LCM gives us back each message that we publish,
/// once. What comes beyond that is foreign: a second daemon with the same inputs sends the same
/// bytes. Sent() is called before publishing.
class ForeignOutputs {
 public:
  void Sent(std::span<const std::uint8_t> bytes);
  void Heard(std::span<const std::uint8_t> bytes);
  /// Foreign messages so far.
  [[nodiscard]] std::int64_t count() const;

 private:
  static std::uint64_t HashOf(std::span<const std::uint8_t> bytes);

  // Some seconds of lists and status: what we hear is milliseconds old.
  static constexpr std::size_t kRemembered = 1024;

  mutable std::mutex mutex_;
  std::array<std::uint64_t, kRemembered> sent_{};
  std::size_t next_ = 0;
  std::int64_t count_ = 0;
};

}  // namespace v2vouch
