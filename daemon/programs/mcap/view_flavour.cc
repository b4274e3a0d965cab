// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/mcap/view_flavour.h"

#include <span>

#include "daemon/programs/mcap/raw_flavour.h"
#include "daemon/rim/foxglove/messages.h"
#include "daemon/rim/json/json_text.h"
#include "daemon/rim/message_schema/json_text.h"

namespace v2vouch::mcap_export {

void ViewWriter::Write(const LogEvent& event) {
  const message_schema::Type* type = message_schema::TypeOf(event.bytes);
  if (type == nullptr || !IsUtf8(event.channel)) {
    ++left_out_;
    return;
  }
  const auto messages = messages_.Of(event.channel, event.bytes, event.received);
  for (const ViewMessage& message : messages) {
    WriteJson(message.topic, std::string(message.schema), foxglove::Schema(message.schema),
              message.json, event.received);
  }
  if (type->name == "camera_image_t") {
    left_out_ += messages.empty() ? 1 : 0;
    return;
  }
  const auto json = message_schema::JsonText(*type, event.bytes);
  if (!json) {
    ++left_out_;
    return;
  }
  const std::string name = std::string(type->package) + '.' + std::string(type->name);
  WriteJson(event.channel, name, schemas_.contains(name) ? "" : message_schema::JsonSchema(*type),
            *json, event.received);
}

void ViewWriter::WriteJson(const std::string& topic, const std::string& schema,
                           std::string_view schema_text, std::string_view json,
                           Timestamp received) {
  auto known = schemas_.find(schema);
  if (known == schemas_.end()) {
    const auto id = writer_.AddSchema({0, schema, "jsonschema", std::string(schema_text)});
    known = schemas_.emplace(schema, id.value_or(0)).first;
  }
  const auto key = std::make_pair(topic, known->second);
  auto channel = channels_.find(key);
  if (channel == channels_.end()) {
    const auto id = writer_.AddChannel({0, known->second, topic, "json", {}});
    if (!id) {
      ++left_out_;
      return;
    }
    channel = channels_.emplace(key, *id).first;
  }
  const std::uint64_t time = Nanoseconds(received);
  writer_.Write(channel->second, sequences_[channel->second]++, time, time,
                {reinterpret_cast<const std::uint8_t*>(json.data()), json.size()});
}

}  // namespace v2vouch::mcap_export
