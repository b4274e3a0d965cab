// SPDX-License-Identifier: Apache-2.0
// The real drive through the whole core: comma2k19's Toyota radar, 40 s.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "daemon/rim/engine/daemon_config.h"
#include "daemon/rim/engine/engine.h"
#include "daemon/rim/wire/codec.h"
#include "sim/import/comma2k19.h"
#include "tests/support/data_folder.h"
#include "v2vouch/radar_scan_t.hpp"
#include "v2vouch/track_list_t.hpp"

namespace v2vouch {
namespace {

constexpr int kLongestSlot = 535;  // One car ahead for 32.7 s, the longest run in the folder.

std::filesystem::path DriveFolder() { return DataFolder() / "radar" / "comma2k19_segment"; }

struct Place {
  double x_m = 0.0;
  double y_m = 0.0;
};

// Where a slot's object was in the ego's body frame at each scan of its longest run without a
// restart (a gap of more than two scans).
std::map<std::int64_t, Place> LongestRun(const std::vector<sim::ImportedEvent>& events, int slot,
                                         const RadarConfig& radar) {
  std::map<std::int64_t, Place> longest, run;
  std::int64_t last = 0;
  const auto keep = [&] {
    if (run.size() > longest.size()) longest = run;
    run.clear();
  };
  for (const sim::ImportedEvent& event : events) {
    if (event.channel != "RADAR_FRONT") continue;
    const auto scan = wire::Decode<radar_scan_t>(event.bytes);
    if (!scan) continue;
    for (const radar_detection_t& detection : scan->detections) {
      if (detection.track_id != slot) continue;
      if (scan->utime - last > 120'000) keep();
      last = scan->utime;
      run[scan->utime] = {radar.x_m + detection.range_m * std::cos(detection.azimuth_rad),
                          radar.y_m + detection.range_m * std::sin(detection.azimuth_rad)};
    }
  }
  keep();
  return longest;
}

// The rear of a car ahead is what the radar reports of it.
double DistanceToRear(const track_t& track, const Place& place) {
  const double x = track.x_body_m - 0.5 * track.length_m * std::cos(track.yaw_body_rad);
  const double y = track.y_body_m - 0.5 * track.length_m * std::sin(track.yaw_body_rad);
  return std::hypot(x - place.x_m, y - place.y_m);
}

TEST(RealDrive, TheLongestSlotIsOneLocalTrackWithoutIdentitySwitch) {
  if (!std::filesystem::exists(DriveFolder() / "radar_tracks.csv")) {
    GTEST_SKIP() << "SKIPPED: no " << DriveFolder() << " (set V2VOUCH_DATA)";
  }
  sim::Comma2k19Segment segment;
  std::string error;
  ASSERT_TRUE(sim::ReadComma2k19(DriveFolder().string(), segment, error)) << error;
  const auto events = sim::ToEvents(segment, {}, error);
  ASSERT_FALSE(events.empty()) << error;
  DaemonConfig config;
  std::vector<std::string> problems;
  ASSERT_TRUE(LoadDaemonConfig("daemon/vehicles/vehicle_comma2k19.yaml", config, problems));
  const auto run = LongestRun(events, kLongestSlot, config.perception.vehicle.radars[0]);
  ASSERT_GT(static_cast<double>(run.rbegin()->first - run.begin()->first) * 1e-6, 32.0);

  Engine engine(config);
  Outbox outbox;
  std::map<std::int64_t, std::int64_t> id_at;  // By utime of the list.
  int lists = 0;
  for (const sim::ImportedEvent& event : events) {
    outbox.Clear();
    engine.OnMessage(event.channel, event.bytes, event.received, outbox);
    for (const Outbox::Message& message : outbox.messages()) {
      if (message.channel != "TRACKS_LOCAL") continue;
      const auto list = wire::Decode<track_list_t>(message.bytes);
      ASSERT_TRUE(list);
      ++lists;
      for (const track_t& track : list->tracks) {
        ASSERT_TRUE(std::isfinite(track.x_body_m) && std::isfinite(track.y_body_m) &&
                    std::isfinite(track.speed_mps) && std::isfinite(track.covariance_odom[0]));
      }
      const auto place = run.find(list->utime);
      if (place == run.end()) continue;
      const track_t* nearest = nullptr;
      for (const track_t& track : list->tracks) {
        if (nearest == nullptr ||
            DistanceToRear(track, place->second) < DistanceToRear(*nearest, place->second)) {
          nearest = &track;
        }
      }
      if (nearest != nullptr && DistanceToRear(*nearest, place->second) < 3.0) {
        id_at[list->utime] = nearest->id;
      }
    }
  }
  EXPECT_GT(lists, 700);
  std::set<std::int64_t> ids;
  for (const auto& [utime, id] : id_at) ids.insert(id);
  EXPECT_EQ(ids.size(), 1u);
  // All but the looks before it is confirmed.
  EXPECT_GE(id_at.size() + 10, run.size());

  // The one refusal that is explained: the first scan comes before the first speed.
  for (std::size_t reason = 0; reason < kReasonCount; ++reason) {
    const auto count = engine.refusals()[reason];
    EXPECT_LE(count, static_cast<Reason>(reason) == Reason::kNoEgoMotion ? 2u : 0u)
        << ReasonName(static_cast<Reason>(reason));
  }
}

}  // namespace
}  // namespace v2vouch
