// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/io/event_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <lcm/lcm-cpp.hpp>
#include <random>

#include "tests/support/data_folder.h"

namespace v2vouch {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

class EventLog : public testing::Test {
 protected:
  EventLog() {
    std::string pattern = (fs::temp_directory_path() / "event_log_XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~EventLog() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string Path(const std::string& name) const {
    return (folder_ / name).string();
  }

  std::string Save(const std::string& name, const Bytes& content) const {
    std::ofstream(Path(name), std::ios::binary)
        .write(reinterpret_cast<const char*>(content.data()),
               static_cast<std::streamsize>(content.size()));
    return Path(name);
  }

  fs::path folder_;
};

Bytes Load(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return Bytes(std::istreambuf_iterator<char>(file), {});
}

struct Reading {
  std::vector<LogEvent> events;
  std::int64_t damaged = 0;
  std::string error;
};

Reading ReadAll(const std::string& path) {
  Reading reading;
  auto reader = LogReader::Open(path, reading.error);
  if (!reader) return reading;
  LogEvent event;
  while (reader->Next(event)) reading.events.push_back(event);
  EXPECT_DOUBLE_EQ(reader->progress(), 1.0);
  reading.damaged = reader->damaged();
  return reading;
}

Bytes Payload(std::size_t size, std::uint8_t seed) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>(seed + i * 7);
  return bytes;
}

// Ten events of growing size; returns where each starts.
std::vector<std::size_t> WriteTen(const std::string& path) {
  std::string error;
  auto writer = LogWriter::Create(path, error);
  EXPECT_TRUE(writer) << error;
  std::vector<std::size_t> starts;
  std::size_t at = 0;
  for (int i = 0; i < 10; ++i) {
    const std::string channel = "CHANNEL_" + std::to_string(i);
    const Bytes payload = Payload(static_cast<std::size_t>(i) * 50, static_cast<std::uint8_t>(i));
    starts.push_back(at);
    at += 28 + channel.size() + payload.size();
    writer->Write(FromMicros(1'000'000 + i), channel, payload);
  }
  starts.push_back(at);
  EXPECT_TRUE(writer->Close(error)) << error;
  return starts;
}

fs::path DataFile(const std::string& name) { return DataFolder() / "lcmlogs" / name; }

TEST_F(EventLog, WhatIsWrittenIsReadBack) {
  WriteTen(Path("a.lcm"));
  const Reading reading = ReadAll(Path("a.lcm"));
  ASSERT_EQ(reading.events.size(), 10u);
  EXPECT_EQ(reading.damaged, 0);
  for (int i = 0; i < 10; ++i) {
    const LogEvent& event = reading.events[static_cast<std::size_t>(i)];
    EXPECT_EQ(event.number, i);
    EXPECT_EQ(ToMicros(event.received), 1'000'000 + i);
    EXPECT_EQ(event.channel, "CHANNEL_" + std::to_string(i));
    EXPECT_EQ(event.bytes, Payload(static_cast<std::size_t>(i) * 50, static_cast<std::uint8_t>(i)));
  }
}

TEST_F(EventLog, LiblcmReadsWhatWeWrite) {
  WriteTen(Path("a.lcm"));
  lcm::LogFile log(Path("a.lcm"), "r");
  ASSERT_TRUE(log.good());
  for (int i = 0; i < 10; ++i) {
    const lcm::LogEvent* event = log.readNextEvent();
    ASSERT_NE(event, nullptr) << i;
    EXPECT_EQ(event->eventnum, i);
    EXPECT_EQ(event->timestamp, 1'000'000 + i);
    EXPECT_EQ(event->channel, "CHANNEL_" + std::to_string(i));
    EXPECT_EQ(event->datalen, i * 50);
  }
  EXPECT_EQ(log.readNextEvent(), nullptr);
}

TEST_F(EventLog, WeReadWhatLiblcmWrites) {
  {
    lcm::LogFile log(Path("b.lcm"), "w");
    ASSERT_TRUE(log.good());
    for (int i = 0; i < 5; ++i) {
      Bytes payload = Payload(100, static_cast<std::uint8_t>(i));
      lcm::LogEvent event{};
      event.timestamp = 77 + i;
      event.channel = "EGO_MOTION";
      event.datalen = 100;
      event.data = payload.data();
      ASSERT_EQ(log.writeEvent(&event), 0);
    }
  }
  const Reading reading = ReadAll(Path("b.lcm"));
  ASSERT_EQ(reading.events.size(), 5u);
  EXPECT_EQ(reading.damaged, 0);
  EXPECT_EQ(ToMicros(reading.events[4].received), 81);
  EXPECT_EQ(reading.events[4].bytes, Payload(100, 4));
}

TEST_F(EventLog, EveryTruncationKeepsTheWholeEventsInFront) {
  const auto starts = WriteTen(Path("a.lcm"));
  const Bytes whole = Load(Path("a.lcm"));
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const Reading reading =
        ReadAll(Save("cut.lcm", Bytes(whole.begin(), whole.begin() + static_cast<long>(length))));
    std::size_t complete = 0;
    while (starts[complete + 1] <= length) ++complete;
    ASSERT_EQ(reading.events.size(), complete) << length;
    if (complete == 0) {
      EXPECT_THAT(reading.error, testing::HasSubstr("holds no LCM event"));
    } else {
      EXPECT_EQ(reading.damaged, starts[complete] == length ? 0 : 1) << length;
    }
  }
}

TEST_F(EventLog, OneDamagedByteCostsAtMostOneEvent) {
  const auto starts = WriteTen(Path("a.lcm"));
  const Bytes whole = Load(Path("a.lcm"));
  for (std::size_t at = 0; at < whole.size(); ++at) {
    Bytes content = whole;
    content[at] = static_cast<std::uint8_t>(~content[at]);
    const Reading reading = ReadAll(Save("bad.lcm", content));
    EXPECT_GE(reading.events.size(), 9u)
        << "byte " << at << " of event "
        << std::upper_bound(starts.begin(), starts.end(), at) - starts.begin() - 1;
    EXPECT_LE(reading.events.size(), 10u);
  }
}

TEST_F(EventLog, BogusLengthsAreSkippedToTheNextEvent) {
  const auto starts = WriteTen(Path("a.lcm"));
  const Bytes whole = Load(Path("a.lcm"));
  const std::array<Bytes, 5> lengths = {Bytes{0x7F, 0xFF, 0xFF, 0xFF},
                                        Bytes{0xFF, 0xFF, 0xFF, 0xFF}, Bytes{0x80, 0, 0, 0},
                                        Bytes{0x04, 0, 0, 1}, Bytes{0, 0, 0x01, 0x90}};
  for (const std::size_t field : {20u, 24u}) {
    for (const Bytes& length : lengths) {
      Bytes content = whole;
      std::copy(length.begin(), length.end(),
                content.begin() + static_cast<long>(starts[4] + field));
      const Reading reading = ReadAll(Save("bogus.lcm", content));
      ASSERT_EQ(reading.events.size(), 9u) << field << " " << int{length[0]};
      EXPECT_EQ(reading.events[3].number, 3);
      EXPECT_EQ(reading.events[4].number, 5);
      EXPECT_EQ(reading.damaged, 1);
    }
  }
}

TEST_F(EventLog, JunkInFrontBetweenAndBehindIsCounted) {
  const auto starts = WriteTen(Path("a.lcm"));
  const Bytes whole = Load(Path("a.lcm"));
  const Bytes junk = Payload(1000, 3);
  Bytes content = junk;
  content.insert(content.end(), whole.begin(), whole.begin() + static_cast<long>(starts[5]));
  content.insert(content.end(), junk.begin(), junk.end());
  content.insert(content.end(), whole.begin() + static_cast<long>(starts[5]), whole.end());
  content.insert(content.end(), junk.begin(), junk.end());
  const Reading reading = ReadAll(Save("junk.lcm", content));
  EXPECT_EQ(reading.events.size(), 10u);
  EXPECT_EQ(reading.damaged, 3);
}

TEST_F(EventLog, WhatCannotBeReadSaysWhy) {
  EXPECT_THAT(ReadAll(Path("missing.lcm")).error, testing::HasSubstr("No such file"));
  EXPECT_THAT(ReadAll(folder_.string()).error, testing::HasSubstr("is not a file"));
  EXPECT_THAT(ReadAll(Save("empty.lcm", {})).error, testing::HasSubstr("holds no LCM event"));
  EXPECT_THAT(ReadAll(Save("junk.lcm", Payload(5000, 1))).error,
              testing::HasSubstr("holds no LCM event"));
}

TEST_F(EventLog, WhatCannotBeWrittenSaysWhy) {
  std::string error;
  EXPECT_FALSE(LogWriter::Create(Path("no/such/folder.lcm"), error));
  EXPECT_THAT(error, testing::HasSubstr("No such file"));
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "SKIPPED: no /dev/full here";
  auto writer = LogWriter::Create("/dev/full", error);
  ASSERT_TRUE(writer);
  for (int i = 0; i < 100; ++i) writer->Write(FromMicros(i), "X", Payload(1000, 0));
  EXPECT_FALSE(writer->Close(error));
  EXPECT_THAT(error, testing::HasSubstr("No space left"));
}

// Recordings of other projects, as they are and with damage: bounded work, no crash, and the parts
// that are whole come out.
TEST_F(EventLog, ForeignRecordingsReadWholeAndDamaged) {
  const struct {
    const char* name;
    std::size_t events;
  } logs[] = {
      {"gokart_vlp16_ray_rimo.lcm", 161}, {"gokart_vlp16_pos.lcm", 11}, {"lcmlog-test.00", 1}};
  for (const auto& log : logs) {
    if (!fs::exists(DataFile(log.name))) {
      GTEST_SKIP() << "SKIPPED: no recordings under V2VOUCH_DATA";
    }
    const Reading whole = ReadAll(DataFile(log.name).string());
    EXPECT_EQ(whole.events.size(), log.events) << log.name;
    EXPECT_EQ(whole.damaged, 0) << log.name;

    const Bytes content = Load(DataFile(log.name));
    std::mt19937_64 rng(20240611);
    for (int trial = 0; trial < 60; ++trial) {
      Bytes damaged = content;
      for (int flips = 0; flips < 8; ++flips) {
        std::uint8_t& byte = damaged[rng() % damaged.size()];
        byte = static_cast<std::uint8_t>(byte ^ (1u << (rng() % 8)));
      }
      damaged.erase(damaged.end() - static_cast<long>(rng() % (damaged.size() / 3)), damaged.end());
      const Reading reading = ReadAll(Save("damaged.lcm", damaged));
      EXPECT_LE(reading.events.size(), log.events);
      EXPECT_GE(reading.events.size() + 11, log.events * 2 / 3);
    }
  }
}

}  // namespace
}  // namespace v2vouch
