// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/rim/message_schema/message_schema.h"

namespace v2vouch::spy {

inline constexpr std::size_t kMostChannels = 512;      ///< Further ones share a row.
inline constexpr std::size_t kMostKept = 256U << 10U;  ///< Of a channel's newest message [bytes].
inline constexpr char kOtherChannels[] = "(others)";

/// What was seen of one channel.
struct ChannelRow {
  const message_schema::Type* type = nullptr;  ///< Of the newest message; nullptr: none of ours.
  std::uint64_t fingerprint = 0;
  std::int64_t messages = 0;
  std::int64_t bytes = 0;
  std::int64_t first_us = 0, last_us = 0;       ///< Arrival.
  std::optional<std::int64_t> stamp_us;         ///< utime of the newest message.
  std::int64_t gaps = 0;                        ///< Messages missing by `seq`.
  std::int64_t repeats = 0;                     ///< `seq` that stood still or went back.
  std::map<std::string, std::int64_t> refused;  ///< Messages that do not decode, by reason.
  std::vector<std::uint8_t> newest;             ///< Empty where it was too large to keep.

  // Arrivals in half seconds, newest 20; interval statistics since the first.
  struct Bucket {
    std::int64_t half_second = -1;
    std::int64_t messages = 0, bytes = 0;
  };
  std::array<Bucket, 20> buckets;
  double interval_sum_s = 0.0, interval_square_s2 = 0.0;
  std::optional<std::int64_t> seq;

  /// Messages and bytes per second over the last `seconds` (at most 9) before `now_us`.
  [[nodiscard]] double Rate(std::int64_t now_us, double seconds = 2.0) const;
  [[nodiscard]] double BytesPerSecond(std::int64_t now_us, double seconds = 2.0) const;
  /// Over everything; NaN with fewer than two messages.
  [[nodiscard]] double MeanRate() const;
  /// 1 sigma of the time between arrivals [s]; NaN with fewer than three messages.
  [[nodiscard]] double Jitter() const;
};

/// Everything seen on a bus or in a log, in bounded memory whatever comes. Pure.
class ChannelTable {
 public:
  void Take(std::string_view channel, std::span<const std::uint8_t> bytes, std::int64_t arrived_us);

  [[nodiscard]] const std::map<std::string, ChannelRow>& rows() const { return rows_; }
  [[nodiscard]] const ChannelRow* Find(const std::string& channel) const;
  [[nodiscard]] std::int64_t messages() const { return messages_; }
  [[nodiscard]] std::int64_t last_us() const { return last_us_; }

 private:
  std::map<std::string, ChannelRow> rows_;
  std::int64_t messages_ = 0;
  std::int64_t last_us_ = 0;
};

/// Why bytes are no message of the type they claim; "" where they are one, or of an unknown type.
std::string WhyRefused(std::span<const std::uint8_t> bytes);

}  // namespace v2vouch::spy
