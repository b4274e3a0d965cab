// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/view/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "daemon/rim/json/json_text.h"
#include "daemon/rim/view/page_frame.h"
#include "daemon/rim/view/stored_config.h"
#include "daemon/rim/wire/codec.h"
#include "tests/daemon/rim/view/view_messages.h"
#include "v2vouch/text_t.hpp"
#include "v2vouch/warning_list_t.hpp"

namespace v2vouch::view {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;

template <class T>
bool Take(Scene& scene, const std::string& channel, const T& message, std::int64_t at = 1'000'000) {
  std::vector<std::uint8_t> bytes;
  wire::Encode(message, bytes);
  return scene.Take(channel, bytes, FromMicros(at));
}

std::vector<std::string> Kinds(const Scene& scene) {
  std::vector<std::string> kinds;
  for (const ViewEvent& event : scene.events().events()) kinds.push_back(event.kind);
  return kinds;
}

TEST(Scene, AFrameHoldsTheListsNumbersInTheOdometryFrame) {
  Scene scene({}, {});
  ASSERT_TRUE(Take(scene, "TRACKS_LOCAL", List(5'000'000, {Track(7, 40.0, -3.5)})));
  const json frame = json::parse(PageFrame(scene));
  EXPECT_EQ(frame["t"], 5'000'000);
  ASSERT_EQ(frame["local"].size(), 1u);
  EXPECT_EQ(frame["local"][0]["id"], "7");
  EXPECT_EQ(frame["local"][0]["x"], 40.0);
  EXPECT_EQ(frame["local"][0]["y"], -3.5);
  EXPECT_TRUE(frame["priority"].empty());
}

TEST(Scene, IdsOf63BitsReachJavaScriptUnrounded) {
  Scene scene({}, {});
  Take(scene, "TRACKS_LOCAL", List(1, {Track(9007199254740993, 0.0, 0.0)}));
  EXPECT_EQ(json::parse(PageFrame(scene))["local"][0]["id"], "9007199254740993");
}

TEST(Scene, OnlyTheNewestListIsKept) {
  Scene scene({}, {});
  Take(scene, "TRACKS_LOCAL", List(1, {Track(1, 0, 0), Track(2, 0, 0)}));
  Take(scene, "TRACKS_LOCAL", List(2, {Track(3, 0, 0)}));
  EXPECT_EQ(json::parse(PageFrame(scene))["local"].size(), 1u);
}

TEST(Scene, HostileBytesAndUnknownChannelsAreRefused) {
  Scene scene({}, {});
  const std::vector<std::uint8_t> bytes(100, 0xFF);
  EXPECT_FALSE(scene.Take("TRACKS_LOCAL", bytes, FromMicros(1)));
  EXPECT_FALSE(scene.Take("SOMETHING", bytes, FromMicros(1)));
  EXPECT_EQ(scene.refused(), 1);
  EXPECT_TRUE(json::accept(PageFrame(scene)));
}

TEST(Scene, FiguresThatAreNotFiniteBecomeNull) {
  Scene scene({}, {});
  track_t track = Track(1, NAN, INFINITY);
  track.bridge_budget_s = NAN;
  Take(scene, "TRACKS_PRIORITY", List(1, {track}));
  const json frame = json::parse(PageFrame(scene));
  EXPECT_TRUE(frame["priority"][0]["x"].is_null());
  EXPECT_TRUE(frame["priority"][0]["budget"].is_null());
}

TEST(Scene, TextsOfOthersAreValidJsonWhateverTheyHold) {
  for (const std::string text :
       {"\xff\xfe", "a\"b\\c\n\x01", "\xc3\xa4", "\xed\xa0\x80", "\xf0\x9f"}) {
    const std::string written = JsonText().Text(text).text();
    EXPECT_TRUE(json::accept(written)) << written;
  }
}

TEST(Scene, ALifeInPriorityIsToldAsEvents) {
  Scene scene({}, {});
  track_t track = Track(5, 30, 0);
  track.local_id = 3;
  Take(scene, "TRACKS_PRIORITY", List(1'000'000, {}), 1'000'000);
  Take(scene, "TRACKS_PRIORITY", List(2'000'000, {track}), 2'000'000);
  track.local_id = 0;
  track.bridge_budget_s = 6.0;
  Take(scene, "TRACKS_PRIORITY", List(3'000'000, {track}), 3'000'000);
  track.local_id = 4;
  Take(scene, "TRACKS_PRIORITY", List(7'300'000, {track}), 7'300'000);
  Take(scene, "TRACKS_PRIORITY", List(8'000'000, {}), 8'000'000);
  EXPECT_THAT(Kinds(scene), ElementsAre("validated", "bridged", "seen_again", "ended"));
  EXPECT_NE(scene.events().events()[2].text.find("4.3 s"), std::string::npos);
  EXPECT_EQ(scene.events().events()[1].at, 3'000'000);
}

TEST(Scene, AVehicleWithoutATrackForAnInstantIsNotToldAsHidden) {
  Scene scene({}, {});
  track_t track = Track(5, 30, 0);
  track.bridge_budget_s = 6.0;
  Take(scene, "TRACKS_PRIORITY", List(1'000'000, {}), 1'000'000);
  for (const auto& [at, local] : std::map<std::int64_t, std::int64_t>{{2'000'000, 3},
                                                                      {2'050'000, 0},
                                                                      {2'100'000, 3},
                                                                      {3'000'000, 0},
                                                                      {3'200'000, 0},
                                                                      {3'350'000, 0}}) {
    track.local_id = local;
    Take(scene, "TRACKS_PRIORITY", List(at, {track}), at);
  }
  EXPECT_THAT(Kinds(scene), ElementsAre("validated", "bridged"));
  EXPECT_EQ(scene.events().events()[1].at, 3'000'000) << "when it began, not when it was sure";
}

TEST(Scene, AVerdictIsToldInPlainWordsWithItsFigures) {
  Scene scene({}, {});
  misbehavior_report_t report{};
  report.sender_id[3] = 9;
  report.check = "residual_drift";
  report.verdict = misbehavior_report_t::ACCUSE;
  report.num_evidence = 1;
  report.evidence = {{"drift_m", 11.5}};
  Take(scene, "MISBEHAVIOR", report);
  EXPECT_THAT(Kinds(scene), ElementsAre("accused"));
  ASSERT_NE(scene.VerdictsOf(9), nullptr);
  const std::string& text = scene.VerdictsOf(9)->back().text;
  EXPECT_NE(text.find("moves away"), std::string::npos) << text;
  EXPECT_NE(text.find("drift_m 11.50"), std::string::npos) << text;
}

warning_list_t Warned(std::int64_t utime, std::int8_t level, std::int64_t track,
                      std::int64_t local) {
  warning_list_t list{};
  list.utime = utime;
  list.num_warnings = 1;
  list.warnings.resize(1);
  warning_t& warning = list.warnings[0];
  warning.kind = warning_t::FCW;
  warning.level = level;
  warning.track_id = track;
  warning.local_id = local;
  warning.time_to_conflict_s = 1.94;
  warning.x_body_m = 20.0;
  warning.y_body_m = 1.0;
  warning.conflict_x_body_m = warning.conflict_y_body_m = NAN;
  return list;
}

TEST(Scene, AWarningIsToldWhenItBeginsAndWhenItGrows) {
  Scene scene({}, {});
  Take(scene, "WARNINGS", Warned(1, warning_t::INFO, 0, 77), 1'000'000);  // A note is no event.
  Take(scene, "WARNINGS", Warned(2, warning_t::ADVISE, 0, 77), 2'000'000);
  Take(scene, "WARNINGS", Warned(3, warning_t::ADVISE, 0, 77), 3'000'000);
  Take(scene, "WARNINGS", Warned(4, warning_t::URGENT, 12345678, 77), 4'000'000);
  Take(scene, "WARNINGS", Warned(5, warning_t::WARN, 0, 77), 5'000'000);  // Weaker again.
  Take(scene, "WARNINGS", warning_list_t{}, 6'000'000);
  Take(scene, "WARNINGS", Warned(7, warning_t::WARN, 9, 0), 7'000'000);
  EXPECT_THAT(Kinds(scene), ElementsAre("warned", "warned", "warned"));
  const auto& events = scene.events().events();
  EXPECT_EQ(events[0].text, "caution: collision ahead with vehicle 77, contact in 1.9 s");
  EXPECT_EQ(events[0].local_id, 77);
  EXPECT_EQ(events[1].at, 4'000'000);
  EXPECT_EQ(events[1].track_id, 12345678);
  EXPECT_THAT(events[1].text, ::testing::StartsWith("urgent: collision ahead with vehicle 45678"));
  EXPECT_THAT(events[2].text, ::testing::EndsWith("hidden, known by V2V"));
}

TEST(Scene, AFrameHoldsTheWarningsWhereTheirVehiclesAre) {
  Scene scene({}, {});
  track_list_t list = List(1'000'000, {Track(77, 120, 1)});
  list.ego_x_odom_m = 100.0;
  Take(scene, "TRACKS_LOCAL", list);
  Take(scene, "WARNINGS", Warned(1'000'000, warning_t::WARN, 0, 77));
  const json warnings = json::parse(PageFrame(scene))["warnings"];
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0]["local"], "77");
  EXPECT_EQ(warnings[0]["x"], 120.0);
  EXPECT_TRUE(warnings[0]["cx"].is_null());
  list.utime = 2'000'000;  // The warnings stopped: nothing old is shown.
  Take(scene, "TRACKS_LOCAL", list);
  EXPECT_TRUE(json::parse(PageFrame(scene))["warnings"].empty());
}

TEST(StoredConfig, TakesWhatItKnowsOfAnotherVersionsText) {
  const StoredConfig config = ReadStoredConfig(
      "vehicle: {width_m: 2.5, new_key: 1}\nlcm: {channels: {tracks_local: L, other: x}}\nnew: "
      "{}\n");
  EXPECT_EQ(config.vehicle.width_m, 2.5);
  EXPECT_EQ(config.channels.tracks_local, "L");
  EXPECT_EQ(ReadStoredConfig("[").channels.tracks_local, "TRACKS_LOCAL");
}

TEST(Scene, MemoryIsBoundedUnderAFloodOfVerdicts) {
  Scene scene({}, {});
  misbehavior_report_t report{};
  report.check = "position_jump";
  report.verdict = misbehavior_report_t::WITHDRAW;
  for (int i = 0; i < 20000; ++i) {
    report.sender_id[1] = static_cast<std::uint8_t>(i >> 16);
    report.sender_id[2] = static_cast<std::uint8_t>(i >> 8);
    report.sender_id[3] = static_cast<std::uint8_t>(i);
    Take(scene, "MISBEHAVIOR", report);
  }
  EXPECT_EQ(scene.events().events().size(), 2000u);
  EXPECT_EQ(scene.events().next_number(), 20000);
}

TEST(Scene, RadarPointsAreDrawnWhereTheMountingSays) {
  VehicleConfig vehicle;
  vehicle.radars.resize(1);
  vehicle.radars[0] = {};
  vehicle.radars[0].name = "REAR";
  vehicle.radars[0].x_m = -1.0;
  vehicle.radars[0].yaw_rad = std::numbers::pi;
  Scene scene(vehicle, {});
  track_list_t list = List(1'000'000, {});
  list.ego_x_odom_m = 100.0;
  Take(scene, "TRACKS_LOCAL", list);
  radar_scan_t scan{};
  scan.utime = 1'000'000;
  scan.num_detections = 1;
  scan.detections = {{10.0, 0.0, 2.0, NAN, NAN, -1}};
  Take(scene, "RADAR_REAR", scan);
  const json radar = json::parse(PageFrame(scene))["radar"];
  ASSERT_EQ(radar.size(), 3u);
  EXPECT_NEAR(radar[0].get<double>(), 89.0, 1e-6);
  EXPECT_NEAR(radar[1].get<double>(), 0.0, 1e-6);
}

TEST(Scene, TruthLiesWhereTheEgoOfTheListsIs) {
  Scene scene({}, {});
  track_list_t list = List(1'000'000, {});
  list.ego_x_odom_m = 10.0;
  list.ego_yaw_odom_rad = 0.0;
  Take(scene, "TRACKS_LOCAL", list);
  truth_list_t truth{};
  truth.utime = 1'000'000;
  truth.ego_x_m = 500.0;
  truth.ego_y_m = 200.0;
  truth.ego_yaw_rad = std::numbers::pi / 2;
  truth.num_objects = 1;
  truth.objects.resize(1);
  truth.objects[0].x_m = 500.0;
  truth.objects[0].y_m = 230.0;  // 30 m ahead of an ego that drives north.
  Take(scene, "TRUTH", truth);
  const json object = json::parse(PageFrame(scene))["truth"][0];
  EXPECT_NEAR(object["x"].get<double>(), 40.0, 1e-6);
  EXPECT_NEAR(object["y"].get<double>(), 0.0, 1e-6);
}

TEST(RoadMap, LanesAndBuildingsComeOutOfAScenario) {
  const RoadMap map = ReadRoadMap(R"(
name: corner
routes: [{name: a, waypoints: [{x_m: 0, y_m: 0}, {x_m: 50, y_m: 0, radius_m: 8}, {x_m: 50, y_m: 50}]}]
buildings: [{x_m: 20, y_m: 20, length_m: 10, width_m: 6}]
)");
  ASSERT_EQ(map.lanes.size(), 1u);
  EXPECT_GT(map.lanes[0].size(), 4u);  // A rounded corner.
  ASSERT_EQ(map.buildings.size(), 1u);
  EXPECT_EQ(map.buildings[0].size(), 4u);
}

TEST(RoadMap, OddTextsGiveAnEmptyMap) {
  for (const char* text : {"", "[", "routes: 5", "routes: [{waypoints: [{x_m: .nan, y_m: 1e99}]}]",
                           "buildings: [[]]", "a: &a [*a]"}) {
    EXPECT_TRUE(ReadRoadMap(text).is_empty()) << text;
  }
}

}  // namespace
}  // namespace v2vouch::view
