// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "daemon/rim/config/yaml_reader.h"
#include "sim/sensors/camera.h"
#include "sim/sensors/radar.h"
#include "sim/world/draw_sensors.h"
#include "tests/sim/sensors/scene.h"

namespace v2vouch::sim {
namespace {

constexpr double kAhead_m = 25.0;

Scenario Scene(SensorMode mode) {
  Scenario scenario = StandingEgo();
  scenario.sensors.mode = mode;
  return scenario;
}

/// Reflections of radar 0 over `scans` scans, 50 ms apart, in the world.
struct Return {
  int scan;
  Vec2 place;
  double snr_db;
  double rate_mps;
  int track_id;
};

std::vector<Return> Returns(const World& world, int scans, std::uint64_t seed = 7) {
  RadarSimulator radar(world, 0, seed);
  const RadarConfig& config = world.vehicle().radars[0];
  radar_scan_t scan{};
  std::vector<Return> returns;
  for (int k = 0; k < scans; ++k) {
    radar.Scan(world.At(0.05 * k), k, scan);
    for (const radar_detection_t& d : scan.detections) {
      returns.push_back(
          {k, Vec2(config.x_m, config.y_m) + d.range_m * Direction(config.yaw_rad + d.azimuth_rad),
           d.snr_db, d.range_rate_mps, d.track_id});
    }
  }
  return returns;
}

/// Those near the vehicle's box, as metres behind its rear face.
std::vector<double> Depths(const std::vector<Return>& returns, double reach_m = 4.5) {
  std::vector<double> depths;
  for (const Return& r : returns) {
    const double depth = r.place.x() - (kAhead_m - 2.25);
    if (std::abs(r.place.y()) < 1.5 && depth > -1.0 && depth < reach_m) depths.push_back(depth);
  }
  return depths;
}

double ShareOf(const std::vector<double>& values, auto&& is_such) {
  const auto count = std::ranges::count_if(values, is_such);
  return static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(1, values.size()));
}

std::unique_ptr<World> OneCar(SensorMode mode, std::uint64_t seed) {
  Scenario scenario = Scene(mode);
  AddVehicle(scenario, 1, kAhead_m, 0.0, 0.0);
  return MakeWorld(scenario, seed);
}

TEST(DrawSensors, LeavesTheDefaultAloneAndItsTextTheSame) {
  Scenario scenario = StandingEgo();
  const std::string before = ToYaml(scenario);
  DrawSensors(5, scenario);
  EXPECT_EQ(ToYaml(scenario), before);
  EXPECT_THAT(before, testing::Not(testing::HasSubstr("family")));
}

TEST(DrawSensors, DrawsTheSameForTheSameSeedAndAnewForAnother) {
  for (const SensorMode mode : {SensorMode::kBumper, SensorMode::kRandom}) {
    std::set<std::string> draws;
    for (const std::uint64_t seed : {1, 1, 2, 3}) {
      Scenario scenario = Scene(mode);
      DrawSensors(seed, scenario);
      draws.insert(ToYaml(scenario));
    }
    EXPECT_EQ(draws.size(), 3u);
  }
}

TEST(DrawSensors, SetUpsHaveTheSensorsOfTheirName) {
  for (std::uint64_t seed = 1; seed < 9; ++seed) {
    EXPECT_EQ(OneCar(SensorMode::kOneRadar, seed)->vehicle().radars.size(), 1u);
    EXPECT_TRUE(OneCar(SensorMode::kNoCamera, seed)->vehicle().cameras.empty());
    EXPECT_GT(OneCar(SensorMode::kNarrowCamera, seed)->vehicle().cameras[0].fx_px, 2000.0);
    EXPECT_EQ(OneCar(SensorMode::kObjects, seed)->vehicle().radars[0].output,
              RadarOutput::kObjects);
    for (const RadarConfig& radar : OneCar(SensorMode::kBumper, seed)->vehicle().radars) {
      EXPECT_GE(radar.period_s, 0.04);
      EXPECT_LE(radar.period_s, 0.1);
    }
  }
}

TEST(DrawSensors, EveryFamilyCanBeNamedAndReadsBackAsDrawn) {
  EXPECT_EQ(DrawnFamilies().size(), 14u);
  for (const std::string& name : DrawnFamilies()) {
    Scenario scenario = StandingEgo();
    std::vector<std::string> problems;
    config::Parse("sensors: {mode: " + name + "}", "test", scenario, problems);
    DrawSensors(3, scenario);
    ASSERT_TRUE(scenario.family.has_value()) << name;
    Scenario again;
    config::Parse(ToYaml(scenario), "test", again, problems);
    EXPECT_EQ(ToYaml(again), ToYaml(scenario)) << name;
    EXPECT_THAT(problems, testing::IsEmpty()) << name;
  }
}

// The law measured in an independent simulator (178 000 returns): the strongest return of a scan is
// 0.15 m deep on average, three quarters of the others lie 0.5 to 3 m behind the face.
TEST(RadarFamily, ABumperIsStrongAndWhatIsBehindItWeak) {
  double strongest = 0.0, others = 0.0, deep = 0.0;
  int scans = 0, count = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto world = OneCar(SensorMode::kBumper, seed);
    std::vector<Return> returns = Returns(*world, 40, seed);
    std::erase_if(returns, [](const Return& r) {
      return std::abs(r.place.y()) > 1.5 || std::abs(r.place.x() - kAhead_m) > 3.0;
    });
    for (int k = 0; k < 40; ++k) {
      const Return* best = nullptr;
      for (const Return& r : returns) {
        if (r.scan == k && (best == nullptr || r.snr_db > best->snr_db)) best = &r;
      }
      if (best == nullptr) continue;
      ++scans;
      strongest += best->place.x() - (kAhead_m - 2.25);
      for (const Return& r : returns) {
        if (r.scan != k || &r == best) continue;
        ++count;
        others += r.place.x() - (kAhead_m - 2.25);
        if (r.snr_db < best->snr_db - 10.0 && r.place.x() > kAhead_m - 1.75) deep += 1.0;
      }
    }
  }
  EXPECT_GT(scans, 380);
  EXPECT_NEAR(strongest / scans, 0.15, 0.2);
  EXPECT_NEAR(others / count, 1.3, 0.5);
  EXPECT_GT(deep / count, 0.4);
  EXPECT_NEAR(1.0 + static_cast<double>(count) / scans, 4.0, 2.0);
}

TEST(RadarFamily, SparseRadarsGiveOneOrTwoReturnsForACar) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Scenario scenario = Scene(SensorMode::kSparse);
    AddVehicle(scenario, 1, kAhead_m, 0.0, 0.0);
    const auto world = MakeWorld(scenario, seed);
    std::vector<int> per_scan(40, 0);
    for (const Return& r : Returns(*world, 40)) {
      if (std::abs(r.place.y()) < 1.2 && std::abs(r.place.x() - kAhead_m) < 3.0) {
        ++per_scan[static_cast<std::size_t>(r.scan)];
      }
    }
    EXPECT_LE(std::ranges::count_if(per_scan, [](int n) { return n > 3; }), 2) << seed;
    EXPECT_GT(std::ranges::count_if(per_scan, [](int n) { return n > 0; }), 20) << seed;
  }
}

TEST(RadarFamily, WideCellsMergeNeighbours) {
  const auto count = [](SensorMode mode) {
    std::size_t total = 0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      Scenario scenario = Scene(mode);
      AddVehicle(scenario, 1, 50.0, 1.6, 0.0);
      AddVehicle(scenario, 2, 50.0, -1.6, 0.0);
      for (const Return& r : Returns(*MakeWorld(scenario, seed), 40)) {
        if (std::abs(r.place.y()) < 4.0 && std::abs(r.place.x() - 50.0) < 3.0) ++total;
      }
    }
    return static_cast<double>(total);
  };
  EXPECT_LT(count(SensorMode::kMerged), 0.7 * count(SensorMode::kCorners));
}

TEST(RadarFamily, InsideReturnsAreAsCommonAsTheFaceAndHaveNoStrength) {
  const auto world = OneCar(SensorMode::kInside, 3);
  const std::vector<Return> returns = Returns(*world, 60);
  for (const Return& r : returns) EXPECT_TRUE(std::isnan(r.snr_db));
  EXPECT_GT(ShareOf(Depths(returns), [](double depth) { return depth > 0.8; }), 0.5);
}

TEST(RadarFamily, FewFaceReturnsLieOnTheFace) {
  double few = 0.0, bumper = 0.0;
  const auto is_face = [](double depth) { return depth < 0.5; };
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    few += ShareOf(Depths(Returns(*OneCar(SensorMode::kFewFace, seed), 40)), is_face) / 6.0;
    bumper += ShareOf(Depths(Returns(*OneCar(SensorMode::kBumper, seed), 40)), is_face) / 6.0;
  }
  EXPECT_LT(few, 0.6 * bumper);
}

TEST(RadarFamily, AnObjectsReferencePointJumpsWithinItsBox) {
  const auto world = OneCar(SensorMode::kObjects, 2);
  double least = 1e9, most = -1e9;
  std::set<int> ids;
  for (const Return& r : Returns(*world, 600)) {
    EXPECT_GE(r.track_id, 0);
    if (std::abs(r.place.y()) > 1.8 || std::abs(r.place.x() - kAhead_m) > 3.2) continue;
    least = std::min(least, r.place.x());
    most = std::max(most, r.place.x());
    ids.insert(r.track_id);
  }
  EXPECT_GT(most - least, 3.0);
  EXPECT_GT(ids.size(), 1u);
}

TEST(RadarFamily, MultipathPutsReturnsBehindTheCar) {
  const auto behind = [](SensorMode mode) {
    double share = 0.0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const std::vector<double> depths = Depths(Returns(*OneCar(mode, seed), 60), 9.0);
      share += ShareOf(depths, [](double depth) { return depth > 5.0; }) / 5.0;
    }
    return share;
  };
  EXPECT_GT(behind(SensorMode::kMultipath), 2.0 * behind(SensorMode::kBumper));
}

TEST(RadarFamily, RainIsClutterCloseBy) {
  const auto close = [](SensorMode mode) {
    std::size_t count = 0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      for (const Return& r : Returns(*MakeWorld(Scene(mode), seed), 40)) {
        if (r.place.norm() < 30.0) ++count;
      }
    }
    return count;
  };
  EXPECT_GT(close(SensorMode::kRain), 3 * close(SensorMode::kBumper));
}

TEST(CameraFamily, ReadsAClassWronglyForSpells) {
  Scenario scenario = Scene(SensorMode::kBoxes);
  AddVehicle(scenario, 1, kAhead_m, 0.0, 0.0);
  const auto world = MakeWorld(scenario, 4);
  CameraSimulator camera(*world, 0, 4);
  camera_detections_t picture{};
  std::vector<std::string> names;
  for (int k = 0; k < 600; ++k) {
    camera.Shoot(world->At(0.05 * k), k, picture);
    for (const camera_box_t& box : picture.boxes) {
      if (std::abs(box.left_px + 0.5 * box.width_px - 640.0) < 40.0)
        names.push_back(box.class_name);
    }
  }
  const auto wrong = std::ranges::count_if(names, [](const auto& name) { return name != "car"; });
  int changes = 0;
  for (std::size_t k = 1; k < names.size(); ++k) changes += names[k] != names[k - 1] ? 1 : 0;
  EXPECT_GT(wrong, 20);
  EXPECT_LT(changes, static_cast<int>(wrong));
}

TEST(CameraFamily, FalseBoxesLiveOnFromPictureToPicture) {
  const auto world = MakeWorld(Scene(SensorMode::kBoxes), 4);
  CameraSimulator camera(*world, 0, 4);
  camera_detections_t picture{};
  int boxes = 0, begun = 0;
  std::int32_t last = 0;
  for (int k = 0; k < 1200; ++k) {
    camera.Shoot(world->At(0.05 * k), k, picture);
    boxes += picture.num_boxes;
    begun += std::max(0, picture.num_boxes - last);
    last = picture.num_boxes;
  }
  EXPECT_GT(begun, 3);
  EXPECT_GT(boxes, 8 * begun);
}

TEST(CameraFamily, BrakingMovesThePictureUp) {
  Scenario scenario = Scene(SensorMode::kCustom);
  FamilySpec& family = scenario.family.emplace();
  family.camera = {};
  family.camera.edge_white_px = family.camera.edge_markov_px = 0.0;
  family.camera.edge_markov_share = 0.0;
  family.camera.pitch_rad = 0.0;
  family.camera.misses_per_s = family.camera.false_per_s = family.camera.duplicate_share = 0.0;
  AddVehicle(scenario, 1, kAhead_m, 0.0, 0.0);
  const auto world = MakeWorld(scenario);
  const auto bottom = [&](double accel_mps2) {
    CameraSimulator camera(*world, 0, 4);
    Snapshot snapshot = world->At(1.0);
    snapshot.ego.accel_mps2 = accel_mps2;
    camera_detections_t picture{};
    for (int k = 0; picture.boxes.empty(); ++k) camera.Shoot(snapshot, k, picture);
    return picture.boxes[0].top_px + picture.boxes[0].height_px;
  };
  const double fx = world->vehicle().cameras[0].fx_px;
  EXPECT_NEAR(bottom(0.0) - bottom(-4.0), fx * std::tan(4.0 * family.camera.dive_rad), 1.0);
}

}  // namespace
}  // namespace v2vouch::sim
