// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace v2vouch::message_schema {

enum class Primitive : std::uint8_t {
  kByte,
  kBoolean,
  kInt8,
  kInt16,
  kInt32,
  kInt64,
  kFloat,
  kDouble,
  kString,
  kStruct,
};

/// One dimension of an array: a number, or the field of the same type that holds it.
struct Dimension {
  int size = 0;
  int size_field = -1;  ///< Index in Type::fields; -1: `size` is the number.
};

struct Field {
  std::string_view name;
  Primitive primitive = Primitive::kByte;
  int type = -1;  ///< Of a kStruct: index in Types().
  std::span<const Dimension> dimensions;
  std::string_view unit;     ///< "m/s", "1e-7 degree"; empty where the field has none.
  std::string_view comment;  ///< As beside the field in the .lcm file.
};

struct Constant {
  std::string_view type;
  std::string_view name;
  std::string_view value;
};

/// One message type, as its .lcm file describes it.
struct Type {
  std::string_view package;
  std::string_view name;
  std::string_view comment;
  std::uint64_t fingerprint = 0;  ///< First eight bytes of a message, big endian.
  std::span<const Field> fields;
  std::span<const Constant> constants;
  std::string_view source;  ///< The .lcm file.
};

/// Every type of lcmtypes/, in the order of their names. Made by scripts/message_schema.
std::span<const Type> Types();

/// nullptr where there is none.
const Type* FindType(std::string_view name);
/// The type of a message by its first eight bytes; nullptr for other people's types.
const Type* TypeOf(std::span<const std::uint8_t> message);
/// The first eight bytes; 0 where there are fewer.
std::uint64_t FingerprintOf(std::span<const std::uint8_t> message);
/// Position of a field in its type; -1 where there is none.
int FieldIndex(const Type& type, std::string_view field);

/// The .lcm files of a type and of all types in it, with an empty line between.
std::string SourceWithNested(const Type& type);

/// The constant of `type` with this prefix and value, less the prefix: ("CLASS_", 1) -> "CAR";
/// empty where there is none.
std::string_view ConstantName(const Type& type, std::string_view prefix, std::int64_t value);

}  // namespace v2vouch::message_schema
