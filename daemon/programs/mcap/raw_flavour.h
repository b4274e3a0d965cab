// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "daemon/rim/io/event_log.h"
#include "daemon/rim/mcap/reader.h"
#include "daemon/rim/mcap/writer.h"
#include "daemon/rim/message_schema/message_schema.h"

namespace v2vouch::mcap_export {

/// Nanoseconds of MCAP; times that it cannot hold (before 1970, after 2262) are clamped.
std::uint64_t Nanoseconds(Timestamp time);

/// Raw flavour, LCM's own bytes:
///
///     channel  topic = LCM channel, message_encoding "lcm",
///              metadata lcm_channel, lcm_fingerprint (16 hex digits)
///     schema   "v2vouch.track_list_t", encoding "lcmtype", data = .lcm files of the type and all
///              types in it; none for other people's types
///     message  sequence = event number (its lower 32 bits), log_time = the event's time,
///              publish_time = utime of the message, data = its bytes
///
/// What these fields cannot hold (a number that does not follow, a time before 1970, a channel that
/// is no UTF-8) stands in a message of channel `lcm_event_header` in front of the event: number
/// (8), microseconds (8), big endian, channel. So every event comes back as it was.
class RawWriter {
 public:
  explicit RawWriter(mcap::Writer& writer) : writer_(writer) {}
  void Write(const LogEvent& event);

 private:
  std::optional<std::uint16_t> ChannelOf(const LogEvent& event);
  void WriteHeader(const LogEvent& event);

  mcap::Writer& writer_;
  std::int64_t last_number_ = -1;
  std::map<std::pair<std::string, std::uint64_t>, std::uint16_t> channels_;
  std::map<const message_schema::Type*, std::uint16_t> schemas_;
  std::optional<std::uint16_t> header_channel_;
  std::optional<std::uint16_t> other_channel_;  // For what has no channel of its own.
};

/// The way back.
class RawReader {
 public:
  /// @return true where `message` is an event, now in `event`.
  bool Read(const mcap::Message& message, LogEvent& event);
  /// Messages of other encodings, or impossible as LCM events.
  [[nodiscard]] std::int64_t refused() const { return refused_; }

 private:
  std::int64_t last_number_ = -1;
  bool has_header_ = false;
  LogEvent header_;
  std::int64_t refused_ = 0;
};

}  // namespace v2vouch::mcap_export
