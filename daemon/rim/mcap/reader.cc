// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/mcap/reader.h"

#include <algorithm>

#include "daemon/rim/mcap/chunk_data.h"

namespace v2vouch::mcap {
namespace {

constexpr std::size_t kPiece = 1U << 20U;  // Read at once, at most.

std::uint64_t LittleEndian(std::span<const std::uint8_t> bytes) {
  return FieldReader(bytes).Take<std::uint64_t>();
}

}  // namespace

Reader::Reader(Source source, ReaderLimits limits) : source_(std::move(source)), limits_(limits) {}

std::unique_ptr<Reader> Reader::Open(Source source, std::string& error, ReaderLimits limits) {
  std::unique_ptr<Reader> reader(new Reader(std::move(source), limits));
  std::array<std::uint8_t, kMagic.size()> magic{};
  if (reader->source_(magic) != magic.size() || magic != kMagic) {
    error = "no MCAP file";
    return nullptr;
  }
  Opcode opcode{};
  if (!reader->ReadRecord(opcode) || opcode != Opcode::kHeader) {
    error = "MCAP file without its header";
    return nullptr;
  }
  FieldReader fields(reader->record_);
  fields.Text();
  reader->library_ = fields.Text();
  return reader;
}

const Schema* Reader::FindSchema(std::uint16_t id) const {
  const auto found = schemas_.find(id);
  return found == schemas_.end() ? nullptr : &found->second;
}

// Into record_. False at the end; what has come of a torn record is then in record_.
bool Reader::ReadRecord(Opcode& opcode) {
  record_.clear();
  std::array<std::uint8_t, kRecordHeaderBytes> header{};
  const std::size_t have = source_(header);
  if (have != header.size()) {
    is_over_ = true;
    fault_ = have == 0 ? "the file ends without a footer" : "the file ends within a record";
    return false;
  }
  opcode = static_cast<Opcode>(header[0]);
  const std::uint64_t length = LittleEndian(std::span(header).subspan(1));
  if (length > limits_.record_bytes) {
    is_over_ = true;
    fault_ = "a record of " + std::to_string(length) + " bytes";
    return false;
  }
  while (record_.size() < length) {
    const std::size_t before = record_.size();
    const std::size_t want = std::min<std::size_t>(kPiece, length - before);
    record_.resize(before + want);
    const std::size_t got = source_(std::span(record_).subspan(before, want));
    if (got < want) {
      record_.resize(before + got);
      is_over_ = true;
      fault_ = "the file ends within a record";
      return false;
    }
  }
  return true;
}

void Reader::OpenChunk(bool is_torn) {
  FieldReader fields(record_);
  fields.Take<std::uint64_t>();
  fields.Take<std::uint64_t>();
  const auto size = fields.Take<std::uint64_t>();
  const auto crc = fields.Take<std::uint32_t>();
  const std::string compression(fields.Text());
  const auto packed_size = fields.Take<std::uint64_t>();
  const auto packed = is_torn ? fields.rest() : fields.Raw(packed_size);
  if (!fields.is_good()) {
    damaged_chunks_ += is_torn ? 0 : 1;
    return;
  }
  const UnpackFault fault = Unpack(compression, packed, size, limits_.chunk_bytes, chunk_);
  const bool is_whole = fault == UnpackFault::kNone && (crc == 0 || Crc32(chunk_) == crc);
  // Of a torn chunk everything in front of the tear is as it was written.
  if (is_whole || (is_torn && fault == UnpackFault::kData)) {
    rest_ = chunk_;
  } else {
    ++damaged_chunks_;
  }
}

bool Reader::Remember(std::size_t bytes) {
  known_bytes_ += bytes;
  return known_bytes_ <= limits_.known_bytes;
}

// @return whether it is a message that can be handed out.
bool Reader::TakeRecord(Opcode opcode, std::span<const std::uint8_t> content, Message& message) {
  FieldReader fields(content);
  if (opcode == Opcode::kSchema) {
    Schema schema;
    schema.id = fields.Take<std::uint16_t>();
    schema.name = fields.Text();
    schema.encoding = fields.Text();
    schema.data = fields.Text();
    // The same one again is in every file's summary.
    if (fields.is_good() && !schemas_.contains(schema.id) && Remember(content.size())) {
      schemas_[schema.id] = std::move(schema);
    }
  } else if (opcode == Opcode::kChannel) {
    if (content.size() > limits_.known_bytes) return false;
    const auto id = fields.Take<std::uint16_t>();
    if (channels_.contains(id)) return false;
    Channel channel;
    channel.id = id;
    channel.schema_id = fields.Take<std::uint16_t>();
    channel.topic = fields.Text();
    channel.message_encoding = fields.Text();
    channel.metadata = fields.Map();
    if (fields.is_good() && Remember(content.size())) channels_[id] = std::move(channel);
  } else if (opcode == Opcode::kMessage) {
    const auto id = fields.Take<std::uint16_t>();
    message.sequence = fields.Take<std::uint32_t>();
    message.log_ns = fields.Take<std::uint64_t>();
    message.publish_ns = fields.Take<std::uint64_t>();
    message.data = fields.rest();
    const auto found = channels_.find(id);
    if (!fields.is_good() || found == channels_.end()) {
      ++stray_messages_;
      return false;
    }
    message.channel = &found->second;
    return true;
  }
  return false;
}

bool Reader::NextInChunk(Message& message) {
  while (rest_.size() >= kRecordHeaderBytes) {
    const auto opcode = static_cast<Opcode>(rest_[0]);
    const std::uint64_t length = LittleEndian(rest_.subspan(1, 8));
    if (length > rest_.size() - kRecordHeaderBytes) {
      damaged_chunks_ += is_over_ ? 0 : 1;  // Of a torn chunk it is the tear.
      break;
    }
    const auto content = rest_.subspan(kRecordHeaderBytes, static_cast<std::size_t>(length));
    rest_ = rest_.subspan(kRecordHeaderBytes + content.size());
    if (TakeRecord(opcode, content, message)) return true;
  }
  rest_ = {};
  return false;
}

bool Reader::Next(Message& message) {
  for (;;) {
    if (NextInChunk(message)) return true;
    if (is_over_) return false;
    Opcode opcode{};
    if (!ReadRecord(opcode)) {
      if (opcode == Opcode::kChunk) OpenChunk(/*is_torn=*/true);
      continue;
    }
    if (opcode == Opcode::kChunk) {
      OpenChunk(/*is_torn=*/false);
    } else if (opcode == Opcode::kFooter) {
      is_over_ = true;
      std::array<std::uint8_t, kMagic.size()> magic{};
      if (source_(magic) != magic.size() || magic != kMagic)
        fault_ = "no closing magic behind the footer";
    } else if (TakeRecord(opcode, record_, message)) {
      return true;
    }
  }
}

}  // namespace v2vouch::mcap
