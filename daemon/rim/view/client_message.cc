// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/view/client_message.h"

#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>

namespace v2vouch::view {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostIdBytes = 256;
constexpr double kSlowest = 0.05;
constexpr double kFastest = 50.0;

std::optional<std::uint32_t> IdIn(const Json& value) {
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > UINT32_MAX) return std::nullopt;
  return value.get<std::uint32_t>();
}

// The member, or a null where there is none.
const Json& Member(const Json& object, const char* key) {
  static const Json kNone;
  const auto found = object.find(key);
  return found == object.end() ? kNone : *found;
}

ClientMessage ReadSubscribe(const Json& items) {
  if (!items.is_array() || items.size() > kMostSubscriptions) {
    return NotUnderstood{"subscribe: subscriptions is no list of at most 64"};
  }
  Subscribe subscribe;
  for (const Json& item : items) {
    if (!item.is_object()) return NotUnderstood{"subscribe: an item is no object"};
    const auto id = IdIn(Member(item, "id"));
    const auto channel = IdIn(Member(item, "channelId"));
    if (!id || !channel) return NotUnderstood{"subscribe: id or channelId is no number"};
    subscribe.items.push_back({*id, *channel});
  }
  return subscribe;
}

ClientMessage ReadUnsubscribe(const Json& ids) {
  if (!ids.is_array() || ids.size() > kMostSubscriptions) {
    return NotUnderstood{"unsubscribe: subscriptionIds is no list of at most 64"};
  }
  Unsubscribe unsubscribe;
  for (const Json& value : ids) {
    const auto id = IdIn(value);
    if (!id) return NotUnderstood{"unsubscribe: an id is no number"};
    unsubscribe.ids.push_back(*id);
  }
  return unsubscribe;
}

template <class T>
T LittleEndian(std::span<const std::uint8_t> bytes) {
  T value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) value |= static_cast<T>(bytes[i]) << (8 * i);
  return value;
}

}  // namespace

ClientMessage ReadClientText(std::string_view text) {
  if (text.size() > kMostClientBytes) return NotUnderstood{"the message is too long"};
  // Deep nesting is nothing that a client of ours has.
  constexpr int kDeepest = 8;
  const auto is_shallow = [](int depth, Json::parse_event_t, Json&) { return depth < kDeepest; };
  const Json message = Json::parse(text, is_shallow, false);
  if (message.is_discarded() || !message.is_object()) {
    return NotUnderstood{"the message is no JSON object"};
  }
  const Json& op = Member(message, "op");
  if (!op.is_string()) return NotUnderstood{"op is missing"};
  const auto& name = op.get_ref<const std::string&>();
  if (name == "subscribe") return ReadSubscribe(Member(message, "subscriptions"));
  if (name == "unsubscribe") return ReadUnsubscribe(Member(message, "subscriptionIds"));
  if (name == "drawn") return Drawn{};
  if (name == "pictures") return WantPictures{Member(message, "on") == true};
  return NotUnderstood{"this server is read-only and has no operation of that name"};
}

ClientMessage ReadClientBinary(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kFixed = 19;
  if (bytes.empty() || bytes[0] != 3) {
    return NotUnderstood{"this server is read-only; the only binary message is playback control"};
  }
  if (bytes.size() < kFixed) return NotUnderstood{"playback control: too short"};
  const std::size_t length = LittleEndian<std::uint32_t>(bytes.subspan(15));
  if (length > kMostIdBytes || bytes.size() != kFixed + length) {
    return NotUnderstood{"playback control: length of the request id is wrong"};
  }
  PlaybackRequest request;
  if (bytes[1] > 1) return NotUnderstood{"playback control: unknown command"};
  request.play = bytes[1] == 0;
  const auto speed =
      static_cast<double>(std::bit_cast<float>(LittleEndian<std::uint32_t>(bytes.subspan(2))));
  if (!(speed >= kSlowest && speed <= kFastest)) {
    return NotUnderstood{"playback control: speed is not within 0.05 and 50"};
  }
  request.speed = speed;
  if (bytes[6] != 0) {
    request.seek_us =
        static_cast<std::int64_t>(LittleEndian<std::uint64_t>(bytes.subspan(7)) / 1000);
  }
  request.id.assign(bytes.begin() + kFixed, bytes.end());
  return request;
}

}  // namespace v2vouch::view
