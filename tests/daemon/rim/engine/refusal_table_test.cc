// SPDX-License-Identifier: Apache-2.0
// Every refusal names channel and field, and the table of them is bounded.
#include "daemon/rim/engine/refusal_table.h"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "daemon/rim/engine/engine.h"
#include "daemon/rim/wire/codec.h"
#include "tests/support/synthetic_drive.h"
#include "tests/support/wire_drive.h"
#include "v2vouch/bsm_t.hpp"
#include "v2vouch/daemon_status_t.hpp"
#include "v2vouch/ego_motion_t.hpp"
#include "v2vouch/gnss_fix_t.hpp"
#include "v2vouch/radar_scan_t.hpp"

namespace v2vouch {
namespace {

using testing::WireMessage;

TEST(RefusalTable, CountsByChannelReasonAndField) {
  RefusalTable table;
  table.Add("A", {Reason::kOutOfRange, "speed_mps"});
  table.Add("B", {Reason::kOutOfRange, "speed_mps"}, 3);
  table.Add("A", {Reason::kOutOfRange, "speed_mps"});
  table.Add("A", {Reason::kNotFinite, "speed_mps"});
  ASSERT_EQ(table.rows().size(), 3u);
  EXPECT_EQ(table.rows()[0].count, 2u);
  EXPECT_EQ(table.rows()[1].channel, "B");
  EXPECT_EQ(table.rows()[1].count, 3u);
}

TEST(RefusalTable, StaysBoundedWhateverComes) {
  RefusalTable table;
  std::uint64_t added = 0;
  for (int i = 0; i < 5000; ++i) {
    table.Add("channel" + std::to_string(i), {Reason::kOutOfRange, "speed_mps"});
    table.Add("unknown" + std::to_string(i), Reason::kUnknownChannel);
    added += 2;
  }
  EXPECT_LE(table.rows().size(), RefusalTable::kMostRows + kReasonCount);
  std::uint64_t sum = 0;
  std::uint64_t named = 0;
  for (const RefusalTable::Row& row : table.rows()) {
    sum += row.count;
    named += row.refusal.reason == Reason::kUnknownChannel ? 1 : 0;
  }
  EXPECT_EQ(sum, added);
  EXPECT_EQ(named, RefusalTable::kMostUnknownChannels + 1);  // And the others together.
}

TEST(RefusalTable, NamesInAFieldAreToldApartUpToABound) {
  RefusalTable table;
  const Refusal refusal{Reason::kFieldUnused, "boxes.class_name"};
  for (int i = 0; i < 100; ++i) table.Add("CAMERA_FRONT", refusal, 2, "n" + std::to_string(i));
  ASSERT_EQ(table.rows().size(), RefusalTable::kMostNames + 1);
  EXPECT_EQ(table.rows()[0].FieldText(), "boxes.class_name 'n0'");
  EXPECT_EQ(table.rows().back().FieldText(), "boxes.class_name '(others)'");
  EXPECT_EQ(table.rows().back().count, 2 * (100 - RefusalTable::kMostNames));
}

std::vector<WireMessage> Messages() {
  testing::SyntheticDrive drive;
  drive.duration_s = 2.0;
  drive.cars.push_back({.x_m = 30.0, .y_m = 0.0, .speed_mps = 9.0, .sender = 0x11});
  return testing::EncodeInputs(testing::MakeInputs(drive), VehicleConfig{});
}

template <class T, class Change>
void Edit(WireMessage& message, Change change) {
  auto decoded = wire::Decode<T>(message.bytes);
  ASSERT_TRUE(decoded);
  change(*decoded);
  wire::Encode(*decoded, message.bytes);
}

// "channel reason field" -> count, from the last status.
std::map<std::string, std::int64_t> DetailsOf(const std::vector<WireMessage>& messages) {
  Engine engine(DaemonConfig{});
  Outbox outbox;
  for (const WireMessage& message : messages) {
    engine.OnMessage(message.channel, message.bytes, message.received, outbox);
    outbox.Clear();
  }
  engine.PublishStatus(outbox);
  const auto status = wire::Decode<daemon_status_t>(outbox.messages()[0].bytes);
  EXPECT_TRUE(status);
  std::map<std::string, std::int64_t> details;
  std::int64_t sum = 0;
  for (const refusal_t& detail : status->refusal_details) {
    details[detail.channel + " " + detail.reason + " " + detail.field] = detail.count;
    sum += detail.count;
  }
  std::int64_t total = 0;
  for (const count_t& refusal : status->refusals) total += refusal.count;
  EXPECT_EQ(sum, total);
  return details;
}

TEST(EngineRefusals, AGoodDriveHasNone) { EXPECT_TRUE(DetailsOf(Messages()).empty()); }

TEST(EngineRefusals, EveryRefusalNamesChannelAndField) {
  std::vector<WireMessage> messages = Messages();
  int egos = 0;
  for (WireMessage& message : messages) {
    if (message.channel == "EGO_MOTION") {
      const int index = egos++;
      Edit<ego_motion_t>(message, [&](ego_motion_t& m) {
        if (index % 10 == 3) m.speed_mps = kNaN;
        if (index % 10 == 7) m.gear = 9;
      });
    } else if (message.channel == "EGO_GNSS") {
      Edit<gnss_fix_t>(message, [](gnss_fix_t& m) {
        m.latitude_rad *= 57.29577951308232;
        m.longitude_rad *= 57.29577951308232;
      });
    } else if (message.channel.starts_with("RADAR_")) {
      Edit<radar_scan_t>(message, [](radar_scan_t& m) {
        if (!m.detections.empty()) m.detections[0].range_m = -1.0;
      });
    } else if (message.channel == "BSM") {
      Edit<bsm_t>(message, [](bsm_t& m) { m.rx_utime /= 1000; });
    }
  }
  messages.push_back({"RADAR_FRUNT", {1, 2, 3}, messages.back().received});
  messages.push_back({"EGO_MOTION", {1, 2, 3}, messages.back().received});
  const auto details = DetailsOf(messages);
  EXPECT_GT(details.count("EGO_MOTION not_finite speed_mps"), 0u);
  EXPECT_GT(details.count("EGO_MOTION field_unused gear"), 0u);
  EXPECT_GT(details.count("EGO_GNSS out_of_range latitude_rad looks like degrees"), 0u);
  EXPECT_GT(details.count("RADAR_FRONT out_of_range detections.range_m"), 0u);
  EXPECT_GT(details.count("BSM out_of_range rx_utime looks like milliseconds"), 0u);
  EXPECT_EQ(details.count("RADAR_FRUNT unknown_channel "), 1u);
  EXPECT_EQ(details.count("EGO_MOTION too_short "), 1u);
}

TEST(EngineRefusals, WhatTheCoreRefusesNamesChannelAndFieldToo) {
  std::vector<WireMessage> messages = Messages();
  std::vector<WireMessage> again;
  for (const WireMessage& message : messages) {
    again.push_back(message);
    // Twice the same, which a network may do.
    if (message.channel == "EGO_MOTION" || message.channel == "BSM") again.push_back(message);
  }
  for (const auto& [key, count] : DetailsOf(again)) {
    const bool is_duplicate = key == "EGO_MOTION duplicate seq";
    const bool is_repeat = key == "BSM bsm_repeat msgCnt";
    EXPECT_TRUE(is_duplicate || is_repeat) << key;
  }
  std::vector<WireMessage> without_gnss;
  for (const WireMessage& message : messages) {
    if (message.channel != "EGO_GNSS") without_gnss.push_back(message);
  }
  const auto details = DetailsOf(without_gnss);
  EXPECT_EQ(details.size(), 1u);
  EXPECT_EQ(details.begin()->first, "BSM no_gnss lat and long_ without EGO_GNSS");
}

}  // namespace
}  // namespace v2vouch
