// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/wire/layout.h"

#include <cstring>

namespace v2vouch::wire {
namespace {

class Walker {
 public:
  explicit Walker(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  std::optional<Reason> Struct(const Layout& layout) {
    if (rest_.size() < layout.min_bytes) return Reason::kTooShort;
    std::int32_t previous = 0;  // Value of the int32 field in front: the count of an array.
    for (const Field& field : layout.fields) {
      std::size_t count = static_cast<std::size_t>(field.fixed);
      if (field.max_count > 0) {
        if (previous < 0 || previous > field.max_count) return Reason::kBadLength;
        count = static_cast<std::size_t>(previous);
        // Also stops a huge count of elements that take no bytes.
        if (count * MinElementBytes(field) > rest_.size()) return Reason::kBadLength;
      }
      if (field.kind == Kind::kInt32 && count == 1 && rest_.size() >= 4) previous = Int32();
      if (const auto reason = Elements(field, count)) return reason;
    }
    return std::nullopt;
  }

  [[nodiscard]] bool is_done() const { return rest_.empty(); }

 private:
  std::optional<Reason> Elements(const Field& field, std::size_t count) {
    if (field.kind == Kind::kStruct) {
      for (std::size_t i = 0; i < count; ++i) {
        if (const auto reason = Struct(*field.type)) return reason;
      }
      return std::nullopt;
    }
    if (field.kind == Kind::kString) {
      for (std::size_t i = 0; i < count; ++i) {
        if (const auto reason = String(field.max_length)) return reason;
      }
      return std::nullopt;
    }
    return Skip(count * SizeOf(field.kind));
  }

  std::optional<Reason> String(int max_length) {
    if (rest_.size() < 4) return Reason::kTooShort;
    const std::int32_t length = Int32();
    rest_ = rest_.subspan(4);
    if (length < 1 || length > max_length + 1) return Reason::kBadString;
    const auto size = static_cast<std::size_t>(length);
    if (size > rest_.size()) return Reason::kBadString;
    // A NUL inside would be cut off when the text is encoded again.
    if (std::memchr(rest_.data(), 0, size) != rest_.data() + size - 1) return Reason::kBadString;
    return Skip(size);
  }

  std::optional<Reason> Skip(std::size_t bytes) {
    if (bytes > rest_.size()) return Reason::kTooShort;
    rest_ = rest_.subspan(bytes);
    return std::nullopt;
  }

  [[nodiscard]] std::int32_t Int32() const {
    const auto bits = (std::uint32_t{rest_[0]} << 24) | (std::uint32_t{rest_[1]} << 16) |
                      (std::uint32_t{rest_[2]} << 8) | std::uint32_t{rest_[3]};
    return static_cast<std::int32_t>(bits);
  }

  std::span<const std::uint8_t> rest_;
};

}  // namespace

std::optional<Reason> Walk(const Layout& layout, std::span<const std::uint8_t> bytes) {
  Walker walker(bytes);
  if (const auto reason = walker.Struct(layout)) return reason;
  if (!walker.is_done()) return Reason::kTrailingBytes;
  return std::nullopt;
}

}  // namespace v2vouch::wire
