// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/message_schema/message_schema.h"

#include <algorithm>
#include <vector>

namespace v2vouch::message_schema {

const Type* FindType(std::string_view name) {
  const auto types = Types();
  const auto found = std::ranges::find(types, name, &Type::name);
  return found == types.end() ? nullptr : &*found;
}

std::uint64_t FingerprintOf(std::span<const std::uint8_t> message) {
  if (message.size() < 8) return 0;
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 8; ++i) value = (value << 8U) | message[i];
  return value;
}

const Type* TypeOf(std::span<const std::uint8_t> message) {
  if (message.size() < 8) return nullptr;
  const auto types = Types();
  const auto found = std::ranges::find(types, FingerprintOf(message), &Type::fingerprint);
  return found == types.end() ? nullptr : &*found;
}

int FieldIndex(const Type& type, std::string_view field) {
  const auto found = std::ranges::find(type.fields, field, &Field::name);
  return found == type.fields.end() ? -1 : static_cast<int>(found - type.fields.begin());
}

std::string SourceWithNested(const Type& type) {
  std::vector<const Type*> listed{&type};
  std::string source;
  for (std::size_t i = 0; i < listed.size(); ++i) {
    if (i > 0) source += '\n';
    source += listed[i]->source;
    for (const Field& field : listed[i]->fields) {
      if (field.type < 0) continue;
      const Type* nested = &Types()[static_cast<std::size_t>(field.type)];
      if (std::ranges::find(listed, nested) == listed.end()) listed.push_back(nested);
    }
  }
  return source;
}

std::string_view ConstantName(const Type& type, std::string_view prefix, std::int64_t value) {
  const std::string text = std::to_string(value);
  for (const Constant& constant : type.constants) {
    if (constant.name.starts_with(prefix) && constant.value == text) {
      return constant.name.substr(prefix.size());
    }
  }
  return {};
}

}  // namespace v2vouch::message_schema
