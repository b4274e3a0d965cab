// SPDX-License-Identifier: Apache-2.0
// Boxes of a configured source of objects, alone and beside radar.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "daemon/common/base/angle.h"
#include "daemon/local/tracking/tracker.h"

namespace v2vouch {
namespace {

constexpr double kPeriod_s = 0.1;

struct Stand {
  explicit Stand(int sources = 2) {
    vehicle.objects.assign(static_cast<std::size_t>(sources), ObjectSensorConfig{});
    tracker = Tracker(TrackerConfig{}, vehicle);
    ego.stamp = FromMicros(1'700'000'000'000'000);
  }
  BoxMeasurement At(double x_m, double y_m, double speed_mps = kNaN) const {
    BoxMeasurement z{.x_m = x_m, .y_m = y_m, .score = 0.9, .object_class = ObjectClass::kCar};
    z.position_covariance = 0.04 * Eigen::Matrix2d::Identity();
    if (!std::isnan(speed_mps)) z.velocity_O_mps = Eigen::Vector2d(speed_mps, 0.0);
    z.velocity_covariance = 0.09 * Eigen::Matrix2d::Identity();
    return z;
  }
  void Advance() {
    ego.stamp += FromSeconds(kPeriod_s);
    tracker.Predict(ego.stamp);
  }
  void Boxes(const std::vector<BoxMeasurement>& boxes, int source = 0, double probability = 0.9) {
    tracker.UpdateObjects(source, ego, boxes, [&](const LocalTrack&) {
      return Detectability{probability,
                           probability > 0.0 ? Visibility::kVisible : Visibility::kOutOfView};
    });
  }
  std::vector<LocalTrack> Confirmed() const {
    std::vector<LocalTrack> out;
    for (const LocalTrack& track : tracker.tracks()) {
      if (track.is_confirmed) out.push_back(track);
    }
    return out;
  }

  VehicleConfig vehicle;
  Tracker tracker{TrackerConfig{}, VehicleConfig{}};
  EgoState ego;
};

TEST(ObjectTracking, BoxesAloneStartConfirmAndNameATrack) {
  Stand stand;
  for (int k = 0; k < 10; ++k) {
    stand.Advance();
    stand.Boxes({stand.At(20.0 + k, 3.0)});
    if (k == 0) {
      EXPECT_TRUE(stand.Confirmed().empty()) << "one box may be false";
    }
  }
  const auto tracks = stand.Confirmed();
  ASSERT_EQ(tracks.size(), 1U);
  EXPECT_EQ(tracks[0].object_class, ObjectClass::kCar);
  EXPECT_NEAR(tracks[0].state_O.mean[kSpeed], 10.0, 0.5);
  EXPECT_EQ(tracks[0].object_hits(), 10);
  ASSERT_EQ(stand.tracker.updates().size(), 1U) << "PRIORITY is given the measurement, too";
  EXPECT_TRUE(std::holds_alternative<BoxMeasurement>(stand.tracker.updates()[0].measurement));
}

TEST(ObjectTracking, AToldVelocityIsUsedFromTheFirstBoxOn) {
  Stand stand;
  stand.Advance();
  stand.Boxes({stand.At(20.0, 3.0, -15.0)});  // Its axis is told the other way round.
  const KinematicState& state = stand.tracker.tracks()[0].state_O;
  EXPECT_NEAR(state.velocity().x(), -15.0, 1e-9);
  EXPECT_NEAR(std::abs(state.mean[kYaw]), kPi, 1e-9) << "motion tells front from rear";
  EXPECT_NEAR(std::sqrt(state.covariance(kSpeed, kSpeed)), 0.3, 1e-6);
}

TEST(ObjectTracking, AVelocityThatCannotBeTeachesNothing) {
  Stand stand;
  for (int k = 0; k < 10; ++k) {
    stand.Advance();
    stand.Boxes({stand.At(20.0 + k, 3.0, k == 8 ? 60.0 : 10.0)});
  }
  ASSERT_EQ(stand.Confirmed().size(), 1U);
  EXPECT_NEAR(stand.Confirmed()[0].state_O.mean[kSpeed], 10.0, 0.3);
}

TEST(ObjectTracking, AbsenceWhereTheSourceSeesEndsATrackAndElsewhereSaysNothing) {
  Stand seen, unseen;
  for (Stand* stand : {&seen, &unseen}) {
    for (int k = 0; k < 10; ++k) {
      stand->Advance();
      stand->Boxes({stand->At(20.0, 3.0)});
    }
  }
  for (int k = 0; k < 10; ++k) {
    seen.Advance();
    seen.Boxes({});
    unseen.Advance();
    unseen.Boxes({}, 0, 0.0);
  }
  EXPECT_TRUE(seen.Confirmed().empty());
  EXPECT_EQ(unseen.Confirmed().size(), 1U);
}

// False boxes here and there, two in a hundred square metres: none lasts.
TEST(ObjectTracking, ScatteredFalseBoxesAreNeverPublished) {
  Stand stand;
  for (int k = 0; k < 200; ++k) {
    stand.Advance();
    stand.Boxes({stand.At(std::fmod(17.3 * k, 70.0), std::fmod(29.1 * k, 40.0) - 20.0)});
    EXPECT_TRUE(stand.Confirmed().empty()) << k;
  }
}

// Two sources with one stamp are two frames: each has the car once.
TEST(ObjectTracking, TwoSourcesOfOneStampDoNotMakeTwoVehicles) {
  Stand stand;
  for (int k = 0; k < 10; ++k) {
    stand.Advance();
    stand.Boxes({stand.At(20.0 + k, 3.0)}, 0);
    stand.Boxes({stand.At(20.2 + k, 3.1)}, 1);
  }
  ASSERT_EQ(stand.Confirmed().size(), 1U);
  EXPECT_EQ(stand.Confirmed()[0].support.sources().size(), 2U);
  Stand pair;
  for (int k = 0; k < 10; ++k) {
    pair.Advance();
    pair.Boxes({pair.At(20.0 + k, 3.0), pair.At(20.0 + k, 4.4)});
  }
  EXPECT_EQ(pair.Confirmed().size(), 2U) << "one frame has shown both";
}

// A standing return keeps what a box named alive, and starts nothing itself.
TEST(ObjectTracking, StandingReturnsSupportWhatABoxHasNamed) {
  Stand stand;
  for (int k = 0; k < 10; ++k) {
    stand.Advance();
    stand.Boxes({stand.At(20.0, 0.0)});
  }
  RadarMeasurement z{.returns = 3, .range_m = 20.0 - 3.75 - 2.0, .is_static = true};
  z.covariance = Eigen::Vector3d(0.06, 3e-5, 0.01).asDiagonal();
  for (int k = 0; k < 20; ++k) {
    stand.Advance();
    stand.tracker.UpdateRadar(0, stand.ego, std::vector{z}, [](const LocalTrack&) {
      return Detectability{0.9, Visibility::kVisible};
    });
  }
  ASSERT_EQ(stand.Confirmed().size(), 1U);
  EXPECT_GT(stand.Confirmed()[0].radar_hits(), 15);
}

TEST(ObjectTracking, AFloodOfBoxesStartsABoundedNumberAndSaysSo) {
  Stand stand;
  std::vector<BoxMeasurement> flood;
  for (int i = 0; i < 512; ++i) {
    flood.push_back(stand.At(10.0 + 3.0 * (i % 20), -60.0 + 4.0 * (i / 20)));
  }
  stand.Advance();
  stand.Boxes(flood);
  EXPECT_LE(stand.tracker.tracks().size(), TrackTable::kMostNewcomers);
  ASSERT_FALSE(stand.tracker.failures().empty());
  EXPECT_EQ(stand.tracker.failures()[0], Reason::kTrackTableFull);
}

}  // namespace
}  // namespace v2vouch
