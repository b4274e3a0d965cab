// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/track_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace v2vouch {
namespace {

const Timestamp kStart = FromMicros(1'700'000'000'000'000);

TrackFilter CarAt(double x_m) {
  PoseMeasurement z{.x_m = x_m, .speed_mps = 10.0};
  z.covariance.diagonal() << 0.25, 0.25, 0.0025, 0.25, 0.0004;
  return TrackFilter::FromPose(z);
}

TrackTable Table(int max_tracks = 512) {
  TrackerConfig config;
  config.max_tracks = max_tracks;
  TrackTable table(config);
  table.Predict(kStart);
  return table;
}

// Ninety-six sensors, as many as the configuration allows, each with the most detections.
TEST(TrackTable, IdsTellTimeSensorAndDetectionApart) {
  const Timestamp time = FromMicros(1'700'000'000'000'001);
  std::uint64_t last = 0;
  for (const SensorKind kind : kAllSensorKinds) {
    for (int sensor = 0; sensor < kMostSensorsOfAKind; ++sensor) {
      for (std::size_t i = 0; i < TrackTable::kMostDetections; ++i) {
        const std::uint64_t id = TrackTable::PackId(time, {kind, sensor}, i);
        ASSERT_GT(id, last);
        last = id;
      }
    }
  }
  EXPECT_GT(TrackTable::PackId(time + FromSeconds(0.001), {}, 0), last);
  const Timestamp far_off = FromMicros(7'258'118'400'000'000);  // 2200, the last year we take.
  EXPECT_LT(
      TrackTable::PackId(far_off, {SensorKind::kObjects, 31}, TrackTable::kMostDetections - 1),
      std::uint64_t{1} << 63);
}

TEST(TrackTable, ASecondMessageWithTheSameStampGetsIdsOfItsOwnAndTheOrderIsThatOfIds) {
  TrackTable table = Table();
  ASSERT_TRUE(table.Start(CarAt(0.0), {SensorKind::kCamera, 0}, 3, 0.2));
  ASSERT_TRUE(table.Start(CarAt(50.0), {SensorKind::kRadar, 1}, 3, 0.2));
  ASSERT_TRUE(table.Start(CarAt(90.0), {SensorKind::kRadar, 1}, 3, 0.2));
  table.EndStep();
  ASSERT_EQ(table.size(), 3u);
  for (std::size_t i = 1; i < table.size(); ++i) {
    EXPECT_LT(table.tracks()[i - 1].id, table.tracks()[i].id);
  }
  // What is known of a track moves with it.
  EXPECT_NEAR(table[2].evidence.filter.position_O().x(), table[2].track.state_O.mean[kX], 1e-9);
  EXPECT_EQ(table[2].track.camera_hits(), 1);
}

TEST(TrackTable, AFullTableStartsNothingAndSaysSo) {
  TrackTable table = Table(2);
  EXPECT_TRUE(table.Start(CarAt(0.0), {SensorKind::kRadar, 0}, 0, 0.2));
  EXPECT_TRUE(table.Start(CarAt(50.0), {SensorKind::kRadar, 0}, 1, 0.2));
  EXPECT_FALSE(table.Start(CarAt(90.0), {SensorKind::kRadar, 0}, 2, 0.2));
  ASSERT_EQ(table.faults().size(), 1u);
  EXPECT_EQ(table.faults()[0], Reason::kTrackTableFull);
  table.Predict(kStart + FromSeconds(0.05));
  EXPECT_TRUE(table.faults().empty());
}

TEST(TrackTable, OfManyThatAreNotListedTheLikeliestStay) {
  TrackTable table = Table();
  for (std::size_t k = 0; k < 200; ++k) {
    ASSERT_TRUE(table.Start(CarAt(20.0 * static_cast<double>(k)), {SensorKind::kRadar, 0}, k,
                            0.001 * static_cast<double>(k + 1)));
  }
  table.EndStep();
  ASSERT_EQ(table.size(), 128u);
  EXPECT_TRUE(std::ranges::all_of(table.tracks(),
                                  [](const LocalTrack& track) { return track.existence > 0.072; }));
}

TEST(TrackTable, AClassChangesForOneThatIsClearlyBetterSupported) {
  TrackTable table = Table();
  ASSERT_TRUE(table.Start(CarAt(0.0), {SensorKind::kCamera, 0}, 0, 0.2));
  table.NoteClass(0, ObjectClass::kCar, 0.9);
  table.NoteClass(0, ObjectClass::kTruck, 0.9);
  EXPECT_EQ(table[0].track.object_class, ObjectClass::kCar);
  table.NoteClass(0, ObjectClass::kTruck, 0.9);
  EXPECT_EQ(table[0].track.object_class, ObjectClass::kTruck);
}

// A sensor may send what it likes: nothing comes out that no vehicle can have.
TEST(TrackTable, ATrackWithANegativeVarianceEnds) {
  TrackTable table = Table();
  PoseMeasurement z{.x_m = 10.0};
  z.covariance.diagonal() << 0.25, 0.25, 0.0025, -0.25, 0.0004;
  ASSERT_TRUE(table.Start(TrackFilter::FromPose(z), {SensorKind::kObjects, 0}, 0, 0.2));
  table.Judge();
  table.EndStep();
  EXPECT_EQ(table.size(), 0u);
  ASSERT_EQ(table.faults().size(), 1u);
  EXPECT_EQ(table.faults()[0], Reason::kTrackNumerics);
}

TEST(TrackTable, ATrackWithAnImpossibleExistenceEnds) {
  for (const double existence : {std::numeric_limits<double>::quiet_NaN(), -0.1, 1.1}) {
    TrackTable table = Table();
    ASSERT_TRUE(table.Start(CarAt(0.0), {SensorKind::kRadar, 0}, 0, 0.2));
    table[0].track.existence = existence;
    table.Judge();
    table.EndStep();
    EXPECT_EQ(table.size(), 0u) << existence;
  }
}

TEST(TrackTable, ATrackWithoutAFiniteStateEnds) {
  TrackTable table = Table();
  ASSERT_TRUE(table.Start(CarAt(std::numeric_limits<double>::quiet_NaN()), {SensorKind::kRadar, 0},
                          0, 0.2));
  table.Judge();
  table.EndStep();
  EXPECT_EQ(table.size(), 0u);
  ASSERT_EQ(table.faults().size(), 1u);
  EXPECT_EQ(table.faults()[0], Reason::kTrackNumerics);
}

}  // namespace
}  // namespace v2vouch
