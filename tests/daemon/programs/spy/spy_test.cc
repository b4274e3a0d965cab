// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "daemon/programs/spy/channel_table.h"
#include "daemon/programs/spy/field_tree.h"
#include "daemon/programs/spy/plain_words.h"
#include "daemon/programs/spy/printable.h"
#include "daemon/programs/spy/spy_report.h"
#include "daemon/rim/wire/codec.h"
#include "v2vouch/daemon_status_t.hpp"
#include "v2vouch/ego_motion_t.hpp"
#include "v2vouch/object_list_t.hpp"
#include "v2vouch/track_list_t.hpp"

namespace v2vouch::spy {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::StartsWith;

constexpr std::int64_t kStart_us = 1'700'000'000'000'000;

template <class T>
std::vector<std::uint8_t> Encoded(const T& message) {
  std::vector<std::uint8_t> bytes;
  wire::Encode(message, bytes);
  return bytes;
}

std::vector<std::uint8_t> Ego(std::int64_t seq) {
  ego_motion_t ego{};
  ego.utime = kStart_us + 20'000 * seq;
  ego.seq = seq;
  ego.speed_mps = 12.5;
  return Encoded(ego);
}

// 50 Hz for `seconds`, the message number `lost` missing.
ChannelTable EgoTable(double seconds, int lost) {
  ChannelTable table;
  for (int i = 0; i < static_cast<int>(50.0 * seconds); ++i) {
    if (i != lost) table.Take("EGO_MOTION", Ego(i), kStart_us + 20'000 * i);
  }
  return table;
}

TEST(ChannelTable, RateJitterAndLossesOfASteadyChannel) {
  const ChannelTable table = EgoTable(10.0, 123);
  const ChannelRow& row = *table.Find("EGO_MOTION");
  EXPECT_EQ(row.type->name, "ego_motion_t");
  EXPECT_EQ(row.messages, 499);
  EXPECT_EQ(row.gaps, 1);
  EXPECT_EQ(row.repeats, 0);
  EXPECT_NEAR(row.Rate(kStart_us + 10'000'000), 50.0, 1e-9);
  EXPECT_NEAR(row.MeanRate(), 49.9, 0.01);
  EXPECT_LT(row.Jitter(), 0.002);
  EXPECT_EQ(row.stamp_us, kStart_us + 20'000 * 499);
  // A channel that has stopped has no rate.
  EXPECT_EQ(row.Rate(kStart_us + 20'000'000), 0.0);
}

TEST(ChannelTable, BrokenMessagesAreCountedByReasonAndTheRestGoesOn) {
  ChannelTable table;
  auto broken = Ego(1);
  broken.pop_back();
  table.Take("EGO_MOTION", broken, kStart_us);
  table.Take("EGO_MOTION", std::vector<std::uint8_t>{1, 2, 3}, kStart_us + 1);
  table.Take("EGO_MOTION", std::vector<std::uint8_t>(40, 7), kStart_us + 2);  // Another's type.
  table.Take("EGO_MOTION", Ego(5), kStart_us + 3);
  const ChannelRow& row = *table.Find("EGO_MOTION");
  EXPECT_EQ(row.refused.at("broken ego_motion_t"), 1);
  EXPECT_EQ(row.refused.at("shorter than a fingerprint"), 1);
  EXPECT_EQ(row.messages, 4);
  EXPECT_EQ(row.gaps, 0);
}

TEST(ChannelTable, MemoryIsBoundedWhateverComes) {
  ChannelTable table;
  for (int i = 0; i < 5000; ++i) {
    table.Take("C" + std::to_string(i), std::vector<std::uint8_t>(9, 1), i);
  }
  table.Take("C0", std::vector<std::uint8_t>(kMostKept + 1, 1), 6000);
  EXPECT_EQ(table.rows().size(), kMostChannels + 1);
  EXPECT_EQ(table.Find(kOtherChannels)->messages, 5000 - static_cast<int>(kMostChannels));
  EXPECT_TRUE(table.Find("C0")->newest.empty());
  // Times and counters of any value.
  std::mt19937_64 rng(20261130);
  for (int i = 0; i < 2000; ++i) {
    auto bytes = Ego(static_cast<std::int64_t>(rng()));
    bytes[rng() % bytes.size()] = static_cast<std::uint8_t>(rng());
    table.Take("C1", bytes, static_cast<std::int64_t>(rng()));
  }
  EXPECT_FALSE(TableLines({.table = &table}).empty());
}

TEST(FieldTree, FieldsHaveValuesUnitsAndNestedTypes) {
  object_list_t list{};
  list.sensor = "lidar\x1b[2J";
  list.num_objects = 20;
  list.objects.resize(20);
  list.objects[0].x_m = 12.5;
  const auto lines = FieldTree(Encoded(list), 16);
  EXPECT_EQ(lines.front(), "v2vouch.object_list_t");
  EXPECT_THAT(lines, Contains(StartsWith("      x_m                     12.5 m")));
  EXPECT_THAT(lines, Contains(HasSubstr("\"lidar?[2J\"")));  // No escape reaches the terminal.
  EXPECT_THAT(lines, Contains(HasSubstr("... 4 more")));
  EXPECT_THAT(lines, testing::Not(Contains(HasSubstr("[16]"))));
}

TEST(FieldTree, OtherPeoplesTypesShowSizeAndFirstBytes) {
  const auto lines = FieldTree(std::vector<std::uint8_t>(20, 0xAB));
  EXPECT_EQ(lines[0], "a type that is none of ours");
  EXPECT_THAT(lines[1], StartsWith("20 bytes: ab ab"));
}

TEST(PlainWords, ListIsATableWithTheNearestFirst) {
  track_list_t list{};
  list.utime = kStart_us;
  list.num_tracks = 2;
  list.tracks.resize(2);
  list.tracks[0].x_body_m = 80.0;
  list.tracks[1].x_body_m = 12.0;
  list.tracks[1].object_class = track_t::CLASS_TRUCK;
  list.tracks[1].visibility = track_t::HIDDEN;
  list.tracks[1].trust_state = track_t::TRUST_BRIDGED;
  list.tracks[1].bridge_budget_s = 3.2;
  list.tracks[0].bridge_budget_s = std::nan("");
  const auto lines = TrackTable(Encoded(list));
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_EQ(lines[0], "2 vehicles");
  EXPECT_THAT(lines[2], testing::AllOf(HasSubstr("truck"), HasSubstr("hidden"),
                                       HasSubstr("bridged"), HasSubstr("3.2 s")));
  EXPECT_THAT(lines[3], HasSubstr("80.0"));
}

TEST(PlainWords, StatusSaysWhatIsWrongFirst) {
  daemon_status_t status{};
  EXPECT_EQ(StatusWords(Encoded(status)).front(), "All is well.");
  status.num_inputs = 2;
  status.inputs.resize(2);
  status.inputs[0] = {.channel = "RADAR_FRONT",
                      .received = 10,
                      .accepted = 10,
                      .gaps = 0,
                      .rate_hz = 20.0,
                      .age_s = 0.01,
                      .is_silent = 0};
  status.inputs[1] = {.channel = "BSM",
                      .received = 5,
                      .accepted = 5,
                      .gaps = 0,
                      .rate_hz = 0.0,
                      .age_s = 4.5,
                      .is_silent = 1};
  status.kernel_drops = 7;
  const auto lines = StatusWords(Encoded(status));
  EXPECT_EQ(lines[0], "! BSM is silent: its newest message is 4.5 s old.");
  EXPECT_THAT(lines[1], StartsWith("! The kernel has dropped 7 datagrams"));
  EXPECT_THAT(lines, Contains("RADAR_FRONT: 20.0 per second, newest 10 ms old."));
  EXPECT_THAT(lines, testing::Not(Contains("All is well.")));
}

TEST(SpyReport, JsonHoldsTheFiguresOfTheTable) {
  const ChannelTable table = EgoTable(4.0, -1);
  Moment moment{.table = &table};
  moment.now_us = kStart_us + 4'000'000;
  moment.packets[static_cast<std::size_t>(lcm_packets::PacketFault::kMagic)] = 3;
  const auto json = nlohmann::json::parse(JsonOf(moment));
  EXPECT_EQ(json["channels"][0]["channel"], "EGO_MOTION");
  EXPECT_EQ(json["channels"][0]["rate_hz"], 50.0);
  EXPECT_EQ(json["datagrams_refused"].size(), 1U);
  EXPECT_THAT(RefusalLines(moment), Contains(StartsWith("3 datagrams: ")));
}

TEST(Printable, NothingThatSteersATerminalIsLeft) {
  EXPECT_EQ(Printable("a\x1b]0;x\x07\xC3\xA4 b"), "a?]0;x??? b");
  EXPECT_EQ(Printable(std::string(300, 'x'), 5), "xxxxx...");
}

}  // namespace
}  // namespace v2vouch::spy
