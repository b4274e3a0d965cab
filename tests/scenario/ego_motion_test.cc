// SPDX-License-Identifier: Apache-2.0
// What ego sensors really send: a gyro off, a wheel speed that reads 0 at walking pace or has no
// sign. Each edits a simulated drive.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "daemon/common/base/angle.h"
#include "daemon/rim/engine/daemon_config.h"
#include "daemon/rim/engine/engine.h"
#include "daemon/rim/wire/codec.h"
#include "sim/simulation/simulation.h"
#include "tests/support/simulated_events.h"
#include "v2vouch/ego_motion_t.hpp"
#include "v2vouch/track_list_t.hpp"
#include "v2vouch/truth_list_t.hpp"

namespace v2vouch::testing {
namespace {

using Recording = std::vector<sim::SimEvent>;

Recording With(Recording recording, const std::function<void(ego_motion_t&)>& edit) {
  for (sim::SimEvent& event : recording) {
    if (event.channel != "EGO_MOTION") continue;
    auto motion = wire::Decode<ego_motion_t>(event.bytes);
    if (!motion) continue;
    ego_motion_t edited = *motion;
    edit(edited);
    wire::Encode(edited, event.bytes);
  }
  return recording;
}

struct Result {
  double false_per_list = 0.0;  // LOCAL tracks more than 4 m from any true vehicle, after 1.5 s.
  double least_seen = 1.0;      // Of the vehicle `follow`, share of lists with a track within 2 m.
  double ego_yaw_rad = 0.0;     // Of the last list.
  std::set<std::string> notices;
};

Result Perceive(const Recording& recording, int follow) {
  DaemonConfig config;
  std::vector<std::string> problems;
  EXPECT_TRUE(LoadDaemonConfig("", config, problems));
  Engine engine(config);
  Outbox outbox;
  Result result;
  std::optional<truth_list_t> truth;
  std::int64_t begin_us = 0;
  int lists = 0;
  int strangers = 0;
  int seen = 0;
  for (const sim::SimEvent& event : recording) {
    if (event.channel == "TRUTH") {
      if (auto list = wire::Decode<truth_list_t>(event.bytes)) truth = *list;
      if (begin_us == 0) begin_us = truth->utime;
      outbox.Clear();
      engine.PublishStatus(outbox);
      for (const auto& change : engine.TakeNoticeChanges()) {
        if (change.has_begun) result.notices.insert(change.notice.name);
      }
      continue;
    }
    outbox.Clear();
    engine.OnMessage(event.channel, event.bytes, event.arrival, outbox);
    for (const Outbox::Message& message : outbox.messages()) {
      if (message.channel != "TRACKS_LOCAL" || !truth) continue;
      const auto list = wire::Decode<track_list_t>(message.bytes);
      if (!list || list->utime - begin_us < 1'500'000) continue;
      ++lists;
      result.ego_yaw_rad = list->ego_yaw_odom_rad;
      bool is_followed = false;
      for (const track_t& track : list->tracks) {
        const double c = std::cos(truth->ego_yaw_rad);
        const double s = std::sin(truth->ego_yaw_rad);
        const double x = truth->ego_x_m + c * track.x_body_m - s * track.y_body_m;
        const double y = truth->ego_y_m + s * track.x_body_m + c * track.y_body_m;
        bool is_true = false;
        for (const truth_object_t& object : truth->objects) {
          const double off = std::hypot(object.x_m - x, object.y_m - y);
          is_true |= off < 4.0;
          is_followed |= object.id == follow && off < 2.0;
        }
        strangers += !is_true;
      }
      seen += is_followed;
    }
  }
  result.false_per_list = static_cast<double>(strangers) / std::max(1, lists);
  result.least_seen = static_cast<double>(seen) / std::max(1, lists);
  return result;
}

constexpr const char* kCreep = R"(
name: creep
duration_s: 12
routes:
  - name: north
    waypoints: [{x_m: 1.75, y_m: -150}, {x_m: 1.75, y_m: 500}]
ego:
  drive: {route: north, start_m: 100, speed_mps: 0.9}
vehicles:
  - {id: 1, class: car, v2v: true, drive: {route: north, start_m: 110, speed_mps: 0.9}}
parked:
  - {id: 101, class: car, x_m: 5.0, y_m: -25, yaw_deg: 90}
  - {id: 102, class: car, x_m: -5.0, y_m: -20, yaw_deg: -90}
pole_rows:
  - {from_x_m: 7.5, from_y_m: -60, to_x_m: 7.5, to_y_m: 60, every_m: 12}
  - {from_x_m: -7.5, from_y_m: -60, to_x_m: -7.5, to_y_m: 60, every_m: 12}
)";

TEST(EgoMotionScenario, AWheelSpeedOf0AtWalkingPaceMakesNoVehicles) {
  const Recording good = EventsOf(kCreep, 1);
  ASSERT_FALSE(good.empty());
  const Result right = Perceive(good, 1);
  const Result edited = Perceive(With(good,
                                      [](ego_motion_t& m) {
                                        if (std::abs(m.speed_mps) < 1.2) m.speed_mps = 0.0;
                                        m.accel_long_mps2 = std::nan("");
                                      }),
                                 1);
  EXPECT_LT(edited.false_per_list, right.false_per_list + 0.3);
  EXPECT_GT(edited.least_seen, 0.95);
  EXPECT_EQ(edited.notices.count("speed_deadband"), 1u);
  EXPECT_EQ(right.notices.count("speed_deadband"), 0u);
  EXPECT_EQ(right.notices.count("speed_suspect"), 0u);
}

constexpr const char* kBack = R"(
name: back
duration_s: 8
routes:
  - name: back
    waypoints: [{x_m: 1.75, y_m: 100}, {x_m: 1.75, y_m: -200}]
ego:
  drive: {route: back, start_m: 20, speed_mps: 3.5, reverse: true}
parked:
  - {id: 101, class: car, x_m: 5.0, y_m: 110, yaw_deg: 90}
  - {id: 102, class: car, x_m: 5.0, y_m: 118, yaw_deg: 90}
pole_rows:
  - {from_x_m: 6.5, from_y_m: 60, to_x_m: 6.5, to_y_m: 300, every_m: 15}
  - {from_x_m: -6.5, from_y_m: 60, to_x_m: -6.5, to_y_m: 300, every_m: 15}
)";

TEST(EgoMotionScenario, ASpeedWithoutSignMakesNoVehicles) {
  const Recording good = EventsOf(kBack, 1);
  ASSERT_FALSE(good.empty());
  const double right = Perceive(good, 101).false_per_list;
  for (const int gear : {3, 7}) {
    const Result edited = Perceive(With(good,
                                        [gear](ego_motion_t& m) {
                                          m.speed_mps = std::abs(m.speed_mps);
                                          m.gear = static_cast<std::int8_t>(gear);
                                        }),
                                   101);
    EXPECT_LT(edited.false_per_list, right + 0.4) << gear;
    EXPECT_EQ(edited.notices.count("speed_sign"), 1u) << gear;
    EXPECT_EQ(edited.notices.count("gear_contradicts"), gear == 3 ? 1u : 0u);
  }
}

constexpr const char* kStand = R"(
name: stand
duration_s: 40
routes:
  - name: north
    waypoints: [{x_m: 1.75, y_m: -150}, {x_m: 1.75, y_m: 500}]
ego:
  drive: {route: north, start_m: 120, speed_mps: 10, stops: [{at_m: 140, until_s: 100}]}
vehicles:
  - {id: 1, class: car, v2v: true, drive: {route: north, start_m: 140, speed_mps: 10, stops: [{at_m: 151, until_s: 100}]}}
)";

TEST(EgoMotionScenario, AGyroOffsetDoesNotTurnAStandingCar) {
  const Recording good = EventsOf(kStand, 1);
  ASSERT_FALSE(good.empty());
  const double right = Perceive(good, 1).ego_yaw_rad;
  for (const double offset_degps : {0.5, -0.17, 0.1}) {
    const Result edited = Perceive(
        With(good, [&](ego_motion_t& m) { m.yaw_rate_radps += FromDegrees(offset_degps); }), 1);
    // What it gathered before the car stood.
    EXPECT_NEAR(ToDegrees(edited.ego_yaw_rad - right), 0.0, 6.0 * std::abs(offset_degps));
    EXPECT_GT(edited.least_seen, 0.97) << offset_degps;
    EXPECT_EQ(edited.notices.count("gyro_offset"), 1u) << offset_degps;
  }
}

}  // namespace
}  // namespace v2vouch::testing
