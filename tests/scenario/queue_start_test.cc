// SPDX-License-Identifier: Apache-2.0
// The daemon starts, or starts again, while the car stands in a queue: the car ahead, which nobody
// has seen move and whose box the picture's lower end may cut off, is listed at once.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "daemon/rim/engine/daemon_config.h"
#include "daemon/rim/engine/engine.h"
#include "daemon/rim/wire/codec.h"
#include "sim/simulation/simulation.h"
#include "tests/support/simulated_events.h"
#include "v2vouch/track_list_t.hpp"
#include "v2vouch/truth_list_t.hpp"

namespace v2vouch::testing {
namespace {

constexpr double kLane_m = -1.75;
// Nearer than this the picture cuts the box off and the range is the radars' alone: the first
// moments may disagree.
constexpr double kCut_m = 2.0;
constexpr double kSettled_s = 2.0;

// The ego's centre stands at x = -40; both cars are 4.6 m long.
std::vector<sim::SimEvent> Queue(double gap_m, std::uint64_t seed) {
  std::ostringstream yaml;
  yaml << "name: queue\nduration_s: 4\n"
          "routes:\n"
          "  - name: east\n"
          "    waypoints: [{x_m: -100, y_m: -1.75}, {x_m: 300, y_m: -1.75}]\n"
          "ego:\n"
          "  drive: {route: east, start_m: 60, speed_mps: 0}\n"
          "parked:\n"
          "  - {id: 1, class: car, x_m: "
       << -40.0 + 4.6 + gap_m << ", y_m: " << kLane_m << ", yaw_deg: 0}\n";
  return EventsOf(yaml.str(), seed);
}

struct Result {
  double first_s = 1e9;      // When the lead was listed for the first time.
  int absent = 0;            // Lists without it after that,
  int absent_later = 0;      // and of those from kSettled_s on.
  double worst_along_m = 0;  // Of its near end, from then on.
  int strangers = 0;         // Entries of lists from then on that are no car.
};

Result Perceive(const std::vector<sim::SimEvent>& events) {
  DaemonConfig config;
  std::vector<std::string> problems;
  EXPECT_TRUE(LoadDaemonConfig("", config, problems));
  Engine engine(config);
  Outbox outbox;
  Result result;
  std::optional<truth_list_t> truth;
  std::int64_t begin_us = 0;
  for (const sim::SimEvent& event : events) {
    if (event.channel == "TRUTH") {
      if (auto list = wire::Decode<truth_list_t>(event.bytes)) truth = *list;
      if (begin_us == 0) begin_us = truth->utime;
      continue;
    }
    outbox.Clear();
    engine.OnMessage(event.channel, event.bytes, event.arrival, outbox);
    for (const Outbox::Message& message : outbox.messages()) {
      if (message.channel != "TRACKS_LOCAL" || !truth) continue;
      const auto list = wire::Decode<track_list_t>(message.bytes);
      if (!list) continue;
      const truth_object_t& lead = truth->objects.at(0);
      const double near_x = lead.x_m - 0.5 * lead.length_m - truth->ego_x_m;
      const bool is_settled = 1e-6 * static_cast<double>(list->utime - begin_us) > kSettled_s;
      bool is_there = false;
      for (const track_t& track : list->tracks) {
        const double along = track.x_body_m - 0.5 * track.length_m - near_x;
        if (std::hypot(along, track.y_body_m) > 1.5) {
          result.strangers += is_settled;
          continue;
        }
        is_there = true;
        if (is_settled) result.worst_along_m = std::max(result.worst_along_m, std::abs(along));
      }
      if (is_there && result.first_s > 1e8) {
        result.first_s = 1e-6 * static_cast<double>(list->utime - begin_us);
      }
      result.absent += !is_there && result.first_s < 1e8;
      result.absent_later += !is_there && is_settled;
    }
  }
  return result;
}

class QueueStartTest : public ::testing::TestWithParam<double> {};

TEST_P(QueueStartTest, TheCarAheadIsListedAtOnceAndStays) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Result result = Perceive(Queue(GetParam(), seed));
    EXPECT_LT(result.first_s, 1.0) << seed;
    EXPECT_EQ(result.absent_later, 0) << seed;
    if (GetParam() >= kCut_m) {
      EXPECT_EQ(result.absent, 0) << seed;
    }
    EXPECT_LT(result.worst_along_m, 0.6) << seed;
    EXPECT_EQ(result.strangers, 0) << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Gaps, QueueStartTest, ::testing::Values(1.0, 1.5, 2.0, 3.5, 5.0, 8.0));

}  // namespace
}  // namespace v2vouch::testing
