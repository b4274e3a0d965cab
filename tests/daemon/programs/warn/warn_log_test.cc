// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/warn/warn_log.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <memory>

#include "daemon/rim/io/event_log.h"
#include "daemon/rim/warnings_wire/warnings_conversion.h"
#include "daemon/rim/wire/codec.h"

namespace v2vouch {
namespace {

constexpr std::int64_t kStart = 1'781'510'400'000'000;

track_t CarAt(double x) {
  track_t track{};
  track.id = 5;
  track.is_confirmed = 1;
  track.x_odom_m = x;
  track.length_m = 4.0;
  track.width_m = 1.7;
  track.existence = 0.99;
  for (int i = 0; i < 6; ++i) track.covariance_odom[7 * i] = 0.01;
  track.bridge_budget_s = std::numeric_limits<double>::quiet_NaN();
  return track;
}

// The ego drives at 15 m/s towards a standing car; lists at 20 Hz.
class LogOnDisk {
 public:
  explicit LogOnDisk(const std::string& name)
      : path(std::filesystem::temp_directory_path() /
             (name + "_" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()) +
              ".lcm")) {}
  ~LogOnDisk() { std::filesystem::remove(path); }
  std::string path;
};

void WriteDrive(const std::string& path) {
  std::string error;
  const auto writer = LogWriter::Create(path, error);
  ASSERT_TRUE(writer) << error;
  std::vector<std::uint8_t> bytes;
  for (int i = 0; i < 100; ++i) {
    const std::int64_t utime = kStart + 50'000 * i;
    const Timestamp at = FromMicros(utime);
    ego_motion_t motion{};
    motion.utime = utime;
    motion.speed_mps = 15.0;
    wire::Encode(motion, bytes);
    writer->Write(at, "EGO_MOTION", bytes);
    track_list_t list{};
    list.utime = utime;
    list.seq = i;
    list.ego_x_odom_m = 0.75 * i;
    list.sectors.push_back({-1.0, 1.0, 100.0, 0});
    list.num_sectors = 1;
    list.tracks.push_back(CarAt(80.0));
    list.tracks[0].sources.push_back({0, "front", utime});
    list.tracks[0].num_sources = 1;
    list.tracks.push_back(CarAt(std::numeric_limits<double>::quiet_NaN()));
    list.num_tracks = 2;
    wire::Encode(list, bytes);
    writer->Write(at, "TRACKS_LOCAL", bytes);
    list.tracks.clear();
    list.num_tracks = 0;
    wire::Encode(list, bytes);
    writer->Write(at, "TRACKS_PRIORITY", bytes);
  }
  ASSERT_TRUE(writer->Close(error)) << error;
}

std::vector<std::uint8_t> BytesOf(const std::string& path) {
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                       &std::fclose);
  std::vector<std::uint8_t> bytes(std::filesystem::file_size(path));
  EXPECT_EQ(std::fread(bytes.data(), 1, bytes.size(), file.get()), bytes.size());
  return bytes;
}

const auto kGoOn = [](double) { return true; };

TEST(WarnOverLog, WarnsOfTheStandingCarAndWritesTheSameBytesTwice) {
  const LogOnDisk in("warn_in");
  const LogOnDisk once("warn_once");
  const LogOnDisk again("warn_again");
  WriteDrive(in.path);
  WarnResult result;
  std::string error;
  ASSERT_TRUE(WarnOverLog(in.path, once.path, {}, kGoOn, result, error)) << error;
  EXPECT_EQ(result.lists, 100);
  EXPECT_EQ(result.refused, 0);
  ASSERT_EQ(result.episodes.size(), 1u);
  EXPECT_EQ(result.episodes[0].worst.level, warnings::Level::kUrgent);
  EXPECT_EQ(result.episodes[0].worst.local_id, 5);
  const std::string text = WarnText(result);
  EXPECT_NE(text.find("URGENT"), std::string::npos);
  // Since the log's beginning, as v2vouch-log and the viewer count; nothing unknown is a number.
  EXPECT_NE(text.find("\nat   "), std::string::npos) << text;
  EXPECT_NE(text.find("budget none"), std::string::npos) << text;
  EXPECT_EQ(text.find("nan"), std::string::npos) << text;
  EXPECT_NE(WarnJson(result).find("\"level\":\"URGENT\""), std::string::npos);
  // Over its own output: recorded warnings are dropped, the rest gives the same file.
  WarnResult second;
  ASSERT_TRUE(WarnOverLog(once.path, again.path, {}, kGoOn, second, error)) << error;
  EXPECT_EQ(second.old_outputs, 100);
  EXPECT_EQ(BytesOf(once.path), BytesOf(again.path));
}

TEST(WarnOverLog, SaysWhatIsWrongWithALog) {
  WarnResult result;
  std::string error;
  EXPECT_FALSE(WarnOverLog("/nonexistent/log.lcm", "", {}, kGoOn, result, error));
  EXPECT_FALSE(error.empty());
}

TEST(WarnFeed, DamagedMessagesAreCountedAndHarmless) {
  wire::WarnFeed feed({}, {}, {});
  const std::vector<std::uint8_t> damaged(40, 0xff);
  for (const char* channel : {"TRACKS_LOCAL", "TRACKS_PRIORITY", "EGO_MOTION", "EGO_INTENT"}) {
    EXPECT_FALSE(feed.Take(channel, damaged));
  }
  EXPECT_EQ(feed.refused(), 4);
  EXPECT_FALSE(feed.Take("RADAR_FRONT", damaged));
  EXPECT_EQ(feed.refused(), 4);
}

TEST(WarningsConversion, ListsThatTellOfNothingThatCanBeAreEmpty) {
  track_list_t list{};
  list.utime = kStart;
  list.tracks = {CarAt(10.0), CarAt(20.0), CarAt(30.0)};
  list.tracks[0].is_confirmed = 0;
  list.tracks[1].covariance_odom[8] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(wire::ToTargets(list, wire::ListOrigin::kLocal).targets.size(), 1u);
  // V2V alone, for comparison, is believed whatever its state.
  EXPECT_EQ(wire::ToTargets(list, wire::ListOrigin::kUnverified).targets.size(), 2u);
}

TEST(WarningsConversion, MasksOfKindsAddUp) {
  warnings::WarningList list;
  list.available_kinds = warnings::Bit(warnings::Kind::kFcw);
  const warning_list_t message = wire::ToMessage(list);
  EXPECT_EQ(message.available_kinds | message.unavailable_kinds, warnings::kAllKinds);
  EXPECT_EQ(message.available_kinds & message.unavailable_kinds, 0);
}

TEST(WarnFile, PrintsWhatItReads) {
  const std::string printed = PrintWarnFile({});
  for (const char* key : {"vehicle:", "channels:", "warnings:", "urgent_probability"}) {
    EXPECT_NE(printed.find(key), std::string::npos) << key;
  }
}

}  // namespace
}  // namespace v2vouch
