// SPDX-License-Identifier: Apache-2.0
#include "sim/import/comma2k19.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "daemon/common/base/angle.h"
#include "daemon/rim/wire/codec.h"
#include "tests/sim/import/files.h"
#include "v2vouch/ego_motion_t.hpp"
#include "v2vouch/gnss_fix_t.hpp"
#include "v2vouch/radar_scan_t.hpp"

namespace v2vouch::sim {
namespace {

using testing::HasSubstr;

template <class Message>
std::vector<Message> Messages(const std::vector<ImportedEvent>& events,
                              const std::string& channel) {
  std::vector<Message> messages;
  for (const ImportedEvent& event : events) {
    if (event.channel != channel) continue;
    const auto message = wire::Decode<Message>(event.bytes);
    EXPECT_TRUE(message) << channel;
    if (message) messages.push_back(*message);
  }
  return messages;
}

// Two radar cycles, the car turning left at 0.1 rad/s, fixes out 60 ms after their measurement.
Comma2k19Segment SmallSegment() {
  Comma2k19Segment segment;
  segment.radar = {{100.000, 32.7, 3.0, -1.5, 530},
                   {100.003, 52.7, -4.0, 2.0, 531},
                   {100.050, 32.6, 3.0, -1.5, 530}};
  for (int k = 0; k < 10; ++k) segment.speed.push_back({100.0 + 0.012 * k, 10.0 + k});
  for (int k = 0; k < 12; ++k) segment.gyro.push_back({100.0 + 0.01 * k, -0.1});
  segment.fixes = {{100.06, 37.0, -122.0, 10.0, 1'000'000'000'000, 5.0, 90.0},
                   {100.16, 37.0, -122.0, 1.0, 1'000'000'000'100, 5.0, 90.0},
                   {100.30, 37.0, -122.0, 10.0, 1'000'000'000'200, 5.0, 350.0}};
  return segment;
}

TEST(Comma2k19, DetectionsOfOneCycleMakeOneScanInTheSensorsOwnPolarCoordinates) {
  std::string error;
  const auto events = ToEvents(SmallSegment(), {}, error);
  const auto scans = Messages<radar_scan_t>(events, "RADAR_FRONT");
  ASSERT_EQ(scans.size(), 2u);
  ASSERT_EQ(scans[0].num_detections, 2);
  EXPECT_EQ(scans[1].num_detections, 1);
  EXPECT_EQ(scans[1].seq, 1);
  const radar_detection_t& first = scans[0].detections[0];
  EXPECT_DOUBLE_EQ(first.range_m, std::hypot(30.0, 3.0));  // 2.70 m taken off again.
  EXPECT_DOUBLE_EQ(first.azimuth_rad, std::atan2(3.0, 30.0));
  EXPECT_EQ(first.range_rate_mps, -1.5);
  EXPECT_EQ(first.track_id, 530);
  EXPECT_TRUE(std::isnan(first.snr_db));
}

TEST(Comma2k19, RangeOffsetSideAndNameOfTheRadarAreOptions) {
  std::string error;
  Comma2k19Options options;
  options.radar_name = "GRILLE";
  options.range_offset_m = 0.0;
  options.flip_lateral = true;
  const auto scans =
      Messages<radar_scan_t>(ToEvents(SmallSegment(), options, error), "RADAR_GRILLE");
  ASSERT_EQ(scans.size(), 2u);
  EXPECT_EQ(scans[0].sensor, "GRILLE");
  EXPECT_DOUBLE_EQ(scans[0].detections[0].azimuth_rad, std::atan2(-3.0, 32.7));
}

TEST(Comma2k19, BootTimeBecomesUtcByTheMedianFixWithItsLatency) {
  std::string error;
  const auto events = ToEvents(SmallSegment(), {}, error);
  // Two of three fixes left the receiver 60 ms after measurement, so boot 100.000 s is their UTC.
  const auto scans = Messages<radar_scan_t>(events, "RADAR_FRONT");
  EXPECT_EQ(scans[0].utime, 1'000'000'000'000'000);
  EXPECT_EQ(scans[1].utime, 1'000'000'000'050'000);
  const auto fixes = Messages<gnss_fix_t>(events, "EGO_GNSS");
  EXPECT_EQ(fixes[2].utime, 1'000'000'000'200'000);  // The receiver's own stamp.
}

TEST(Comma2k19, YawRateIsLeftPositiveAndCourseOnlyCountsOnTheMove) {
  std::string error;
  const auto events = ToEvents(SmallSegment(), {}, error);
  const auto motion = Messages<ego_motion_t>(events, "EGO_MOTION");
  ASSERT_EQ(motion.size(), 10u);
  for (const ego_motion_t& sample : motion) EXPECT_DOUBLE_EQ(sample.yaw_rate_radps, 0.1);
  EXPECT_EQ(motion[3].speed_mps, 13.0);
  const auto fixes = Messages<gnss_fix_t>(events, "EGO_GNSS");
  EXPECT_DOUBLE_EQ(fixes[0].heading_rad, FromDegrees(90.0));  // Clockwise from north.
  EXPECT_NEAR(fixes[0].velocity_east_mps, 10.0, 1e-12);
  EXPECT_NEAR(fixes[0].velocity_north_mps, 0.0, 1e-12);
  EXPECT_TRUE(std::isnan(fixes[1].heading_rad));  // 1 m/s.
}

TEST(Comma2k19, EventsAreSortedByTheirArrival) {
  std::string error;
  const auto events = ToEvents(SmallSegment(), {}, error);
  EXPECT_TRUE(std::is_sorted(events.begin(), events.end(),
                             [](const auto& a, const auto& b) { return a.received < b.received; }));
  EXPECT_EQ(events.size(), 2u + 10u + 3u);
}

TEST(Comma2k19, AnEmptyStreamIsRefused) {
  Comma2k19Segment segment = SmallSegment();
  segment.gyro.clear();
  std::string error;
  EXPECT_TRUE(ToEvents(segment, {}, error).empty());
  EXPECT_NE(error, "");
}

TEST(Comma2k19, FaultyFilesNameFileLineAndFault) {
  const std::string radar_header =
      "t_boot_s,long_dist_m,lat_left_m,rel_speed_mps,can_address,new_track\n";
  const std::map<std::string, std::string> bad{
      {"1.0,30,0,0,530,0\n0.9,30,0,0,530,0\n", ":3: time goes back"},
      {"1.0,30,0,0,99999999,0\n", ":2: can_address is out of range"},
      {"1.0,30,zero,0,530,0\n", ":2: lat_left_m"},
      {"", "holds no row"}};
  for (const auto& [rows, expected] : bad) {
    ScratchFolder folder("comma");
    folder.Write("radar_tracks.csv", radar_header + rows);
    Comma2k19Segment segment;
    std::string error;
    EXPECT_FALSE(ReadComma2k19(folder.path(), segment, error));
    EXPECT_THAT(error, HasSubstr("radar_tracks.csv"));
    EXPECT_THAT(error, HasSubstr(expected));
  }
}

// The real drive. Counts and rates are those of the recording itself.
TEST(Comma2k19, TheRealDriveBecomes800ScansWithTheLongTrackInNearlyAll) {
  const auto folder = ReferenceData("radar/comma2k19_segment");
  if (!std::filesystem::exists(folder)) {
    GTEST_SKIP() << "SKIPPED: no " << folder << " (set V2VOUCH_DATA)";
  }
  Comma2k19Segment segment;
  std::string error;
  ASSERT_TRUE(ReadComma2k19(folder.string(), segment, error)) << error;
  const auto events = ToEvents(segment, {}, error);
  const auto scans = Messages<radar_scan_t>(events, "RADAR_FRONT");
  ASSERT_EQ(scans.size(), 800u);
  int with_535 = 0;
  std::size_t detections = 0;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    if (k > 0) {
      EXPECT_NEAR(static_cast<double>(scans[k].utime - scans[k - 1].utime), 50000.0, 7000.0);
    }
    detections += scans[k].detections.size();
    for (const auto& detection : scans[k].detections) with_535 += detection.track_id == 535;
  }
  EXPECT_EQ(detections, 6975u);
  EXPECT_EQ(with_535, 798);
  const auto motion = Messages<ego_motion_t>(events, "EGO_MOTION");
  const double seconds = static_cast<double>(motion.back().utime - motion.front().utime) * 1e-6;
  EXPECT_NEAR(static_cast<double>(motion.size()) / seconds, 83.0, 1.0);
  // The post-processed pose turns right by 0.64 degrees over the 40 s; gyro bias adds to that.
  double yaw_rad = 0.0;
  for (std::size_t k = 1; k < motion.size(); ++k) {
    yaw_rad += motion[k].yaw_rate_radps *
               static_cast<double>(motion[k].utime - motion[k - 1].utime) * 1e-6;
  }
  EXPECT_LT(std::abs(ToDegrees(yaw_rad) + 0.64), 3.0);
}

}  // namespace
}  // namespace v2vouch::sim
