// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "daemon/rim/message_schema/message_schema.h"

namespace v2vouch::message_schema {

/// A message as one line of JSON with the field names of its .lcm file. What is not finite is null
/// ("unavailable"); bytes of a fixed number (ids) are hex digits, others base64; text that is no
/// UTF-8 has U+FFFD in the place of each odd byte. int64 values are numbers.
/// @return nullopt where the bytes are no such message.
std::optional<std::string> JsonText(const Type& type, std::span<const std::uint8_t> message);

/// A JSON Schema of what JsonText() makes of this type: units and comments as descriptions.
std::string JsonSchema(const Type& type);

}  // namespace v2vouch::message_schema
