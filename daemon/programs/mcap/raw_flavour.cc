// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/mcap/raw_flavour.h"

#include <cinttypes>
#include <cstdio>
#include <limits>

#include "daemon/rim/io/log_format.h"
#include "daemon/rim/json/json_text.h"

namespace v2vouch::mcap_export {
namespace {

constexpr char kEncoding[] = "lcm";
constexpr char kHeaderEncoding[] = "lcm_event_header";
// Channels of their own; what exceeds them shares one, with a header in front of each event.
constexpr std::size_t kMostChannels = 4096;
constexpr std::size_t kHeaderBytes = 16;
constexpr std::int64_t kMostMicros = std::numeric_limits<std::int64_t>::max() / 1000;

// Where a sequence number near `last` stands: its upper bits are those that make the step small.
std::int64_t Unwrap(std::int64_t last, std::uint32_t sequence) {
  const auto step = static_cast<std::int32_t>(sequence - static_cast<std::uint32_t>(last));
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(last) +
                                   static_cast<std::uint64_t>(std::int64_t{step}));
}

// The first field of every message of ours is its time.
std::uint64_t PublishTime(const LogEvent& event, const message_schema::Type* type) {
  if (type == nullptr || event.bytes.size() < 16) return Nanoseconds(event.received);
  const std::string_view first = type->fields.front().name;
  if (first != "utime" && first != "rx_utime") return Nanoseconds(event.received);
  const auto utime = log_format::Load<std::int64_t>(event.bytes.data() + 8);
  return utime > 0 ? Nanoseconds(FromMicros(utime)) : Nanoseconds(event.received);
}

}  // namespace

std::uint64_t Nanoseconds(Timestamp time) {
  const std::int64_t micros = std::clamp(ToMicros(time), std::int64_t{0}, kMostMicros);
  return static_cast<std::uint64_t>(micros) * 1000;
}

std::optional<std::uint16_t> RawWriter::ChannelOf(const LogEvent& event) {
  const message_schema::Type* type = message_schema::TypeOf(event.bytes);
  const std::uint64_t fingerprint = message_schema::FingerprintOf(event.bytes);
  const auto key = std::make_pair(event.channel, fingerprint);
  if (const auto found = channels_.find(key); found != channels_.end()) return found->second;
  if (channels_.size() >= kMostChannels || !IsUtf8(event.channel)) {
    return std::nullopt;
  }
  std::uint16_t schema = 0;
  if (type != nullptr) {
    const auto known = schemas_.find(type);
    if (known != schemas_.end()) {
      schema = known->second;
    } else {
      std::string name = std::string(type->package) + '.' + std::string(type->name);
      schema =
          writer_
              .AddSchema({0, std::move(name), "lcmtype", message_schema::SourceWithNested(*type)})
              .value_or(0);
      schemas_[type] = schema;
    }
  }
  char digits[17];
  std::snprintf(digits, sizeof(digits), "%016" PRIx64, fingerprint);
  const auto id =
      writer_.AddChannel({0,
                          schema,
                          event.channel,
                          kEncoding,
                          {{"lcm_channel", event.channel}, {"lcm_fingerprint", digits}}});
  if (id) channels_[key] = *id;
  return id;
}

void RawWriter::WriteHeader(const LogEvent& event) {
  if (!header_channel_) {
    header_channel_ = writer_.AddChannel({0, 0, kHeaderEncoding, kHeaderEncoding, {}});
  }
  std::vector<std::uint8_t> data(kHeaderBytes);
  log_format::Store(data.data(), event.number);
  log_format::Store(data.data() + 8, ToMicros(event.received));
  data.insert(data.end(), event.channel.begin(), event.channel.end());
  const std::uint64_t time = Nanoseconds(event.received);
  writer_.Write(*header_channel_, static_cast<std::uint32_t>(event.number), time, time, data);
}

void RawWriter::Write(const LogEvent& event) {
  auto channel = ChannelOf(event);
  const auto sequence = static_cast<std::uint32_t>(event.number);
  const std::int64_t micros = ToMicros(event.received);
  const bool is_exact = channel && Unwrap(last_number_, sequence) == event.number && micros >= 0 &&
                        micros <= kMostMicros;
  if (!channel) {
    if (!other_channel_) {
      other_channel_ = writer_.AddChannel({0, 0, "(others)", kEncoding, {}});
    }
    channel = other_channel_;
  }
  if (!is_exact) WriteHeader(event);
  last_number_ = event.number;
  writer_.Write(*channel, sequence, Nanoseconds(event.received),
                PublishTime(event, message_schema::TypeOf(event.bytes)), event.bytes);
}

bool RawReader::Read(const mcap::Message& message, LogEvent& event) {
  const std::string& encoding = message.channel->message_encoding;
  if (encoding == kHeaderEncoding && message.data.size() >= kHeaderBytes) {
    header_.number = log_format::Load<std::int64_t>(message.data.data());
    header_.received = FromMicros(log_format::Load<std::int64_t>(message.data.data() + 8));
    const auto channel = message.data.subspan(kHeaderBytes);
    header_.channel.assign(channel.begin(), channel.end());
    has_header_ = true;
    return false;
  }
  if (encoding != kEncoding) {
    ++refused_;
    return false;
  }
  if (has_header_) {
    event.number = header_.number;
    event.received = header_.received;
    event.channel = header_.channel;
    has_header_ = false;
  } else {
    event.number = Unwrap(last_number_, message.sequence);
    event.received = FromMicros(static_cast<std::int64_t>(message.log_ns / 1000));
    const auto named = message.channel->metadata.find("lcm_channel");
    event.channel =
        named != message.channel->metadata.end() ? named->second : message.channel->topic;
  }
  if (event.channel.empty() || event.channel.size() > kMaxChannelLength ||
      message.data.size() > kMaxEventBytes) {
    ++refused_;
    return false;
  }
  last_number_ = event.number;
  event.bytes.assign(message.data.begin(), message.data.end());
  return true;
}

}  // namespace v2vouch::mcap_export
