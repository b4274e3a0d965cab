// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/json/json_text.h"
#include "daemon/rim/message_schema/json_text.h"

namespace v2vouch::message_schema {
namespace {

std::string ValueSchema(const Field& field);

std::string StructSchema(const Type& type) {
  std::string json = R"({"type":"object","description":)";
  AppendJsonString(json, type.comment);
  json += ",\"properties\":{";
  bool is_first = true;
  for (const Field& field : type.fields) {
    if (!is_first) json += ',';
    is_first = false;
    AppendJsonString(json, field.name);
    json += ':';
    std::string schema = ValueSchema(field);
    const bool is_bytes = field.primitive == Primitive::kByte && field.dimensions.size() == 1;
    const std::size_t arrays = field.dimensions.size() - (is_bytes ? 1 : 0);
    for (std::size_t i = 0; i < arrays; ++i) schema = R"({"type":"array","items":)" + schema + "}";
    std::string described;
    if (!field.unit.empty()) described = "[" + std::string(field.unit) + "] ";
    described += field.comment;
    if (!described.empty()) {
      schema.pop_back();
      schema += ",\"description\":";
      AppendJsonString(schema, described);
      schema += '}';
    }
    json += schema;
  }
  return json + "}}";
}

std::string ValueSchema(const Field& field) {
  switch (field.primitive) {
    case Primitive::kByte:
      if (field.dimensions.empty()) return R"({"type":"integer"})";
      return field.dimensions.back().size_field < 0
                 ? R"({"type":"string"})"
                 : R"({"type":"string","contentEncoding":"base64"})";
    case Primitive::kBoolean:
      return R"({"type":"boolean"})";
    case Primitive::kInt8:
    case Primitive::kInt16:
    case Primitive::kInt32:
    case Primitive::kInt64:
      return R"({"type":"integer"})";
    // null stands for NaN; one type only, as some readers know no lists of types.
    case Primitive::kFloat:
    case Primitive::kDouble:
      return R"({"type":"number"})";
    case Primitive::kString:
      return R"({"type":"string"})";
    case Primitive::kStruct:
      return StructSchema(Types()[static_cast<std::size_t>(field.type)]);
  }
  return "{}";
}

}  // namespace

std::string JsonSchema(const Type& type) {
  std::string json = R"({"$schema":"https://json-schema.org/draft/2020-12/schema","title":)";
  AppendJsonString(json, "v2vouch." + std::string(type.name));
  return json + ',' + StructSchema(type).substr(1);
}

}  // namespace v2vouch::message_schema
