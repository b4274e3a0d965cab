// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/mcap/writer.h"

#include <algorithm>
#include <limits>

#include "daemon/common/base/check.h"
#include "daemon/rim/mcap/chunk_data.h"

namespace v2vouch::mcap {
namespace {

constexpr std::size_t kMostIds = std::numeric_limits<std::uint16_t>::max();

void PutRecordHeader(std::vector<std::uint8_t>& bytes, Opcode opcode, std::uint64_t length) {
  Fields fields(bytes);
  fields.Put(static_cast<std::uint8_t>(opcode));
  fields.Put(length);
}

void PutSchema(std::vector<std::uint8_t>& bytes, const Schema& schema) {
  Fields fields(bytes);
  fields.Put(schema.id);
  fields.Put(std::string_view(schema.name));
  fields.Put(std::string_view(schema.encoding));
  fields.Put(std::string_view(schema.data));
}

void PutChannel(std::vector<std::uint8_t>& bytes, const Channel& channel) {
  Fields fields(bytes);
  fields.Put(channel.id);
  fields.Put(channel.schema_id);
  fields.Put(std::string_view(channel.topic));
  fields.Put(std::string_view(channel.message_encoding));
  fields.Put(channel.metadata);
}

}  // namespace

Writer::Writer(Sink sink, WriterOptions options)
    : sink_(std::move(sink)), options_(std::move(options)) {
  // A reader takes whole chunks, and the whole list of chunks: half a megabyte in the file keeps
  // opening and one chunk together below a megabyte in a file of 1 GB.
  if (options_.chunk_bytes == 0) {
    options_.chunk_bytes = options_.compression == Compression::kNone ? 1U << 19U : 1U << 20U;
  }
  Emit(kMagic);
  Fields fields(content_);
  fields.Put(std::string_view());  // No profile is registered for LCM.
  fields.Put(std::string_view(options_.library));
  EmitRecord(Opcode::kHeader);
}

void Writer::Emit(std::span<const std::uint8_t> bytes) {
  crc_ = Crc32(bytes, crc_);
  offset_ += bytes.size();
  sink_(bytes);
}

// Writes what content_ holds, and empties it.
void Writer::EmitRecord(Opcode opcode) {
  std::vector<std::uint8_t> header;
  PutRecordHeader(header, opcode, content_.size());
  Emit(header);
  Emit(content_);
  content_.clear();
}

// Outside the chunks: a damaged chunk costs its own messages only.
std::optional<std::uint16_t> Writer::AddSchema(Schema schema) {
  if (schemas_.size() >= kMostIds) return std::nullopt;
  schema.id = static_cast<std::uint16_t>(schemas_.size() + 1);
  PutSchema(content_, schema);
  EmitRecord(Opcode::kSchema);
  schemas_.push_back(std::move(schema));
  return schemas_.back().id;
}

std::optional<std::uint16_t> Writer::AddChannel(Channel channel) {
  if (channels_.size() >= kMostIds) return std::nullopt;
  channel.id = static_cast<std::uint16_t>(channels_.size() + 1);
  PutChannel(content_, channel);
  EmitRecord(Opcode::kChannel);
  channels_.push_back(std::move(channel));
  counts_.push_back(0);
  return channels_.back().id;
}

void Writer::AddMetadata(const std::string& name, const Metadata& metadata) {
  FlushChunk();
  Fields fields(content_);
  fields.Put(std::string_view(name));
  fields.Put(metadata);
  metadata_.push_back({offset_, content_.size() + kRecordHeaderBytes, name});
  EmitRecord(Opcode::kMetadata);
}

void Writer::Write(std::uint16_t channel, std::uint32_t sequence, std::uint64_t log_ns,
                   std::uint64_t publish_ns, std::span<const std::uint8_t> data) {
  V2VOUCH_CHECK(channel >= 1 && channel <= channels_.size());
  index_[channel].emplace_back(log_ns, chunk_.size());
  PutRecordHeader(chunk_, Opcode::kMessage, 22 + data.size());
  Fields fields(chunk_);
  fields.Put(channel);
  fields.Put(sequence);
  fields.Put(log_ns);
  fields.Put(publish_ns);
  fields.Raw(data);

  start_ns_ = has_messages_ ? std::min(start_ns_, log_ns) : log_ns;
  end_ns_ = has_messages_ ? std::max(end_ns_, log_ns) : log_ns;
  first_ns_ = messages_ > 0 ? std::min(first_ns_, log_ns) : log_ns;
  last_ns_ = messages_ > 0 ? std::max(last_ns_, log_ns) : log_ns;
  has_messages_ = true;
  ++messages_;
  ++counts_[channel - 1U];
  const bool is_long = end_ns_ - start_ns_ >= static_cast<std::uint64_t>(options_.chunk_ns) &&
                       chunk_.size() >= options_.short_chunk_bytes;
  if (is_long || chunk_.size() >= options_.chunk_bytes) FlushChunk();
}

void Writer::FlushChunk() {
  if (chunk_.empty()) return;
  ChunkEntry entry;
  entry.start_ns = start_ns_;
  entry.end_ns = end_ns_;
  entry.offset = offset_;
  entry.size = chunk_.size();
  std::span<const std::uint8_t> records = chunk_;
  std::string_view compression;
  if (options_.compression == Compression::kZstd && Compress(chunk_, packed_)) {
    records = packed_;
    compression = "zstd";
  }
  entry.packed_size = records.size();
  entry.compression = compression;
  Fields fields(content_);
  fields.Put(start_ns_);
  fields.Put(end_ns_);
  fields.Put(static_cast<std::uint64_t>(chunk_.size()));
  fields.Put(Crc32(chunk_));
  fields.Put(compression);
  fields.Put(static_cast<std::uint64_t>(records.size()));
  fields.Raw(records);
  EmitRecord(Opcode::kChunk);
  entry.length = offset_ - entry.offset;

  const std::uint64_t index_start = offset_;
  for (const auto& [channel, entries] : index_) {
    entry.index_offsets.emplace_back(channel, offset_);
    fields.Put(channel);
    fields.Put(static_cast<std::uint32_t>(16 * entries.size()));
    for (const auto& [time, at] : entries) {
      fields.Put(time);
      fields.Put(at);
    }
    EmitRecord(Opcode::kMessageIndex);
  }
  entry.index_length = offset_ - index_start;
  chunks_.push_back(std::move(entry));
  chunk_.clear();
  index_.clear();
  has_messages_ = false;
  start_ns_ = end_ns_ = 0;
}

void Writer::Close() {
  FlushChunk();
  const std::uint32_t data_crc = crc_;
  Fields(content_).Put(data_crc);
  EmitRecord(Opcode::kDataEnd);
  EmitSummary();
  Emit(kMagic);
}

void Writer::EmitSummary() {
  crc_ = 0;
  const std::uint64_t summary_start = offset_;
  struct Group {
    Opcode opcode;
    std::uint64_t start, length;
  };
  std::vector<Group> groups;
  const auto emit_group = [&](Opcode opcode, void (Writer::*emit)()) {
    const std::uint64_t start = offset_;
    (this->*emit)();
    if (offset_ > start) groups.push_back({opcode, start, offset_ - start});
  };
  emit_group(Opcode::kSchema, &Writer::EmitSchemas);
  emit_group(Opcode::kChannel, &Writer::EmitChannels);
  emit_group(Opcode::kStatistics, &Writer::EmitStatistics);
  emit_group(Opcode::kChunkIndex, &Writer::EmitChunkIndexes);
  emit_group(Opcode::kMetadataIndex, &Writer::EmitMetadataIndexes);

  const std::uint64_t offsets_start = offset_;
  Fields fields(content_);
  for (const Group& group : groups) {
    fields.Put(static_cast<std::uint8_t>(group.opcode));
    fields.Put(group.start);
    fields.Put(group.length);
    EmitRecord(Opcode::kSummaryOffset);
  }
  // The CRC covers the footer up to itself.
  std::vector<std::uint8_t> footer;
  PutRecordHeader(footer, Opcode::kFooter, 20);
  Fields end(footer);
  end.Put(summary_start);
  end.Put(offsets_start);
  end.Put(Crc32(footer, crc_));
  Emit(footer);
}

void Writer::EmitSchemas() {
  for (const Schema& schema : schemas_) {
    PutSchema(content_, schema);
    EmitRecord(Opcode::kSchema);
  }
}

void Writer::EmitChannels() {
  for (const Channel& channel : channels_) {
    PutChannel(content_, channel);
    EmitRecord(Opcode::kChannel);
  }
}

void Writer::EmitStatistics() {
  Fields fields(content_);
  fields.Put(messages_);
  fields.Put(static_cast<std::uint16_t>(schemas_.size()));
  fields.Put(static_cast<std::uint32_t>(channels_.size()));
  fields.Put(std::uint32_t{0});  // Attachments.
  fields.Put(static_cast<std::uint32_t>(metadata_.size()));
  fields.Put(static_cast<std::uint32_t>(chunks_.size()));
  fields.Put(first_ns_);
  fields.Put(last_ns_);
  fields.Put(static_cast<std::uint32_t>(10 * counts_.size()));
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    fields.Put(static_cast<std::uint16_t>(i + 1));
    fields.Put(counts_[i]);
  }
  EmitRecord(Opcode::kStatistics);
}

void Writer::EmitChunkIndexes() {
  Fields fields(content_);
  for (const ChunkEntry& chunk : chunks_) {
    fields.Put(chunk.start_ns);
    fields.Put(chunk.end_ns);
    fields.Put(chunk.offset);
    fields.Put(chunk.length);
    fields.Put(static_cast<std::uint32_t>(10 * chunk.index_offsets.size()));
    for (const auto& [channel, offset] : chunk.index_offsets) {
      fields.Put(channel);
      fields.Put(offset);
    }
    fields.Put(chunk.index_length);
    fields.Put(chunk.compression);
    fields.Put(chunk.packed_size);
    fields.Put(chunk.size);
    EmitRecord(Opcode::kChunkIndex);
  }
}

void Writer::EmitMetadataIndexes() {
  Fields fields(content_);
  for (const MetadataEntry& entry : metadata_) {
    fields.Put(entry.offset);
    fields.Put(entry.length);
    fields.Put(std::string_view(entry.name));
    EmitRecord(Opcode::kMetadataIndex);
  }
}

}  // namespace v2vouch::mcap
