// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace v2vouch::mcap {

/// The format (mcap.dev/spec): magic, records, magic. A record is opcode (1), length (8), content;
/// all integers little endian; a string is its length (4) and UTF-8.
inline constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
inline constexpr std::size_t kRecordHeaderBytes = 9;

enum class Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

using Metadata = std::map<std::string, std::string>;

struct Schema {
  std::uint16_t id = 0;  ///< 0: none.
  std::string name;
  std::string encoding;  ///< Of `data`: "jsonschema"; "lcmtype" is ours.
  std::string data;
};

struct Channel {
  std::uint16_t id = 0;
  std::uint16_t schema_id = 0;
  std::string topic;
  std::string message_encoding;  ///< "json"; "lcm" is ours.
  Metadata metadata;
};

enum class Compression : std::uint8_t { kNone, kZstd };

/// Appends fields to the content of a record.
class Fields {
 public:
  explicit Fields(std::vector<std::uint8_t>& bytes) : bytes_(bytes) {}

  template <class T>
  void Put(T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      bytes_.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i)));
    }
  }
  void Put(std::string_view text) {
    Put(static_cast<std::uint32_t>(text.size()));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
  }
  void Put(const Metadata& map) {
    std::size_t size = 0;
    for (const auto& [key, value] : map) size += 8 + key.size() + value.size();
    Put(static_cast<std::uint32_t>(size));
    for (const auto& [key, value] : map) {
      Put(std::string_view(key));
      Put(std::string_view(value));
    }
  }
  void Raw(std::span<const std::uint8_t> raw) {
    bytes_.insert(bytes_.end(), raw.begin(), raw.end());
  }

 private:
  std::vector<std::uint8_t>& bytes_;
};

/// Takes fields from the front of bytes that may be hostile. After the first that is not there
/// everything is 0 or empty, and is_good() is false.
class FieldReader {
 public:
  explicit FieldReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  [[nodiscard]] bool is_good() const { return is_good_; }
  [[nodiscard]] bool is_at_end() const { return bytes_.empty(); }
  [[nodiscard]] std::span<const std::uint8_t> rest() const { return bytes_; }

  template <class T>
  T Take() {
    std::uint64_t value = 0;
    const auto raw = Raw(sizeof(T));
    for (std::size_t i = 0; i < raw.size(); ++i) {
      value |= static_cast<std::uint64_t>(raw[i]) << (8 * i);
    }
    return static_cast<T>(value);
  }
  std::string_view Text() {
    const auto raw = Raw(Take<std::uint32_t>());
    return {reinterpret_cast<const char*>(raw.data()), raw.size()};
  }
  Metadata Map() {
    FieldReader entries(Raw(Take<std::uint32_t>()));
    Metadata map;
    while (is_good_ && !entries.is_at_end()) {
      const std::string key(entries.Text());
      map[key] = entries.Text();
      is_good_ = entries.is_good_;
    }
    return map;
  }
  std::span<const std::uint8_t> Raw(std::uint64_t size) {
    if (!is_good_ || size > bytes_.size()) {
      is_good_ = false;
      bytes_ = {};
      return {};
    }
    const auto raw = bytes_.first(static_cast<std::size_t>(size));
    bytes_ = bytes_.subspan(raw.size());
    return raw;
  }

 private:
  std::span<const std::uint8_t> bytes_;
  bool is_good_ = true;
};

}  // namespace v2vouch::mcap
