// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/rim/mcap/records.h"

namespace v2vouch::mcap {

struct WriterOptions {
  std::string library;  ///< Who wrote the file.
  Compression compression = Compression::kZstd;
  /// A chunk ends once it has so many (0: 512 KiB without compression, else 1 MiB),
  std::size_t chunk_bytes = 0;
  std::int64_t chunk_ns = 1'000'000'000;       ///< or spans so long with
  std::size_t short_chunk_bytes = 64U << 10U;  ///< at least so many.
};

/// Writes one MCAP file: every message in a chunk with its index, CRCs, a summary at the end.
/// Memory: one chunk, and about 60 bytes + 10 per channel in it for each chunk written.
class Writer {
 public:
  using Sink = std::function<void(std::span<const std::uint8_t>)>;

  Writer(Sink sink, WriterOptions options);

  /// `schema.id` is given here. @return nullopt once 65535 are there.
  std::optional<std::uint16_t> AddSchema(Schema schema);
  /// `channel.id` is given here. @return nullopt once 65535 are there.
  std::optional<std::uint16_t> AddChannel(Channel channel);
  void AddMetadata(const std::string& name, const Metadata& metadata);
  void Write(std::uint16_t channel, std::uint32_t sequence, std::uint64_t log_ns,
             std::uint64_t publish_ns, std::span<const std::uint8_t> data);
  /// Ends the chunk: what was written so far is in the file, and readable after a crash.
  void FlushChunk();
  /// Writes the summary; nothing may come after it.
  void Close();

  [[nodiscard]] std::uint64_t bytes_written() const { return offset_; }
  [[nodiscard]] std::uint64_t messages() const { return messages_; }
  [[nodiscard]] std::size_t chunks() const { return chunks_.size(); }

 private:
  struct ChunkEntry {
    std::uint64_t start_ns = 0, end_ns = 0;
    std::uint64_t offset = 0, length = 0;
    std::vector<std::pair<std::uint16_t, std::uint64_t>> index_offsets;
    std::uint64_t index_length = 0;
    std::uint64_t packed_size = 0, size = 0;
    std::string_view compression;  // A literal.
  };
  struct MetadataEntry {
    std::uint64_t offset = 0, length = 0;
    std::string name;
  };

  void Emit(std::span<const std::uint8_t> bytes);
  void EmitRecord(Opcode opcode);
  void EmitSummary();
  void EmitSchemas();
  void EmitChannels();
  void EmitStatistics();
  void EmitChunkIndexes();
  void EmitMetadataIndexes();

  Sink sink_;
  WriterOptions options_;
  std::uint64_t offset_ = 0;
  std::uint32_t crc_ = 0;  // Of the section that is being written.
  std::vector<Schema> schemas_;
  std::vector<Channel> channels_;
  std::vector<std::uint64_t> counts_;  // Messages of each channel, from id 1.

  std::vector<std::uint8_t> chunk_;
  bool has_messages_ = false;
  std::uint64_t start_ns_ = 0, end_ns_ = 0;  // Of the chunk.
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> index_;

  std::vector<ChunkEntry> chunks_;
  std::vector<MetadataEntry> metadata_;
  std::uint64_t messages_ = 0;
  std::uint64_t first_ns_ = 0, last_ns_ = 0;
  std::vector<std::uint8_t> content_;  // Scratch: a record.
  std::vector<std::uint8_t> packed_;
};

}  // namespace v2vouch::mcap
