// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "daemon/rim/mcap/chunk_data.h"
#include "daemon/rim/mcap/reader.h"
#include "daemon/rim/mcap/writer.h"

namespace v2vouch::mcap {
namespace {

using Bytes = std::vector<std::uint8_t>;

Reader::Source SourceOf(const Bytes& file) {
  return [&file, at = std::size_t{0}](std::span<std::uint8_t> into) mutable {
    const std::size_t size = std::min(into.size(), file.size() - at);
    std::copy_n(file.begin() + static_cast<std::ptrdiff_t>(at), size, into.begin());
    at += size;
    return size;
  };
}

Bytes MessageBytes(int number) {
  Bytes data(static_cast<std::size_t>(number % 40), static_cast<std::uint8_t>(number));
  return data;
}

// `messages` of them, 10 ms apart, in turn on two channels.
Bytes SampleFile(Compression compression, int messages, std::size_t chunk_bytes = 1000,
                 bool is_closed = true) {
  Bytes file;
  Writer writer(
      [&](std::span<const std::uint8_t> bytes) {
        file.insert(file.end(), bytes.begin(), bytes.end());
      },
      {.library = "test", .compression = compression, .chunk_bytes = chunk_bytes});
  const auto schema = writer.AddSchema({0, "v2vouch.x_t", "lcmtype", "struct x_t {}"});
  const auto first = writer.AddChannel({0, *schema, "A", "lcm", {{"key", "value"}}});
  const auto second = writer.AddChannel({0, 0, "B", "other", {}});
  writer.AddMetadata("about", {{"what", "a test"}});
  for (int i = 0; i < messages; ++i) {
    const auto time = static_cast<std::uint64_t>(i) * 10'000'000;
    writer.Write(i % 2 == 0 ? *first : *second, static_cast<std::uint32_t>(i), time, time + 1,
                 MessageBytes(i));
  }
  if (is_closed) writer.Close();
  return file;
}

// Reads to the end; every message must be the sample's of its number. Returns how many.
int ReadAll(const Bytes& file, std::string& fault, std::int64_t* damaged = nullptr) {
  const auto reader = Reader::Open(SourceOf(file), fault);
  if (!reader) return -1;
  Message message;
  int count = 0;
  while (reader->Next(message)) {
    EXPECT_EQ(message.channel->topic, message.sequence % 2 == 0 ? "A" : "B");
    const Bytes data(message.data.begin(), message.data.end());
    EXPECT_EQ(data, MessageBytes(static_cast<int>(message.sequence)));
    ++count;
  }
  fault = reader->fault();
  if (damaged != nullptr) *damaged = reader->damaged_chunks();
  return count;
}

class Mcap : public testing::TestWithParam<Compression> {};
INSTANTIATE_TEST_SUITE_P(Compressions, Mcap,
                         testing::Values(Compression::kNone, Compression::kZstd));

TEST_P(Mcap, WhatIsWrittenIsReadBack) {
  const Bytes file = SampleFile(GetParam(), 500);
  std::string fault;
  std::int64_t damaged = -1;
  EXPECT_EQ(ReadAll(file, fault, &damaged), 500);
  EXPECT_EQ(fault, "");
  EXPECT_EQ(damaged, 0);

  const auto reader = Reader::Open(SourceOf(file), fault);
  Message message;
  ASSERT_TRUE(reader->Next(message));
  EXPECT_EQ(reader->library(), "test");
  EXPECT_EQ(message.channel->metadata.at("key"), "value");
  EXPECT_EQ(reader->FindSchema(message.channel->schema_id)->data, "struct x_t {}");
  EXPECT_EQ(reader->FindSchema(0), nullptr);
}

// A reader takes whole chunks and the list of them (about 230 bytes each): what it reads of 1 GB to
// open the file and to have one moment stays below 1 MB with chunks of half a megabyte in the file.
TEST(McapChunks, HoldHalfAMegabyteWithoutCompressionUnlessToldOtherwise) {
  std::size_t written = 0;
  Writer writer([&](std::span<const std::uint8_t> bytes) { written += bytes.size(); },
                {.library = "test", .compression = Compression::kNone});
  const auto channel = writer.AddChannel({0, 0, "A", "lcm", {}});
  const Bytes data(1000);
  for (std::uint32_t i = 0; i < 10'000; ++i) writer.Write(*channel, i, i, i, data);
  EXPECT_NEAR(static_cast<double>(written) / static_cast<double>(writer.chunks()), 524'288, 30'000);
}

TEST_P(Mcap, FileThatACrashLeftIsReadUpToTheTear) {
  const Bytes file = SampleFile(GetParam(), 200);
  int before = -1;
  for (std::size_t size = 0; size < file.size(); size += 7) {
    std::string fault;
    const int count =
        ReadAll(Bytes(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(size)), fault);
    ASSERT_NE(fault, "") << size;
    ASSERT_GE(count, before) << size;  // More bytes, no fewer messages.
    before = std::max(before, count);
  }
  EXPECT_EQ(before, 200);  // The summary is all that is missing at last.
}

TEST(McapTorn, MessagesInFrontOfTheTearOfAChunkAreKept) {
  const Bytes file = SampleFile(Compression::kNone, 200, 1U << 20U);
  std::string fault;
  // The only chunk, cut in its middle.
  const int count = ReadAll(Bytes(file.begin(), file.begin() + 4000), fault);
  EXPECT_GT(count, 50);
  EXPECT_LT(count, 100);
}

TEST_P(Mcap, ChunkWithAWrongByteIsLeftOutAndCounted) {
  Bytes file = SampleFile(GetParam(), 500);
  std::size_t at = kMagic.size();  // The first chunk; in its middle lie packed records.
  const auto length = [&] {
    return FieldReader(std::span(file).subspan(at + 1)).Take<std::uint64_t>();
  };
  while (file[at] != 0x06) at += kRecordHeaderBytes + static_cast<std::size_t>(length());
  file[at + kRecordHeaderBytes + static_cast<std::size_t>(length()) * 2 / 3] ^= 1U;
  std::string fault;
  std::int64_t damaged = 0;
  const int count = ReadAll(file, fault, &damaged);
  EXPECT_LT(count, 500);
  EXPECT_GT(count, 400);
  EXPECT_EQ(damaged, 1);
}

TEST_P(Mcap, NoBytesHarmTheReader) {
  const Bytes good = SampleFile(GetParam(), 60, 400);
  std::mt19937_64 rng(20261130);
  for (int trial = 0; trial < 1'000; ++trial) {
    Bytes file = good;
    for (std::uint64_t k = rng() % 4 + 1; k > 0; --k) {
      file[rng() % file.size()] = static_cast<std::uint8_t>(rng());
    }
    std::string fault;
    const auto reader = Reader::Open(SourceOf(file), fault);
    if (!reader) continue;
    Message message;
    int count = 0;
    while (reader->Next(message)) ++count;
    ASSERT_LE(count, 10'000);
  }
}

TEST(McapLimits, AnnouncedLengthsTakeNoMemory) {
  // A chunk of 2^40 bytes, a record of 2^62: refused by what they say.
  Bytes file = SampleFile(Compression::kNone, 0, 1000, /*is_closed=*/false);
  Bytes longest = file;
  Fields(longest).Put(std::uint8_t{0x06});
  Fields(longest).Put(std::uint64_t{1} << 62U);
  std::string fault;
  EXPECT_EQ(ReadAll(longest, fault), 0);
  EXPECT_EQ(fault, "a record of 4611686018427387904 bytes");

  // A chunk that unpacks to more than it says.
  Bytes packed;
  ASSERT_TRUE(Compress(Bytes(50U << 20U, 0), packed));
  Bytes unpacked;
  EXPECT_EQ(Unpack("zstd", packed, 1000, 1U << 20U, unpacked), UnpackFault::kSize);
  EXPECT_LE(unpacked.size(), 1000U);
  EXPECT_EQ(Unpack("zstd", packed, 50U << 20U, 1U << 20U, unpacked), UnpackFault::kSize);
  EXPECT_EQ(Unpack("lz4", packed, 50, 1U << 20U, unpacked), UnpackFault::kCompression);
}

TEST(McapLimits, SchemasAndChannelsAreKeptUpToALimit) {
  Bytes file;
  Writer writer(
      [&](std::span<const std::uint8_t> bytes) {
        file.insert(file.end(), bytes.begin(), bytes.end());
      },
      {.library = "test"});
  for (int i = 0; i < 100; ++i) writer.AddChannel({0, 0, std::string(10'000, 'x'), "lcm", {}});
  writer.Write(100, 0, 0, 0, {});
  writer.Write(1, 0, 0, 0, {});
  writer.Close();
  std::string error;
  const auto reader = Reader::Open(SourceOf(file), error, {.known_bytes = 100'000});
  Message message;
  ASSERT_TRUE(reader->Next(message));
  EXPECT_EQ(message.channel->id, 1);
  EXPECT_FALSE(reader->Next(message));
  EXPECT_EQ(reader->stray_messages(), 1);
}

}  // namespace
}  // namespace v2vouch::mcap
