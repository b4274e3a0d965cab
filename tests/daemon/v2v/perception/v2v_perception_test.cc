// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <cstring>

#include "tests/daemon/v2v/perception/priority_scene.h"

namespace v2vouch {
namespace {

TEST(V2vPerception, ValidatedVehicleIsAsGoodAsLocalWhileSeen) {
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

TEST(V2vPerception, HijackerWhoWalksOffInViewIsWithdrawn) {
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

TEST(V2vPerception, TeleportInViewOrHiddenIsWithdrawn) {
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
TEST(V2vPerception, AnEmptyPlaceIsBlamedOnlyWhereRadarAndCameraCouldHaveLooked) {
  for (const bool is_ahead : {false, true}) {
    Scene scene;
    const Eigen::Vector2d p = is_ahead ? Eigen::Vector2d(45.0, 0.0) : Eigen::Vector2d(31.0, -48.0);
    scene.Run(5.0, [&] {
      if (scene.frames % 2 == 0) scene.Say(1, p, 0.5 * kPi, 0.0, 0.1);
    });
    EXPECT_EQ(scene.perception.TrustOf(1) == TrustState::kSuspect, is_ahead);
  }
}

// A part of the vehicle has turned its LOCAL track; hits that come now and then leave it so. Until
// it has been seen whole for a while nobody is blamed for where it goes.
TEST(V2vPerception, ATrackThatAPartHasTurnedBlamesNobodyWhileItCoasts) {
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

// It says that it stands, from one message to the next. That the sensors have but a part of the car
// that drives on excuses a LOCAL track that strays, not a sender that stops as no car can.
TEST(V2vPerception, WhoStopsAsNoCarCanIsBlamedBesideATrackInDoubt) {
  Scene scene = Validated(5);
  scene.cars[0].is_part = true;
  const Eigen::Vector2d frozen = scene.cars[0].p;
  scene.Run(3.0, [&] {
    if (scene.frames % 2 == 0) scene.Say(1, frozen, scene.cars[0].yaw_rad, 0.0);
  });
  EXPECT_TRUE(scene.Priority().empty());
  ASSERT_FALSE(scene.outputs.reports.empty());
  EXPECT_EQ(scene.outputs.reports[0].verdict, Verdict::kWithdraw);
  EXPECT_GT(scene.outputs.reports[0].evidence[0].value, scene.outputs.reports[0].evidence[1].value);
  EXPECT_EQ(scene.perception.TrustOf(1), TrustState::kSuspect);
}

TEST(V2vPerception, EgoJumpMovesNoValidatedVehicle) {
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

TEST(V2vPerception, PaperModePublishesEveryPairAtOnce) {
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

TEST(V2vPerception, CopyIsACheckpoint) {
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

TEST(V2vPerception, CheckpointStaysSmall) {
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

TEST(V2vPerception, ResidualsForTheBiasEstimateAreRaw) {
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
