// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/priority_perception.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdio>
#include <cstring>

#include "daemon/base/random.h"
#include "daemon/models/measurement_model.h"

namespace v2vouch {
namespace {

constexpr double kFrame_s = 0.05;
const Wgs84 kHome{FromDegrees(52.4), FromDegrees(13.05), 60.0};

struct Car {
  std::uint64_t local_id = 0;
  Eigen::Vector2d p = Eigen::Vector2d::Zero();
  double yaw_rad = 0.0;
  double speed_mps = 0.0;
  bool is_seen = true;
  bool is_coasting = false;  // LOCAL still has a track of it that nothing hits.
  bool is_part = false;      // No more than a part of it shows.
  // What a tracker would know of it.
  Timestamp start{};
  int radar_hits = 0;
  int camera_hits = 0;
  std::optional<Timestamp> last_radar{}, last_camera{};
};

// An ego that stands at the origin of L and O looking east, with made-up LOCAL tracks (truth plus
// 0.1 m of noise) and claims. Everything behind x = 15 m is hidden while `has_wall`.
class Scene {
 public:
  explicit Scene(std::uint64_t seed = 1, PriorityConfig config = {})
      : random(seed),
        perception(config, AlignmentConfig{}, vehicle),
        map(VisibilityConfig{}, vehicle) {
    for (int i = 0; i < 20; ++i) Fix();
  }

  void Fix(const Eigen::Vector2d& jump = Eigen::Vector2d::Zero()) {
    GnssFix fix;
    fix.stamp = now;
    fix.position = plane.ToGeodetic(
        LocalPoint{{vehicle.antenna_x_m + jump.x(), vehicle.antenna_y_m + jump.y(), 0.0}});
    fix.covariance_enu = Eigen::Vector3d(0.04, 0.04, 0.1).asDiagonal();
    fix.yaw_rad = 0.0;
    fix.yaw_sigma_rad = 0.003;
    fix.velocity_en_mps = Eigen::Vector2d::Zero();
    fix.velocity_sigma_mps = 0.05;
    fix.fix_type = FixType::k3d;
    EgoState at_fix = Ego();
    perception.OnFix(fix, at_fix, outputs);
    now += FromSeconds(0.001);
  }

  [[nodiscard]] EgoState Ego() const {
    EgoState ego;
    ego.stamp = now;
    return ego;
  }

  void Move(double dt_s) {
    for (Car& car : cars) {
      car.p += dt_s * car.speed_mps * Eigen::Vector2d(std::cos(car.yaw_rad), std::sin(car.yaw_rad));
    }
    now += FromSeconds(dt_s);
    ++frames;
  }

  void Frame() {
    LocalFrame frame;
    frame.stamp = now;
    frame.ego = Ego();
    frame.sectors = {{-kPi, 0.0, 200.0, SectorState::kWatched},
                     {0.0, kPi, 200.0, SectorState::kWatched}};
    std::vector<Occluder> occluders;
    if (has_wall) {
      occluders.push_back(
          {.id = 1, .centre_O = {15.0, 0.0}, .yaw_rad = 0.5 * kPi, .length_m = 120.0});
    }
    if (screen) occluders.push_back(*screen);
    for (Car& car : cars) {
      if (!car.is_seen && !car.is_coasting) continue;
      if (car.radar_hits == 0) car.start = now;
      if (car.is_seen) {
        ++car.radar_hits;
        car.last_radar = now;
        if (frames % 2 == 0) {
          ++car.camera_hits;
          car.last_camera = now;
        }
      }
      LocalTrack track;
      track.id = car.local_id;
      track.start = car.start;
      track.state_O.mean << car.p.x() + random.Normal(0.0, 0.1),
          car.p.y() + random.Normal(0.0, 0.1), car.yaw_rad + random.Normal(0.0, 0.01),
          car.speed_mps + random.Normal(0.0, 0.1), 0.0, 0.0;
      track.state_O.covariance = StateVector(0.02, 0.02, 2e-4, 0.02, 1e-3, 0.05).asDiagonal();
      track.extent = {4.5, 1.8, 0.1, 0.1};
      track.existence = 0.99;
      track.is_confirmed = car.radar_hits >= 2;
      track.last_radar = car.last_radar;
      track.last_camera = car.last_camera;
      track.radar_hits = car.radar_hits;
      track.camera_hits = car.camera_hits;
      frame.tracks.push_back(track);
      if (!car.is_seen) continue;
      frame.updates.push_back({car.local_id, Radar(car, track.extent)});
      occluders.push_back({.id = track.id,
                           .centre_O = track.state_O.mean.head<2>(),
                           .yaw_rad = car.yaw_rad,
                           .position_sigma_m = 0.14});
    }
    map.SetScene(frame.ego, occluders);
    perception.OnFrame(frame, map, outputs);
  }

  // What radar 0 would report of a car: h at the truth, plus noise.
  RadarMeasurement Radar(const Car& car, const Extent& extent) {
    RadarMeasurement measurement;
    measurement.visible_share = car.is_part ? 0.3 : 1.0;
    measurement.covariance = Eigen::Vector3d(0.04, 1e-4, 0.01).asDiagonal();
    StateVector x;
    x << car.p.x(), car.p.y(), car.yaw_rad, car.speed_mps, 0.0, 0.0;
    for (int pass = 0; pass < 2; ++pass) {  // The second with its own range as reference.
      const auto at_truth = LinearizeRadar(x, extent, Ego(), vehicle.radars[0], measurement);
      if (!at_truth) break;
      measurement.range_m -= at_truth->y[0];
      measurement.azimuth_rad -= at_truth->y[1];
      measurement.range_rate_mps -= at_truth->y[2];
      measurement.near_range_m = measurement.range_m;
    }
    measurement.ground_range_rate_mps = measurement.range_rate_mps;
    measurement.range_m += random.Normal(0.0, 0.2);
    measurement.azimuth_rad += random.Normal(0.0, 0.01);
    measurement.range_rate_mps += random.Normal(0.0, 0.1);
    return measurement;
  }

  void Say(SenderId sender, const Eigen::Vector2d& p, double yaw_rad, double speed_mps,
           double noise_m = 0.5, double height_m = 60.0,
           const std::optional<Finding>& finding = std::nullopt) {
    Claim claim;
    claim.finding = finding;
    claim.sender = sender;
    claim.received = now;
    claim.p_E = plane
                    .ToEcefPoint(LocalPoint{{p.x() + random.Normal(0.0, noise_m),
                                             p.y() + random.Normal(0.0, noise_m), 0.0}})
                    .p_E;
    claim.course_E =
        plane.R_LE().transpose() * Eigen::Vector3d(std::cos(yaw_rad), std::sin(yaw_rad), 0.0);
    claim.has_elevation = true;
    claim.height_m = height_m;
    claim.speed_mps = speed_mps;
    claim.position_sigma_m = std::max(0.5, noise_m);
    perception.OnClaim(claim, Ego(), outputs);
  }

  // Claims of car 0 with a bias, every other frame.
  void Honest(SenderId sender, const Eigen::Vector2d& bias = {1.0, -0.8}) {
    if (frames % 2 == 0) {
      Say(sender, cars[0].p + bias, cars[0].yaw_rad, cars[0].speed_mps);
    }
  }

  template <class Say>
  void Run(double for_s, Say say) {
    for (int i = 0; i < std::lround(for_s / kFrame_s); ++i) {
      Move(kFrame_s);
      if (frames % 4 == 0) Fix();
      Frame();
      say();
    }
  }

  [[nodiscard]] std::vector<PublishedTrack> Priority() const {
    TrackList list;
    perception.Publish(now, Ego(), list);
    return list.tracks;
  }

  VehicleConfig vehicle;
  LocalPlane plane{kHome};
  Timestamp now = FromMicros(1'700'000'000'000'000);
  int frames = 0;
  Random random;
  PriorityPerception perception;
  VisibilityMap map;
  Outputs outputs;
  std::vector<Car> cars;
  bool has_wall = false;
  std::optional<Occluder> screen;
};

Car OncomingCar(double x_m = 70.0) {
  return {.local_id = 7, .p = {x_m, 3.5}, .yaw_rad = kPi, .speed_mps = 5.0};
}

// A scene in which car 0 has been validated for `for_s`.
Scene Validated(std::uint64_t seed, double for_s = 6.0, double x_m = 70.0) {
  Scene scene(seed);
  scene.cars = {OncomingCar(x_m)};
  scene.Run(for_s, [&] { scene.Honest(1); });
  EXPECT_EQ(scene.Priority().size(), 1u) << "seed " << seed;
  return scene;
}

void Hide(Scene& scene) {
  scene.cars[0].is_seen = false;
  scene.has_wall = true;
}

double ErrorOf(const PublishedTrack& line, const Car& car) {
  return (line.track.state_O.mean.head<2>() - car.p).norm();
}

TEST(PriorityPerception, ValidatedVehicleIsAsGoodAsLocalWhileSeen) {
  Scene scene = Validated(1);
  double squared = 0.0;
  int count = 0;
  scene.Run(2.0, [&] {
    scene.Honest(1);
    const auto lines = scene.Priority();
    ASSERT_EQ(lines.size(), 1u);
    EXPECT_EQ(lines[0].local_id, 7u);
    EXPECT_EQ(lines[0].trust, TrustState::kValidated);
    EXPECT_EQ(lines[0].sender, 1u);
    EXPECT_TRUE(lines[0].position.has_value());
    squared += std::pow(ErrorOf(lines[0], scene.cars[0]), 2);
    ++count;
  });
  EXPECT_LT(std::sqrt(squared / count), 0.2);
  const auto bias = scene.perception.BiasOf(1);
  ASSERT_TRUE(bias.has_value());
  EXPECT_LT((bias->mean_en - Eigen::Vector2d(1.0, -0.8)).norm(), 0.6);
}

TEST(PriorityPerception, NothingIsPublishedBeforeTheRunOfAgreement) {
  Scene scene;
  scene.cars = {OncomingCar()};
  scene.Run(1.5, [&] {
    scene.Honest(1);
    EXPECT_TRUE(scene.Priority().empty());
  });
}

TEST(PriorityPerception, BridgesFourSecondsAndTakesTheVehicleBackUnderItsId) {
  double squared = 0.0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Scene scene = Validated(seed);
    const std::uint64_t id = scene.Priority()[0].track.id;
    Hide(scene);
    scene.Run(4.0, [&] {
      scene.Honest(1);
      const auto lines = scene.Priority();
      ASSERT_EQ(lines.size(), 1u) << "seed " << seed;
      EXPECT_EQ(lines[0].track.id, id);
      squared += std::pow(ErrorOf(lines[0], scene.cars[0]), 2);
      ++count;
    });
    EXPECT_EQ(scene.Priority()[0].trust, TrustState::kBridged);
    EXPECT_EQ(scene.Priority()[0].local_id, 0u);
    EXPECT_EQ(scene.Priority()[0].track.visibility, Visibility::kHidden);
    // Back in view as a new LOCAL track.
    scene.has_wall = false;
    scene.cars[0] = {.local_id = 8,
                     .p = scene.cars[0].p,
                     .yaw_rad = scene.cars[0].yaw_rad,
                     .speed_mps = scene.cars[0].speed_mps};
    scene.Run(1.0, [&] { scene.Honest(1); });
    const auto lines = scene.Priority();
    ASSERT_EQ(lines.size(), 1u) << "seed " << seed;
    EXPECT_EQ(lines[0].track.id, id);
    EXPECT_EQ(lines[0].local_id, 8u);
    EXPECT_EQ(lines[0].trust, TrustState::kValidated);
    EXPECT_TRUE(scene.outputs.reports.empty());
  }
  EXPECT_LT(std::sqrt(squared / count), 0.6);
}

TEST(PriorityPerception, GhostIsNeverPublished) {
  Random places(99);
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Scene scene(seed);
    scene.cars = {OncomingCar()};
    scene.has_wall = seed % 2 == 0;
    scene.cars[0].is_seen = !scene.has_wall;
    const bool rides_along = seed % 3 == 0;  // Beside the real car, 8 m off, same speed.
    Eigen::Vector2d ghost(places.Uniform(5.0, 120.0), places.Uniform(-40.0, 40.0));
    const double yaw_rad = places.Uniform(-kPi, kPi);
    const double speed_mps = places.Uniform(0.0, 15.0);
    scene.Run(8.0, [&] {
      const Car& car = scene.cars[0];
      ghost += kFrame_s * speed_mps * Eigen::Vector2d(std::cos(yaw_rad), std::sin(yaw_rad));
      if (rides_along) {
        scene.Say(66, car.p + Eigen::Vector2d(0.0, 8.0), car.yaw_rad, car.speed_mps, 0.1);
      } else if ((ghost - car.p).norm() > 7.0) {
        scene.Say(66, ghost, yaw_rad, speed_mps, 0.1);
      }
      EXPECT_TRUE(scene.Priority().empty()) << "seed " << seed;
    });
  }
}

// Two cars in a queue, 5.5 m from centre to centre; LOCAL has the first, the second talks.
TEST(PriorityPerception, StandingNeighbourIsNotTheCarInFront) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Scene scene(seed);
    scene.cars = {{.local_id = 7, .p = {40.0, 3.5}, .yaw_rad = 0.5 * kPi, .speed_mps = 0.0}};
    scene.Run(15.0, [&] {
      scene.Honest(1, {0.0, -5.5});
      EXPECT_TRUE(scene.Priority().empty()) << "seed " << seed;
    });
  }
}

// A claim 3 m behind a standing car may be that car's, or that of the next in the queue, where none
// can be seen. Where the place behind is in clear view and empty, or the claim is nearer, it is
// not.
TEST(PriorityPerception, WhoMayBeTheUnseenNextInTheQueueIsNotValidated) {
  struct Case {
    double behind_m;
    bool has_screen;
    bool is_validated;
  };
  for (const Case& now : {Case{3.0, true, false}, Case{3.0, false, true}, Case{1.0, true, true}}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      Scene scene(seed);
      scene.cars = {{.local_id = 7, .p = {40.0, 3.5}, .yaw_rad = 0.5 * kPi, .speed_mps = 0.0}};
      if (now.has_screen) {
        scene.screen = {.id = 1, .centre_O = {20.0, -2.5}, .yaw_rad = 0.5 * kPi, .length_m = 4.5};
      }
      scene.Run(6.0, [&] { scene.Honest(1, {0.0, -now.behind_m}); });
      EXPECT_EQ(scene.Priority().size() == 1u, now.is_validated)
          << now.behind_m << " m, screen " << now.has_screen << ", seed " << seed;
    }
  }
}

// A new LOCAL track, 6.5 m from the bridge but where the sensors alone may expect the hidden car: a
// few stray hits say nothing, a run says that the car is there.
TEST(PriorityPerception, StrayHitsElsewhereEndNoBridge) {
  for (const int hits : {3, 8}) {
    Scene scene = Validated(7);
    Hide(scene);
    scene.Run(2.5, [&] { scene.Honest(1); });
    scene.cars.push_back({.local_id = 8, .yaw_rad = kPi, .speed_mps = 5.0});
    for (int i = 0; i < 20; ++i) {
      scene.Move(kFrame_s);
      scene.cars[1].p = scene.cars[0].p + Eigen::Vector2d(-6.5, 0.0);
      scene.cars[1].is_seen = i < hits;
      scene.Frame();
      scene.Honest(1);
    }
    EXPECT_EQ(scene.Priority().size(), hits == 3 ? 1u : 0u) << hits;
    EXPECT_EQ(scene.outputs.reports.empty(), hits == 3);
    for (const auto& report : scene.outputs.reports) EXPECT_EQ(report.check, "seen_elsewhere");
  }
}

TEST(PriorityPerception, PlaceInClearViewThatIsEmptyEndsTheBridgeWithinASecond) {
  Scene scene = Validated(2);
  scene.cars[0].is_seen = false;  // Gone, and nothing hides the place.
  const Timestamp lost = scene.now;
  Timestamp ended{};
  scene.Run(3.0, [&] {
    scene.Honest(1);
    if (ended == Timestamp{} && scene.Priority().empty()) ended = scene.now;
  });
  ASSERT_NE(ended, Timestamp{});
  EXPECT_LT(ToSeconds(ended - lost), 1.4);  // 0.35 s of missing support and about a second.
  ASSERT_FALSE(scene.outputs.reports.empty());
  EXPECT_EQ(scene.outputs.reports[0].check, "empty_place");
  EXPECT_EQ(scene.outputs.reports[0].verdict, Verdict::kWithdraw);
  EXPECT_EQ(scene.perception.TrustOf(1), TrustState::kSuspect);
}

TEST(PriorityPerception, BudgetEndsTheBridgeWithoutBlame) {
  Scene scene = Validated(3, 4.5, 120.0);
  const double budget_s = scene.Priority()[0].bridge_budget_s;
  EXPECT_GE(budget_s, 4.5);
  EXPECT_LT(budget_s, 10.0);
  Hide(scene);
  const Timestamp lost = scene.now;
  Timestamp ended{};
  scene.Run(11.0, [&] {
    scene.Honest(1);
    if (ended == Timestamp{} && scene.Priority().empty()) ended = scene.now;
  });
  ASSERT_NE(ended, Timestamp{});
  // The claims round the last hit still count as co-observed.
  EXPECT_NEAR(ToSeconds(ended - lost), budget_s, 0.35);
  EXPECT_TRUE(scene.outputs.reports.empty());
  EXPECT_TRUE(scene.Priority().empty());
}

TEST(PriorityPerception, SilenceEndsTheBridgeAfterOneSecondAndTheSightAfterTwo) {
  Scene hidden = Validated(4);
  Hide(hidden);
  hidden.Run(0.9, [] {});
  EXPECT_EQ(hidden.Priority().size(), 1u);
  hidden.Run(0.3, [] {});
  EXPECT_TRUE(hidden.Priority().empty());

  Scene seen = Validated(4);
  const std::uint64_t id = seen.Priority()[0].track.id;
  seen.Run(1.8, [] {});
  EXPECT_EQ(seen.Priority().size(), 1u);
  seen.Run(0.4, [] {});
  EXPECT_TRUE(seen.Priority().empty());
  seen.Run(3.0, [&] { seen.Honest(1); });  // Speaks again: same LOCAL track, same id.
  ASSERT_EQ(seen.Priority().size(), 1u);
  EXPECT_EQ(seen.Priority()[0].track.id, id);
}

TEST(PriorityPerception, HijackerWhoWalksOffInViewIsWithdrawn) {
  for (const double lateral_mps : {1.0, 2.0, 5.0}) {
    Scene scene = Validated(5);
    const Timestamp left = scene.now;
    Eigen::Vector2d claimed = scene.cars[0].p + Eigen::Vector2d(1.0, -0.8);
    Timestamp ended{};
    double exposure_m = 0.0;
    scene.Run(6.0, [&] {
      claimed += kFrame_s * Eigen::Vector2d(-scene.cars[0].speed_mps, -lateral_mps);
      const double speed_mps = std::hypot(scene.cars[0].speed_mps, lateral_mps);
      const double yaw_rad = std::atan2(-lateral_mps, -scene.cars[0].speed_mps);
      if (scene.frames % 2 == 0) scene.Say(1, claimed, yaw_rad, speed_mps, 0.3);
      const auto lines = scene.Priority();
      if (lines.empty() && ended == Timestamp{}) ended = scene.now;
      for (const auto& line : lines) {
        exposure_m = std::max(exposure_m, ErrorOf(line, scene.cars[0]));
      }
    });
    ASSERT_NE(ended, Timestamp{}) << lateral_mps;
    // Below about 1.5 m/s the velocity is an honest receiver's, and the drift of 3 m must tell.
    EXPECT_LE(ToSeconds(ended - left), lateral_mps < 1.5 ? 4.5 : 2.5) << lateral_mps;
    EXPECT_LE(exposure_m, 1.0) << lateral_mps;
    ASSERT_FALSE(scene.outputs.reports.empty());
  }
}

TEST(PriorityPerception, TeleportInViewOrHiddenIsWithdrawn) {
  for (const bool is_hidden : {false, true}) {
    Scene scene = Validated(6);
    if (is_hidden) {
      Hide(scene);
      scene.Run(1.0, [&] { scene.Honest(1); });
    }
    scene.Run(1.0, [&] {
      if (scene.frames % 2 == 0) {
        scene.Say(1, scene.cars[0].p + Eigen::Vector2d(0.0, 30.0), kPi, 5.0);
      }
    });
    EXPECT_TRUE(scene.Priority().empty());
    EXPECT_EQ(scene.perception.TrustOf(1), TrustState::kSuspect);
  }
}

// A corner house that returns nothing to a side radar looks like free space to it.
TEST(PriorityPerception, AnEmptyPlaceIsBlamedOnlyWhereRadarAndCameraCouldHaveLooked) {
  for (const bool is_ahead : {false, true}) {
    Scene scene;
    const Eigen::Vector2d p = is_ahead ? Eigen::Vector2d(45.0, 0.0) : Eigen::Vector2d(31.0, -48.0);
    scene.Run(5.0, [&] {
      if (scene.frames % 2 == 0) scene.Say(1, p, 0.5 * kPi, 0.0, 0.1);
    });
    EXPECT_EQ(scene.perception.TrustOf(1) == TrustState::kSuspect, is_ahead);
  }
}

// What hides a vehicle is the likeliest to be taken for it.
TEST(PriorityPerception, AHiddenVehiclesLocalTrackThatGoesOverToItsNeighbourDragsNothing) {
  for (const double aside_m : {-3.5, 3.5}) {
    Scene scene = Validated(10);
    const std::uint64_t id = scene.Priority()[0].track.id;
    Hide(scene);
    scene.cars[0].is_coasting = true;
    scene.Run(0.6, [&] { scene.Honest(1); });
    scene.cars[0].is_coasting = false;
    Car neighbour = scene.cars[0];  // Goes on under the same LOCAL id.
    neighbour.p.y() += aside_m;
    neighbour.speed_mps -= 1.0;
    neighbour.is_seen = true;
    scene.cars.push_back(neighbour);
    scene.Run(3.0, [&] {
      scene.Honest(1);
      const auto lines = scene.Priority();
      ASSERT_EQ(lines.size(), 1u) << aside_m;
      EXPECT_EQ(lines[0].track.id, id);
      EXPECT_EQ(lines[0].local_id, 0u);
      EXPECT_LT(ErrorOf(lines[0], scene.cars[0]), 1.5) << aside_m;
    });
    EXPECT_TRUE(scene.outputs.reports.empty());
  }
}

TEST(PriorityPerception, ABridgeEndsWhereTheSensorsSeeAnotherVehicleOfTheList) {
  Scene scene = Validated(11);
  Car slow = OncomingCar();
  slow.local_id = 9;
  slow.p = scene.cars[0].p - Eigen::Vector2d(14.0, 0.0);
  slow.speed_mps = 2.0;
  scene.cars.push_back(slow);
  const auto both = [&] {
    scene.Honest(1);
    if (scene.frames % 2 == 1) scene.Say(2, scene.cars[1].p, kPi, 2.0);
  };
  scene.Run(3.0, both);
  ASSERT_EQ(scene.Priority().size(), 2u);
  Hide(scene);  // The first: what follows would drive through the second.
  scene.Run(3.0, [&] {
    both();
    const auto lines = scene.Priority();
    if (lines.size() < 2) return;
    const Eigen::Vector2d apart =
        (lines[0].track.state_O.mean - lines[1].track.state_O.mean).head<2>();
    EXPECT_GT(apart.norm(), 1.5);
  });
  ASSERT_EQ(scene.Priority().size(), 1u);
  EXPECT_EQ(scene.Priority()[0].sender, 2u);
  EXPECT_TRUE(scene.outputs.reports.empty());
}

TEST(PriorityPerception, ANeighbourInTheNextLaneDoesNotExplainABridgeInClearView) {
  Scene scene = Validated(13);
  Car neighbour = scene.cars[0];
  neighbour.local_id = 9;
  neighbour.p.y() += 2.9;
  scene.cars.push_back(neighbour);
  scene.cars[0].is_seen = false;  // Gone, in clear view.
  const Timestamp gone = scene.now;
  while (!scene.Priority().empty() && ToSeconds(scene.now - gone) < 5.0) {
    scene.Run(0.05, [&] { scene.Honest(1); });
  }
  EXPECT_LT(ToSeconds(scene.now - gone), 2.5);
}

// Sensors and sender have come apart by more than any bias, and no check was there to part them:
// hidden, the vehicle would be carried beside where its sender has it.
TEST(PriorityPerception, NothingIsBridgedOnABiasThatIsNone) {
  PriorityConfig config;
  config.trust.level_withdraw_m = config.trust.drift_withdraw_m = 50.0;
  config.trust.torn_m = config.trust.leaving_m = 20.0;
  for (const double apart_m : {3.0, 8.0}) {
    Scene scene(12, config);
    scene.cars = {OncomingCar(95.0)};
    scene.Run(3.0, [&] { scene.Honest(1, {0.0, 0.0}); });
    double left_m = 0.0;
    scene.Run(10.0, [&] {
      left_m = std::min(apart_m, left_m + 0.05);
      scene.Honest(1, {0.0, left_m});
    });
    ASSERT_EQ(scene.Priority().size(), 1u);
    Hide(scene);
    scene.Run(0.5, [&] { scene.Honest(1, {0.0, left_m}); });
    EXPECT_EQ(scene.Priority().size(), apart_m < 5.0 ? 1u : 0u);
    EXPECT_TRUE(scene.outputs.reports.empty());
  }
}

// A part of the vehicle has turned its LOCAL track; hits that come now and then leave it so. Until
// it has been seen whole for a while nobody is blamed for where it goes.
TEST(PriorityPerception, ATrackThatAPartHasTurnedBlamesNobodyWhileItCoasts) {
  Scene scene = Validated(21, 4.0);
  Car& track = scene.cars[0];
  Eigen::Vector2d p = track.p;
  const auto honest = [&] {
    p.x() -= 5.0 * kFrame_s;
    if (scene.frames % 2 == 0) scene.Say(1, p + Eigen::Vector2d(1.0, -0.8), kPi, 5.0);
  };
  track.yaw_rad += 0.9;  // It moves 3.9 m/s across.
  track.is_part = true;
  scene.Run(0.35, honest);
  track.is_part = false;
  track.is_coasting = true;
  scene.Run(1.0, [&] {
    honest();
    track.is_seen = scene.frames % 6 == 0;
  });
  EXPECT_GT((track.p - p).norm(), 5.0);
  EXPECT_TRUE(scene.outputs.reports.empty());
}

// A hidden sender, and a car without radio that passes it in the next lane.
TEST(PriorityPerception, WhoPassesAHiddenSenderIsNotTheSender) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Scene scene(seed);
    scene.cars = {{.local_id = 7, .p = {35.0, 2.0}, .speed_mps = 12.0, .is_part = true}};
    Eigen::Vector2d hidden(37.0, -0.8);
    scene.Run(3.0, [&] {
      hidden.x() += 10.0 * kFrame_s;
      if (scene.frames % 2 == 0) scene.Say(1, hidden, 0.0, 10.0);
      EXPECT_TRUE(scene.Priority().empty()) << "seed " << seed;
    });
  }
}

TEST(PriorityPerception, ABridgeEndsFarFromTheEgo) {
  PriorityConfig config;
  config.bridge.max_distance_m = 35.0;
  Scene scene(12, config);
  scene.cars = {OncomingCar()};
  scene.Run(6.0, [&] { scene.Honest(1); });  // Seen at 40 m: nothing ends.
  ASSERT_EQ(scene.Priority().size(), 1u);
  Hide(scene);
  scene.Run(0.6, [&] { scene.Honest(1); });
  EXPECT_TRUE(scene.Priority().empty());
  EXPECT_TRUE(scene.outputs.reports.empty());
}

// Whose of them the car is, nobody knows.
TEST(PriorityPerception, SeveralIdsThatClaimOneCarFromTheFirstAreAllWithdrawnNotAccused) {
  Scene scene;
  scene.cars = {OncomingCar()};
  scene.Run(5.0, [&] {
    for (const SenderId sender : {1u, 2u, 3u}) {
      if (scene.frames % 2 == 0) scene.Say(sender, scene.cars[0].p, kPi, 5.0, 0.3);
    }
    EXPECT_LE(scene.Priority().size(), 1u);
  });
  EXPECT_TRUE(scene.Priority().empty());
  for (const SenderId sender : {1u, 2u, 3u}) {
    EXPECT_EQ(scene.perception.TrustOf(sender), TrustState::kSuspect) << sender;
  }
}

// The message stream then jumps with every message of either; who of them lies is seen by the
// sensors alone.
TEST(PriorityPerception, ImpersonatedVehicleGoesOnWhileItIsSeen) {
  for (const char* check : {"position_jump", "two_places", "own_motion"}) {
    Scene scene = Validated(7);
    const Finding jump{check, Verdict::kWithdraw, "displacement_m", 12.0, 3.0};
    scene.Run(4.0, [&] {
      const Car& car = scene.cars[0];
      if (scene.frames % 2 == 0) {
        scene.Say(1, car.p + Eigen::Vector2d(1.0, -0.8), kPi, 5.0, 0.5, 60.0, jump);
      } else if (scene.frames % 4 == 1) {
        scene.Say(1, car.p + Eigen::Vector2d(0.0, -12.0), kPi, 5.0, 0.3, 60.0, jump);
      }
      ASSERT_EQ(scene.Priority().size(), 1u) << check;
      EXPECT_LT(ErrorOf(scene.Priority()[0], car), 1.0) << check;
    });
    EXPECT_TRUE(scene.outputs.reports.empty()) << check;
  }
}

TEST(PriorityPerception, HonestIdentityChangeKeepsTheVehicleSeenOrHidden) {
  for (const bool is_hidden : {false, true}) {
    Scene scene = Validated(7);
    const std::uint64_t id = scene.Priority()[0].track.id;
    if (is_hidden) {
      Hide(scene);
      scene.Run(1.0, [&] { scene.Honest(1); });
    }
    const double budget_s = scene.Priority()[0].bridge_budget_s;
    scene.Run(0.2, [] {});  // The change of pseudonym itself.
    scene.Run(2.0, [&] {
      scene.Honest(2);
      ASSERT_EQ(scene.Priority().size(), 1u) << is_hidden;
      EXPECT_EQ(scene.Priority()[0].track.id, id);
    });
    EXPECT_EQ(scene.Priority()[0].sender, 2u);
    if (is_hidden) {
      EXPECT_NEAR(scene.Priority()[0].bridge_budget_s, budget_s - 2.2, 0.1);
    }
    EXPECT_TRUE(scene.outputs.reports.empty());
  }
}

TEST(PriorityPerception, OldIdThatSpeaksAgainTakesItsVehicleBack) {
  Scene scene = Validated(8);
  scene.Run(0.3, [] {});
  scene.Run(0.6, [&] { scene.Honest(2); });
  ASSERT_EQ(scene.Priority().size(), 1u);
  ASSERT_EQ(scene.Priority()[0].sender, 2u);
  scene.Run(0.2, [&] { scene.Honest(1); });
  ASSERT_EQ(scene.Priority().size(), 1u);
  EXPECT_EQ(scene.Priority()[0].sender, 1u);
  EXPECT_EQ(scene.perception.TrustOf(2), TrustState::kSuspect);
}

TEST(PriorityPerception, SecondIdOnTheSameCarNeverGetsIn) {
  Scene scene = Validated(9);
  scene.Run(5.0, [&] {
    scene.Honest(1);
    scene.Honest(2, {0.1, 0.0});
    ASSERT_EQ(scene.Priority().size(), 1u);
    EXPECT_EQ(scene.Priority()[0].sender, 1u);
  });
}

TEST(PriorityPerception, CarOnTheBridgeAboveIsNotTheCarBelow) {
  Scene scene;
  scene.cars = {OncomingCar()};
  scene.Run(5.0, [&] {
    scene.Say(1, scene.cars[0].p, kPi, 5.0, 0.3, 66.0);
    EXPECT_TRUE(scene.Priority().empty());
  });
}

TEST(PriorityPerception, NobodyIsValidatedWhileTheEgosPlaceIsInDoubt) {
  Scene scene;
  scene.cars = {OncomingCar()};
  scene.Run(0.5, [] {});
  for (int i = 0; i < 5; ++i) scene.Fix({50.0, 0.0});
  ASSERT_TRUE(scene.perception.alignment().is_suspect());
  scene.Run(4.0, [&] {
    scene.Honest(1);
    scene.Fix({50.0, 0.0});
    EXPECT_TRUE(scene.Priority().empty());
  });
}

TEST(PriorityPerception, EgoJumpMovesNoValidatedVehicle) {
  Scene scene = Validated(10);
  const std::uint64_t id = scene.Priority()[0].track.id;
  Hide(scene);
  for (int i = 0; i < 40; ++i) {
    scene.Move(kFrame_s);
    scene.Fix({50.0, 0.0});
    scene.Frame();
    scene.Honest(1);
    ASSERT_EQ(scene.Priority().size(), 1u);
    EXPECT_EQ(scene.Priority()[0].track.id, id);
    EXPECT_LT(ErrorOf(scene.Priority()[0], scene.cars[0]), 1.0);
  }
}

TEST(PriorityPerception, PaperModePublishesEveryPairAtOnce) {
  PriorityConfig config;
  config.association = AssociationMode::kPaper;
  Scene scene(11, config);
  scene.cars = {OncomingCar()};
  scene.Run(0.3, [&] {
    scene.Honest(1);
    scene.Honest(2, {-1.0, 0.0});
  });
  EXPECT_EQ(scene.Priority().size(), 2u);
  scene.cars[0].is_seen = false;  // In clear view: the paper's method does not look.
  scene.Run(5.0, [&] { scene.Honest(1); });
  EXPECT_EQ(scene.Priority().size(), 1u);
}

TEST(PriorityPerception, CopyIsACheckpoint) {
  Scene scene = Validated(12);
  Scene branch = scene;
  const auto go_on = [](Scene& s) {
    Hide(s);
    s.Run(2.0, [&] { s.Honest(1); });
    return s.Priority();
  };
  const auto a = go_on(scene);
  const auto b = go_on(branch);
  ASSERT_EQ(a.size(), 1u);
  ASSERT_EQ(b.size(), 1u);
  EXPECT_EQ(std::memcmp(a[0].track.state_O.mean.data(), b[0].track.state_O.mean.data(),
                        sizeof(StateVector)),
            0);
  EXPECT_EQ(std::memcmp(a[0].track.state_O.covariance.data(), b[0].track.state_O.covariance.data(),
                        sizeof(StateMatrix)),
            0);
  EXPECT_EQ(a[0].track.id, b[0].track.id);
}

TEST(PriorityPerception, CheckpointStaysSmall) {
  Scene scene;
  for (std::uint64_t i = 0; i < 50; ++i) {
    Car car = OncomingCar();
    car.local_id = 100 + i;
    car.p = {30.0 + 12.0 * static_cast<double>(i % 10), -30.0 + 12.0 * static_cast<double>(i / 10)};
    scene.cars.push_back(car);
  }
  scene.Run(4.0, [&] {
    if (scene.frames % 2 != 0) return;
    for (std::size_t i = 0; i < scene.cars.size(); ++i) {
      scene.Say(static_cast<SenderId>(1 + i), scene.cars[i].p, kPi, 5.0);
    }
  });
  const std::size_t bytes = scene.perception.checkpoint_bytes();
  std::printf("%zu vehicles, checkpoint %zu bytes\n", scene.perception.vehicle_count(), bytes);
  EXPECT_GE(scene.perception.vehicle_count(), 20u);
  EXPECT_LT(bytes, 400'000u);
}

TEST(PriorityPerception, ResidualsForTheBiasEstimateAreRaw) {
  Scene scene = Validated(13);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int count = 0;
  scene.Run(3.0, [&] {
    scene.perception.TakeResiduals();
    scene.Honest(1);
    for (const BiasResidual& residual : scene.perception.TakeResiduals()) {
      sum += residual.claimed_minus_sensed_en;
      ++count;
    }
  });
  EXPECT_EQ(count, 30);
  EXPECT_LT((sum / count - Eigen::Vector2d(1.0, -0.8)).norm(), 0.4);
}

}  // namespace
}  // namespace v2vouch
