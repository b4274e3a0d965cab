// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "daemon/common/base/reason.h"

namespace v2vouch::wire {

/// How one field of an LCM type lies in the bytes. LCM writes fields one after the other without
/// padding, big endian; a string is its length (4 bytes, its NUL included), then the bytes.
enum class Kind : std::uint8_t {
  kByte,
  kInt8,
  kInt16,
  kInt32,
  kInt64,
  kFloat,
  kDouble,
  kString,
  kStruct
};

struct Layout;

struct Field {
  std::string_view name;
  Kind kind = Kind::kByte;
  int fixed = 1;                 ///< Elements where their number is part of the type.
  const Layout* type = nullptr;  ///< Of a kStruct.
  /// The number of elements stands in the int32 field right in front, and is at most this; 0 where
  /// it does not. Bounds what a decoder will allocate.
  int max_count = 0;
  int max_length = 0;  ///< Of a kString, without its NUL.
};

/// The fields of one LCM type in their order.
struct Layout {
  std::string_view name;
  std::span<const Field> fields;
  std::size_t max_bytes = 0;  ///< Longer messages are refused unread; fingerprint included.
  std::size_t min_bytes = 0;  ///< Shortest possible encoding, fingerprint not included.
};

constexpr std::size_t SizeOf(Kind kind) {
  switch (kind) {
    case Kind::kByte:
    case Kind::kInt8:
      return 1;
    case Kind::kInt16:
      return 2;
    case Kind::kInt32:
    case Kind::kFloat:
      return 4;
    case Kind::kInt64:
    case Kind::kDouble:
      return 8;
    case Kind::kString:
      return 5;  // Length and NUL.
    case Kind::kStruct:
      return 0;
  }
  return 0;
}

constexpr std::size_t MinElementBytes(const Field& field) {
  return field.kind == Kind::kStruct ? field.type->min_bytes : SizeOf(field.kind);
}

constexpr Layout MakeLayout(std::string_view name, std::span<const Field> fields,
                            std::size_t max_bytes = 0) {
  std::size_t min_bytes = 0;
  for (const Field& field : fields) {
    if (field.max_count == 0) {
      min_bytes += static_cast<std::size_t>(field.fixed) * MinElementBytes(field);
    }
  }
  return {name, fields, max_bytes, min_bytes};
}

/// The layout of a type of lcmtypes/ (layout_limits.h); a test compares them with the .lcm files.
template <class T>
const Layout& LayoutOf();

/// Walks over one encoded value behind its fingerprint, believing nothing: every count is at least
/// 0, at most its cap, and its elements fit the bytes left; every string has its NUL, no other, and
/// fits; nothing is left over. Allocates nothing.
/// @return nullopt when lcm-gen's decode may be trusted with these bytes.
std::optional<Reason> Walk(const Layout& layout, std::span<const std::uint8_t> bytes);

}  // namespace v2vouch::wire
