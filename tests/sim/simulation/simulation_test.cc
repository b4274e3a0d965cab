// SPDX-License-Identifier: Apache-2.0
#include "sim/simulation/simulation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <v2vouch/bsm_t.hpp>
#include <v2vouch/camera_detections_t.hpp>
#include <v2vouch/radar_scan_t.hpp>
#include <v2vouch/truth_bsm_t.hpp>
#include <v2vouch/truth_list_t.hpp>

#include "daemon/rim/wire/codec.h"
#include "sim/sensors/bsm.h"
#include "sim/world/overlay.h"
#include "tests/support/simulated_events.h"

namespace v2vouch::sim {
namespace {

using testing::AllEvents;

std::unique_ptr<World> Shipped(const std::string& name, std::uint64_t seed,
                               SensorMode mode = SensorMode::kRealistic) {
  Scenario scenario;
  std::vector<std::string> problems;
  EXPECT_TRUE(LoadScenario("sim/scenarios/" + name + ".yaml", scenario, problems));
  scenario.sensors.mode = mode;
  auto world = World::Make(scenario, seed, problems);
  for (const std::string& problem : problems) ADD_FAILURE() << problem;
  return world;
}

template <class T>
T As(const SimEvent& event) {
  const auto decoded = wire::Decode<T>(event.bytes);
  EXPECT_TRUE(decoded) << event.channel;
  return decoded ? *decoded : T{};
}

TEST(Simulation, TheSameSeedGivesTheSameBytesAndAnotherDoesNot) {
  const auto world = Shipped("smoke", 5);
  const auto first = AllEvents(*world, 5);
  const auto second = AllEvents(*world, 5);
  const auto other = AllEvents(*world, 6);
  ASSERT_EQ(first.size(), second.size());
  bool differs = first.size() != other.size();
  for (std::size_t i = 0; i < first.size(); ++i) {
    ASSERT_EQ(first[i].arrival, second[i].arrival);
    ASSERT_EQ(first[i].channel, second[i].channel);
    ASSERT_EQ(first[i].bytes, second[i].bytes) << first[i].channel << " event " << i;
    differs = differs || (i < other.size() && first[i].bytes != other[i].bytes);
  }
  EXPECT_TRUE(differs);
}

TEST(Simulation, EventsComeInOrderOfArrivalAndCameraLate) {
  const auto world = Shipped("smoke", 5);
  const auto events = AllEvents(*world, 5);
  EXPECT_EQ(events.front().channel, "SIM_SCENARIO");
  std::map<std::string, int> counts;
  double latest_s = 0.0;
  for (std::size_t i = 0; i < events.size(); ++i) {
    if (i > 0) {
      EXPECT_GE(events[i].arrival, events[i - 1].arrival);
    }
    ++counts[events[i].channel];
    if (events[i].channel != "CAMERA_FRONT") continue;
    const auto picture = As<camera_detections_t>(events[i]);
    const double latency = ToSeconds(events[i].arrival - FromMicros(picture.utime));
    EXPECT_GE(latency, 0.0599);
    latest_s = std::max(latest_s, latency);
  }
  EXPECT_GT(latest_s, 0.09);
  EXPECT_EQ(counts["SIM_SCENARIO"], 1);
  EXPECT_EQ(counts["EGO_MOTION"], 300);
  EXPECT_EQ(counts["TRUTH"], 120);
  EXPECT_GE(counts["RADAR_FRONT"], 119);
  EXPECT_GE(counts["BSM"], 50);
}

// Without attacks the channel BSM holds what the units themselves make, byte for byte, and
// TRUTH_BSM says of each message that it is honest.
TEST(Simulation, HonestMessagesAreTheUnitsOwnAndTheirTruthSaysSo) {
  const auto world = Shipped("left_turn", 3);
  std::multiset<std::string> sent;
  for (std::size_t i = 0; i < world->actors().size(); ++i) {
    if (!world->actors()[i].has_v2v) continue;
    BsmSender sender(*world, static_cast<int>(i), 3);
    while (sender.next_time_s() < world->scenario().duration_s) {
      std::vector<std::uint8_t> bytes;
      if (const auto bsm = sender.Next()) {
        wire::Encode(*bsm, bytes);
        sent.insert(std::string(bytes.begin(), bytes.end()));
      }
    }
  }
  const auto events = AllEvents(*world, 3);
  std::int64_t count = 0;
  for (std::size_t i = 0; i < events.size(); ++i) {
    if (events[i].channel != "BSM") continue;
    bsm_t bsm = As<bsm_t>(events[i]);
    EXPECT_EQ(bsm.seq, count++);
    ASSERT_LT(i + 1, events.size());
    ASSERT_EQ(events[i + 1].channel, "TRUTH_BSM");
    const auto truth = As<truth_bsm_t>(events[i + 1]);
    EXPECT_EQ(events[i + 1].arrival, events[i].arrival);
    EXPECT_EQ(truth.seq, bsm.seq);
    EXPECT_EQ(truth.utime, bsm.rx_utime);
    EXPECT_TRUE(std::equal(std::begin(bsm.id), std::end(bsm.id), std::begin(truth.sender_id)));
    EXPECT_EQ(truth.is_attacker, 0);
    EXPECT_EQ(truth.is_attack, 0);
    EXPECT_EQ(truth.attack, "");
    EXPECT_GT(truth.vehicle_id, 0);
    EXPECT_EQ(truth.device_id, truth.vehicle_id);
    // Half a unit of each field: 8 mm of place, 0.00625 degrees, 0.01 m/s, 0.005 m/s2, 5 mm.
    EXPECT_NEAR(truth.claimed_x_m, truth.honest_x_m, 0.008);
    EXPECT_NEAR(truth.claimed_y_m, truth.honest_y_m, 0.008);
    EXPECT_NEAR(AngleDifference(truth.claimed_yaw_rad, truth.honest_yaw_rad), 0.0, 1.1e-4);
    EXPECT_NEAR(truth.claimed_speed_mps, truth.honest_speed_mps, 0.0101);
    EXPECT_NEAR(truth.claimed_accel_mps2, truth.honest_accel_mps2, 0.0051);
    EXPECT_NEAR(truth.claimed_length_m, truth.honest_length_m, 0.0051);
    EXPECT_GE(truth.age_s, 0.0699);
    EXPECT_LE(truth.age_s, 0.2001);
    bsm.seq = 0;
    std::vector<std::uint8_t> bytes;
    wire::Encode(bsm, bytes);
    const auto twin = sent.find(std::string(bytes.begin(), bytes.end()));
    ASSERT_NE(twin, sent.end()) << "message " << count;
    sent.erase(twin);
  }
  EXPECT_GT(count, 1000);
  EXPECT_LT(sent.size(), 10u);  // Under way when the scenario ends.
}

std::unique_ptr<World> Attacked(const std::string& overlay, std::uint64_t seed) {
  Scenario scenario;
  std::vector<std::string> problems;
  EXPECT_TRUE(LoadScenario("sim/scenarios/campaign_urban.yaml", scenario, problems));
  scenario.duration_s = 20.0;
  scenario.traffic.vehicles = 3;
  if (!overlay.empty()) {
    EXPECT_TRUE(LayOver("sim/attacks/catalogue/" + overlay + ".yaml", scenario, problems));
  }
  EXPECT_TRUE(CheckReferences(scenario, problems));
  auto world = World::Make(scenario, seed, problems);
  for (const std::string& problem : problems) ADD_FAILURE() << problem;
  return world;
}

class UnderAttack : public ::testing::TestWithParam<const char*> {};

// Whatever is lied by radio, the ego's own sensors, its GNSS and the truth keep every byte.
TEST_P(UnderAttack, AllButTheRadioKeepsEveryByte) {
  const auto honest = AllEvents(*Attacked("", 11), 11);
  const auto attacked = AllEvents(*Attacked(GetParam(), 11), 11);
  const auto others = [](const std::vector<SimEvent>& events) {
    std::vector<const SimEvent*> kept;
    for (const SimEvent& event : events) {
      if (event.channel != "BSM" && event.channel != "TRUTH_BSM" &&
          event.channel != "SIM_SCENARIO") {
        kept.push_back(&event);
      }
    }
    return kept;
  };
  const auto before = others(honest);
  const auto after = others(attacked);
  ASSERT_EQ(before.size(), after.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    ASSERT_EQ(before[i]->channel, after[i]->channel);
    ASSERT_EQ(before[i]->arrival, after[i]->arrival);
    ASSERT_EQ(before[i]->bytes, after[i]->bytes) << before[i]->channel;
  }
  EXPECT_NE(honest.size() == attacked.size() &&
                std::equal(honest.begin() + 1, honest.end(), attacked.begin() + 1,
                           [](const SimEvent& a, const SimEvent& b) { return a.bytes == b.bytes; }),
            true);
}

// Those who do not take part say what they would have said, at the same time.
TEST_P(UnderAttack, HonestVehiclesSayTheSame) {
  std::map<std::pair<std::int64_t, std::int64_t>, std::pair<std::int64_t, double>> honest;
  for (const SimEvent& event : AllEvents(*Attacked("", 11), 11)) {
    if (event.channel != "TRUTH_BSM") continue;
    const auto truth = As<truth_bsm_t>(event);
    honest[{truth.device_id, truth.utime}] = {truth.vehicle_id, truth.claimed_x_m};
  }
  std::int64_t count = 0;
  for (const SimEvent& event : AllEvents(*Attacked(GetParam(), 11), 11)) {
    if (event.channel != "TRUTH_BSM") continue;
    const auto truth = As<truth_bsm_t>(event);
    if (truth.is_attacker != 0) continue;
    const auto same = honest.find({truth.device_id, truth.utime});
    ASSERT_NE(same, honest.end());
    EXPECT_EQ(same->second.first, truth.vehicle_id);
    EXPECT_EQ(same->second.second, truth.claimed_x_m);
    ++count;
  }
  EXPECT_GT(count, 800);
}

INSTANTIATE_TEST_SUITE_P(Some, UnderAttack,
                         ::testing::Values("A01_ahead_30m", "A05_lateral_8m", "A11_grid_5",
                                           "A12_three_ids", "A22_malformed_5000"));

TEST(Simulation, LostFramesAndWeakDetectionThinTheSensors) {
  Scenario scenario;
  std::vector<std::string> problems;
  ASSERT_TRUE(LoadScenario("sim/scenarios/smoke.yaml", scenario, problems));
  scenario.sensors.mode = SensorMode::kIdealPoints;
  const auto count = [&](double lost, double scale) {
    scenario.sensors.frame_loss = lost;
    scenario.sensors.detection_scale = scale;
    const auto world = World::Make(scenario, 5, problems);
    std::pair<int, int> frames_and_detections{0, 0};
    for (const SimEvent& event : AllEvents(*world, 5)) {
      if (event.channel != "RADAR_FRONT") continue;
      ++frames_and_detections.first;
      frames_and_detections.second += As<radar_scan_t>(event).num_detections;
    }
    return frames_and_detections;
  };
  const auto all = count(0.0, 1.0);
  const auto lossy = count(0.3, 1.0);
  const auto weak = count(0.0, 0.5);
  EXPECT_NEAR(lossy.first, 0.7 * all.first, 15.0);  // Three sigma of 120 draws.
  EXPECT_EQ(weak.first, all.first);
  EXPECT_NEAR(weak.second, 0.5 * all.second, 0.12 * all.second);
}

TEST(LeftTurn, CriticalCarIsSeenLongThenHiddenThreeToFiveSecondsThenSeenAgain) {
  const auto world = Shipped("left_turn", 1);
  std::vector<std::pair<double, bool>> hidden;
  std::map<std::string, double> seen_s;  // Before the occlusion, by sensor.
  std::int64_t begin = 0;
  for (const SimEvent& event : AllEvents(*world, 1)) {
    if (event.channel != "TRUTH") continue;
    const auto truth = As<truth_list_t>(event);
    if (begin == 0) begin = truth.utime;
    const double time = 1e-6 * static_cast<double>(truth.utime - begin);
    for (const auto& object : truth.objects) {
      if (object.id != 2) continue;
      hidden.emplace_back(time, object.is_hidden != 0);
      if (time > 17.0) continue;
      for (const auto& sensor : object.sensors) {
        if (sensor.detection_probability > 0.5) seen_s[sensor.sensor] += 0.05;
      }
    }
  }
  // The occlusion: the stretch of hidden samples round 18 s.
  const auto middle = std::find_if(hidden.begin(), hidden.end(),
                                   [](const auto& sample) { return sample.first > 18.0; });
  ASSERT_NE(middle, hidden.end());
  ASSERT_TRUE(middle->second);
  auto from = middle;
  auto to = middle;
  while (from != hidden.begin() && std::prev(from)->second) --from;
  while (to != hidden.end() && to->second) ++to;
  ASSERT_NE(to, hidden.end());
  const double lasts = to->first - from->first;
  EXPECT_GE(lasts, 3.0);
  EXPECT_LE(lasts, 5.0);
  EXPECT_GE(seen_s["RADAR_FRONT"], 6.0);
  EXPECT_GE(seen_s["CAMERA_FRONT"], 6.0);
}

class StaticReturns : public ::testing::TestWithParam<const char*> {};

// Standing returns: Doppler explained by the antenna's own motion, taken from the truth.
TEST_P(StaticReturns, EightAtLeastInEveryScanOfEveryRadar) {
  const auto world = Shipped(GetParam(), 1);
  const VehicleConfig& vehicle = world->scenario().vehicle;
  const auto start = static_cast<std::int64_t>(world->scenario().start_utc_s) * 1000000;
  for (const SimEvent& event : AllEvents(*world, 1)) {
    if (!event.channel.starts_with("RADAR_")) continue;
    const auto scan = As<radar_scan_t>(event);
    const auto radar = std::find_if(vehicle.radars.begin(), vehicle.radars.end(),
                                    [&](const auto& r) { return r.name == scan.sensor; });
    ASSERT_NE(radar, vehicle.radars.end());
    const EgoTruth ego = world->At(1e-6 * static_cast<double>(scan.utime - start)).ego;
    const Vec2 velocity(ego.speed_mps - ego.yaw_rate_radps * radar->y_m,
                        ego.yaw_rate_radps * radar->x_m);
    int standing = 0;
    for (const auto& d : scan.detections) {
      const double ground =
          d.range_rate_mps + velocity.dot(Direction(radar->yaw_rad + d.azimuth_rad));
      // Doppler noise and, at speed, the angle's noise.
      if (std::abs(ground) < 0.5 + 4.0 * radar->azimuth_sigma_rad * ego.speed_mps) ++standing;
    }
    EXPECT_GE(standing, 8) << event.channel << " at "
                           << 1e-6 * static_cast<double>(scan.utime - start) << " s";
  }
}

INSTANTIATE_TEST_SUITE_P(All, StaticReturns, ::testing::Values("left_turn", "urban", "highway"));

TEST(IdealPoints, GiveOneDetectionPerVehicleAndNothingElse) {
  const auto world = Shipped("left_turn", 1, SensorMode::kIdealPoints);
  const auto start = static_cast<std::int64_t>(world->scenario().start_utc_s) * 1000000;
  const RadarConfig& front = world->scenario().vehicle.radars[0];
  std::size_t total = 0;
  for (const SimEvent& event : AllEvents(*world, 1)) {
    if (event.channel != "RADAR_FRONT") continue;
    const auto scan = As<radar_scan_t>(event);
    const Snapshot snapshot = world->At(1e-6 * static_cast<double>(scan.utime - start));
    std::map<std::uint32_t, int> matched;
    for (const auto& d : scan.detections) {
      const Vec2 p = snapshot.ego.PointAt(front.x_m, front.y_m) +
                     d.range_m * Direction(snapshot.ego.yaw_rad + d.azimuth_rad);
      const auto nearest = std::min_element(
          snapshot.actors.begin(), snapshot.actors.end(), [&](const auto& a, const auto& b) {
            return (a.motion.centre - p).norm() < (b.motion.centre - p).norm();
          });
      // Five sigma of range and azimuth.
      EXPECT_LT((nearest->motion.centre - p).norm(),
                5.0 * (front.range_sigma_m + d.range_m * front.azimuth_sigma_rad));
      EXPECT_EQ(++matched[nearest->actor->id], 1);
      ++total;
    }
  }
  EXPECT_GT(total, 1000u);
}

}  // namespace
}  // namespace v2vouch::sim
