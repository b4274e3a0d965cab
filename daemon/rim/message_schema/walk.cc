// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/message_schema/walk.h"

#include <array>
#include <bit>
#include <vector>

namespace v2vouch::message_schema {
namespace {

constexpr int kMaxDepth = 16;  // Of types within types.

// LCM's fields lie one after the other, big endian, without padding.
class Walker {
 public:
  Walker(std::span<const std::uint8_t> bytes, Visitor& visitor)
      : bytes_(bytes), visitor_(visitor) {}

  [[nodiscard]] bool is_at_end() const { return bytes_.empty(); }

  bool Struct(const Type& type, int depth) {
    if (depth > kMaxDepth) return false;
    // Values of the integer fields so far, for the sizes of arrays; no type has more fields.
    std::array<std::int64_t, 128> integers{};
    if (type.fields.size() > integers.size()) return false;
    visitor_.BeginStruct(type);
    for (std::size_t i = 0; i < type.fields.size(); ++i) {
      const Field& field = type.fields[i];
      visitor_.Name(field);
      if (field.dimensions.empty()) {
        if (!Element(field, depth, &integers[i])) return false;
      } else if (!Array(field, field.dimensions, integers, depth)) {
        return false;
      }
    }
    visitor_.EndStruct();
    return true;
  }

 private:
  bool Array(const Field& field, std::span<const Dimension> dimensions,
             std::span<const std::int64_t> integers, int depth) {
    const Dimension& dimension = dimensions.front();
    const std::int64_t count = dimension.size_field >= 0
                                   ? integers[static_cast<std::size_t>(dimension.size_field)]
                                   : dimension.size;
    // Every element takes a byte at least: no type is empty.
    if (count < 0 || static_cast<std::uint64_t>(count) > bytes_.size()) return false;
    const auto elements = static_cast<std::size_t>(count);
    const bool is_last = dimensions.size() == 1;
    if (is_last && field.primitive == Primitive::kByte) {
      visitor_.Bytes(bytes_.first(elements), dimension.size_field < 0);
      bytes_ = bytes_.subspan(elements);
      return true;
    }
    visitor_.BeginArray(elements);
    for (std::size_t i = 0; i < elements; ++i) {
      const bool good = is_last ? Element(field, depth, nullptr)
                                : Array(field, dimensions.subspan(1), integers, depth);
      if (!good) return false;
    }
    visitor_.EndArray();
    return true;
  }

  bool Load(std::size_t size, std::uint64_t& value) {
    if (bytes_.size() < size) return false;
    value = 0;
    for (std::size_t i = 0; i < size; ++i) value = (value << 8U) | bytes_[i];
    bytes_ = bytes_.subspan(size);
    return true;
  }

  template <class T>
  bool Integer(std::int64_t* kept) {
    std::uint64_t bits = 0;
    if (!Load(sizeof(T), bits)) return false;
    const auto value = static_cast<T>(bits);
    if (kept != nullptr) *kept = value;
    visitor_.Integer(value);
    return true;
  }

  bool String() {
    std::uint64_t length = 0;
    if (!Load(4, length)) return false;
    if (length == 0 || length > bytes_.size() || bytes_[length - 1] != 0) return false;
    visitor_.Text({reinterpret_cast<const char*>(bytes_.data()), length - 1});
    bytes_ = bytes_.subspan(length);
    return true;
  }

  bool Element(const Field& field, int depth, std::int64_t* kept) {
    std::uint64_t bits = 0;
    switch (field.primitive) {
      case Primitive::kByte:
        return Integer<std::uint8_t>(kept);
      case Primitive::kBoolean:
        if (!Load(1, bits)) return false;
        visitor_.Boolean(bits != 0);
        return true;
      case Primitive::kInt8:
        return Integer<std::int8_t>(kept);
      case Primitive::kInt16:
        return Integer<std::int16_t>(kept);
      case Primitive::kInt32:
        return Integer<std::int32_t>(kept);
      case Primitive::kInt64:
        return Integer<std::int64_t>(kept);
      case Primitive::kFloat:
        if (!Load(4, bits)) return false;
        visitor_.Real(static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits))));
        return true;
      case Primitive::kDouble:
        if (!Load(8, bits)) return false;
        visitor_.Real(std::bit_cast<double>(bits));
        return true;
      case Primitive::kString:
        return String();
      case Primitive::kStruct:
        return Struct(Types()[static_cast<std::size_t>(field.type)], depth + 1);
    }
    return false;
  }

  std::span<const std::uint8_t> bytes_;
  Visitor& visitor_;
};

}  // namespace

bool Walk(const Type& type, std::span<const std::uint8_t> message, Visitor& visitor) {
  if (message.size() < 8 || FingerprintOf(message) != type.fingerprint) return false;
  // Once in vain, so that a visitor never sees half a message.
  Visitor nobody;
  Walker check(message.subspan(8), nobody);
  if (!check.Struct(type, 0) || !check.is_at_end()) return false;
  return Walker(message.subspan(8), visitor).Struct(type, 0);
}

}  // namespace v2vouch::message_schema
