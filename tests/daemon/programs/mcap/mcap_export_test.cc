// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "daemon/programs/mcap/convert.h"
#include "daemon/programs/mcap/view_messages.h"
#include "daemon/rim/foxglove/messages.h"
#include "daemon/rim/io/event_log.h"
#include "daemon/rim/wire/codec.h"
#include "v2vouch/camera_image_t.hpp"
#include "v2vouch/gnss_fix_t.hpp"
#include "v2vouch/track_list_t.hpp"

namespace v2vouch::mcap_export {
namespace {

bool GoOn(double) { return true; }

std::string Content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream content;
  content << file.rdbuf();
  return content.str();
}

std::vector<std::uint8_t> ListBytes(int tracks) {
  track_list_t list{};
  list.utime = 1'700'000'000'000'000;
  list.ego_x_odom_m = 7.0;
  list.num_tracks = tracks;
  list.tracks.resize(static_cast<std::size_t>(tracks));
  for (track_t& track : list.tracks) {
    track.x_odom_m = 12.0;
    track.length_m = 4.5;
    track.visibility = track_t::HIDDEN;
    track.bridge_budget_s = 2.5;
  }
  std::vector<std::uint8_t> bytes;
  wire::Encode(list, bytes);
  return bytes;
}

class McapExport : public testing::Test {
 protected:
  void SetUp() override {
    // One folder per test: they may run at the same time.
    folder_ = testing::TempDir() + testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string Path(const std::string& name) const { return folder_ + "/" + name; }

  void WriteLog(const std::vector<LogEvent>& events) {
    std::string error;
    const auto writer = LogWriter::Create(Path("a.lcm"), error);
    ASSERT_TRUE(writer) << error;
    for (const LogEvent& event : events) writer->Write(event);
    ASSERT_TRUE(writer->Close(error)) << error;
  }
  // Through raw MCAP and back.
  std::string RoundTrip(mcap::Compression compression) {
    ConvertResult result;
    std::string error;
    EXPECT_TRUE(
        LogToMcap(Path("a.lcm"), Path("a.mcap"), {Flavour::kRaw, compression}, GoOn, result, error))
        << error;
    EXPECT_TRUE(IsMcap(Path("a.mcap")));
    result = {};
    EXPECT_TRUE(McapToLog(Path("a.mcap"), Path("b.lcm"), GoOn, result, error)) << error;
    EXPECT_EQ(result.fault, "");
    return Content(Path("b.lcm"));
  }

  std::string folder_;
};

TEST_F(McapExport, RawFlavourComesBackByteForByteWhateverTheEventsSay) {
  constexpr std::int64_t kLast = std::numeric_limits<std::int64_t>::max();
  constexpr std::int64_t kFirst = std::numeric_limits<std::int64_t>::min();
  std::vector<LogEvent> events;
  // Other people's types, bytes that are none, gaps, repeats and wraps of the number, times that
  // MCAP cannot hold, a channel that is no UTF-8, times that go back.
  events.push_back({0, FromMicros(1'700'000'000'000'000), "TRACKS_LOCAL", ListBytes(3)});
  events.push_back({1, FromMicros(1'700'000'000'000'001), "OTHER", {1, 2, 3, 4, 5, 6, 7, 8, 9}});
  events.push_back({7, FromMicros(1'600'000'000'000'000), "OTHER", {1}});
  events.push_back({7, FromMicros(0), "TRACKS_LOCAL", {0, 1}});
  events.push_back({3, FromMicros(-5), "OTHER", ListBytes(1)});
  events.push_back({kLast, FromMicros(kLast), "BAD\xFF\x01", {9}});
  events.push_back({kFirst, FromMicros(kFirst), "BAD\xFF\x01", {}});
  events.push_back({5'000'000'000, FromMicros(1), "X", {}});
  events.push_back({5'000'000'001, FromMicros(2), std::string(63, 'y'), {}});
  for (int i = 0; i < 6000; ++i) {  // More channels than get one of their own.
    events.push_back({5'000'000'002 + i, FromMicros(3), "C" + std::to_string(i), {1}});
  }
  WriteLog(events);
  const std::string original = Content(Path("a.lcm"));
  EXPECT_EQ(RoundTrip(mcap::Compression::kZstd), original);
  EXPECT_EQ(RoundTrip(mcap::Compression::kNone), original);
}

TEST_F(McapExport, LogsThatACrashLeftAreTakenUpToTheTear) {
  std::vector<LogEvent> events;
  for (int i = 0; i < 400; ++i) {
    events.push_back({i, FromMicros(1'700'000'000'000'000 + i), "TRACKS_LOCAL", ListBytes(i % 5)});
  }
  WriteLog(events);
  const std::string whole = Content(Path("a.lcm"));
  std::filesystem::resize_file(Path("a.lcm"), whole.size() - 10);
  const std::string back = RoundTrip(mcap::Compression::kZstd);
  EXPECT_EQ(back, whole.substr(0, back.size()));
  EXPECT_EQ(back.size() + 28 + 12 + ListBytes(399 % 5).size(), whole.size());

  // The MCAP file itself torn: what is in it comes back, and the tear is told.
  ConvertResult result;
  std::string error;
  std::filesystem::resize_file(Path("a.mcap"), std::filesystem::file_size(Path("a.mcap")) / 2);
  ASSERT_TRUE(McapToLog(Path("a.mcap"), Path("b.lcm"), GoOn, result, error)) << error;
  EXPECT_EQ(result.fault, "the file ends within a record");
  const std::string part = Content(Path("b.lcm"));
  EXPECT_EQ(part, whole.substr(0, part.size()));
  EXPECT_GT(result.messages, 50);
}

TEST_F(McapExport, ViewFlavourHoldsListsAndScenesAndTellsWhatItLeavesOut) {
  WriteLog({{0, FromMicros(1'700'000'000'000'000), "TRACKS_LOCAL", ListBytes(3)},
            {1, FromMicros(1'700'000'000'000'001), "OTHER", {1, 2, 3}}});
  ConvertResult result;
  std::string error;
  ASSERT_TRUE(LogToMcap(Path("a.lcm"), Path("a.mcap"), {}, GoOn, result, error)) << error;
  EXPECT_EQ(result.messages, 4);  // List, scene, transform, arrays for plots.
  EXPECT_EQ(result.left_out, 1);
  EXPECT_FALSE(McapToLog(Path("a.mcap"), Path("b.lcm"), GoOn, result, error));
  EXPECT_NE(error.find("--raw"), std::string::npos);
}

TEST_F(McapExport, InputIsNeverOverwritten) {
  WriteLog({{0, FromMicros(1), "A", {1}}});
  ConvertResult result;
  std::string error;
  EXPECT_FALSE(LogToMcap(Path("a.lcm"), Path("a.lcm"), {}, GoOn, result, error));
  EXPECT_FALSE(LogToMcap(Path("none.lcm"), Path("a.mcap"), {}, GoOn, result, error));
}

std::vector<ViewMessage> MessagesOf(const std::string& channel,
                                    const std::vector<std::uint8_t>& bytes) {
  return ViewMessages().Of(channel, bytes, FromMicros(1));
}

const ViewMessage& On(const std::vector<ViewMessage>& messages, const std::string& topic) {
  const auto found = std::ranges::find(messages, topic, &ViewMessage::topic);
  if (found == messages.end()) throw std::runtime_error("no message on " + topic);
  return *found;
}

TEST(ViewMessages, HiddenTrackIsABoxThatSaysSo) {
  const auto messages = MessagesOf("TRACKS_PRIORITY", ListBytes(1));
  const auto scene = nlohmann::json::parse(On(messages, "/v2vouch/priority").json);
  const auto entity = scene["entities"][0];
  EXPECT_EQ(entity["frame_id"], "odom");
  EXPECT_EQ(entity["cubes"][0]["pose"]["position"]["x"], 12.0);
  EXPECT_EQ(entity["cubes"][0]["size"]["x"], 4.5);
  EXPECT_EQ(entity["texts"][0]["text"], "0 hidden, 2 s left");
  EXPECT_EQ(entity["timestamp"]["sec"], 1'700'000'000);
}

TEST(ViewMessages, ListsAreArraysOfNumbersForPlots) {
  const auto messages = MessagesOf("TRACKS_PRIORITY", ListBytes(3));
  const auto plot = nlohmann::json::parse(On(messages, "/v2vouch/plot/priority").json);
  EXPECT_EQ(plot["count"], 3);
  EXPECT_EQ(plot["budget_s"].dump(), "[2.5,2.5,2.5]");
  EXPECT_EQ(plot["own_age_s"][0], nullptr);  // Of no sensor.
}

TEST(ViewMessages, LatitudeIsInDegreesAndPicturesAreBase64) {
  gnss_fix_t fix{};
  fix.latitude_rad = 0.5;
  std::vector<std::uint8_t> bytes;
  wire::Encode(fix, bytes);
  auto messages = MessagesOf("EGO_GNSS", bytes);
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_NEAR(nlohmann::json::parse(messages[0].json)["latitude"].get<double>(), 28.6479, 1e-4);

  camera_image_t image{};
  image.encoding = "jpeg";
  image.sensor = "\xff";  // No text: the channel names the topic.
  image.num_bytes = 3;
  image.data = {'M', 'a', 'n'};
  wire::Encode(image, bytes);
  messages = MessagesOf("CAMERA_FRONT_IMAGE", bytes);
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(messages[0].topic, "/camera/CAMERA_FRONT_IMAGE");
  EXPECT_EQ(messages[0].schema, "foxglove.CompressedImage");
  EXPECT_EQ(nlohmann::json::parse(messages[0].json)["data"], "TWFu");
}

TEST(ViewMessages, WhatHappenedIsALog) {
  ViewMessages messages;
  messages.Of("TRACKS_PRIORITY", ListBytes(0), FromMicros(1));
  const auto lines = messages.Of("TRACKS_PRIORITY", ListBytes(1), FromMicros(5'000'000));
  const auto line = nlohmann::json::parse(On(lines, "/v2vouch/log").json);
  EXPECT_EQ(line["name"], "validated");
  EXPECT_EQ(line["timestamp"]["sec"], 5);
}

TEST(ViewMessages, EverySchemaIsJsonWithTheFieldsThatAreFilled) {
  for (const auto& message : MessagesOf("TRACKS_LOCAL", ListBytes(2))) {
    const auto schema = nlohmann::json::parse(foxglove::Schema(message.schema));
    EXPECT_EQ(schema["title"], message.schema);
    const auto fields = nlohmann::json::parse(message.json);
    for (auto field = fields.begin(); field != fields.end(); ++field) {
      EXPECT_TRUE(schema["properties"].contains(field.key())) << field.key();
    }
  }
}

}  // namespace
}  // namespace v2vouch::mcap_export
