// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "daemon/rim/mcap/records.h"

namespace v2vouch::mcap {

/// Valid until the reader's next call.
struct Message {
  const Channel* channel = nullptr;
  std::uint32_t sequence = 0;
  std::uint64_t log_ns = 0;
  std::uint64_t publish_ns = 0;
  std::span<const std::uint8_t> data;
};

struct ReaderLimits {
  std::size_t record_bytes = 256U << 20U;  ///< A longer record ends the reading.
  std::size_t chunk_bytes = 256U << 20U;   ///< Of a chunk's records, unpacked.
  std::size_t known_bytes = 64U << 20U;    ///< Of all schemas and channels.
};

/// Reads an MCAP file from its beginning, in the order of the file; neither summary nor index is
/// used, so a file that a crash left without them is read to where it breaks off, the records in a
/// torn chunk included. Memory grows with the bytes that come, not with lengths that are announced.
class Reader {
 public:
  /// Fills as much as there is; less only at the end.
  using Source = std::function<std::size_t(std::span<std::uint8_t>)>;

  /// @return nullptr with `error` set where it does not begin as MCAP does.
  static std::unique_ptr<Reader> Open(Source source, std::string& error, ReaderLimits limits = {});

  /// Messages in the order of the file. False at the end, or where nothing more can be read.
  bool Next(Message& message);

  /// Why reading ended; empty where the file is whole.
  [[nodiscard]] const std::string& fault() const { return fault_; }
  /// Chunks that were left out: wrong CRC, a compression that we do not know, damage within.
  [[nodiscard]] std::int64_t damaged_chunks() const { return damaged_chunks_; }
  /// Messages left out, as their channel is unknown.
  [[nodiscard]] std::int64_t stray_messages() const { return stray_messages_; }
  [[nodiscard]] const std::string& library() const { return library_; }
  /// nullptr where there is none.
  [[nodiscard]] const Schema* FindSchema(std::uint16_t id) const;

 private:
  Reader(Source source, ReaderLimits limits);
  bool ReadRecord(Opcode& opcode);
  void OpenChunk(bool is_torn);
  bool TakeRecord(Opcode opcode, std::span<const std::uint8_t> content, Message& message);
  bool NextInChunk(Message& message);
  bool Remember(std::size_t bytes);

  Source source_;
  ReaderLimits limits_;
  std::string library_;
  std::vector<std::uint8_t> record_;    // The content of the record at hand.
  std::vector<std::uint8_t> chunk_;     // Unpacked.
  std::span<const std::uint8_t> rest_;  // Of chunk_.
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, Channel> channels_;
  std::size_t known_bytes_ = 0;
  bool is_over_ = false;
  std::string fault_;
  std::int64_t damaged_chunks_ = 0;
  std::int64_t stray_messages_ = 0;
};

}  // namespace v2vouch::mcap
