// SPDX-License-Identifier: Apache-2.0
// A source of objects in the order of events, and under the guard of the clock: as a radar or
// camera.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "daemon/pipeline/perception.h"

namespace v2vouch {
namespace {

constexpr Timestamp kStart = FromMicros(1'700'000'000'000'000);

struct Arrival {
  double at_s = 0.0;
  Input input;
};

EgoMotion Motion(double t_s) {
  EgoMotion ego;
  ego.stamp = kStart + FromSeconds(t_s);
  ego.seq = std::lround(t_s * 50.0);
  ego.speed_mps = 10.0;
  return ego;
}

// One car ahead, 2 m/s faster, which covers nothing.
ObjectList List(int sensor, double t_s, double clock_s = 0.0) {
  ObjectList list;
  list.stamp = kStart + FromSeconds(t_s + clock_s);
  list.seq = std::lround(t_s * 100.0);
  list.sensor = sensor;
  const double wave = 0.1 * std::sin(37.0 * t_s + sensor);
  list.objects = {{.x_m = 20.0 + 2.0 * t_s + wave, .y_m = 1.0 - wave, .score = 0.9}};
  return list;
}

// Ego motion at 50 Hz and two sources at 10 Hz, of which the second comes `late_s` after its time.
std::vector<Arrival> Drive(double late_s, double clock_s = 0.0) {
  std::vector<Arrival> arrivals;
  for (int k = 0; k < 200; ++k) {
    arrivals.push_back({0.02 * k, Motion(0.02 * k)});
    if (k % 5 == 0) arrivals.push_back({0.02 * k + 0.001, List(0, 0.02 * k)});
    if (k % 5 == 2) arrivals.push_back({0.02 * k + late_s, List(1, 0.02 * k, clock_s)});
  }
  std::ranges::stable_sort(arrivals, {}, &Arrival::at_s);
  return arrivals;
}

struct Drove {
  explicit Drove(const std::vector<Arrival>& arrivals) {
    PerceptionConfig config;
    config.vehicle.radars.clear();
    config.vehicle.cameras.clear();
    config.vehicle.objects.assign(2, ObjectSensorConfig{});
    config.vehicle.objects[0].name = "FRONT";
    perception = std::make_unique<Perception>(config, std::make_unique<NullBiasEstimator>());
    Outputs outputs;
    for (const Arrival& arrival : arrivals) {
      if (const auto refusal = perception->Step(arrival.input, outputs))
        refusals.push_back(*refusal);
      if (outputs.has_lists) newest = outputs.local;
    }
  }

  std::unique_ptr<Perception> perception;
  TrackList newest;
  std::vector<Reason> refusals;
};

TEST(ObjectListsInTime, LateOnesArePutInTheirPlaceBitForBit) {
  const Drove prompt(Drive(0.002)), late(Drive(0.3));
  EXPECT_TRUE(prompt.refusals.empty());
  EXPECT_TRUE(late.refusals.empty());
  ASSERT_EQ(prompt.newest.tracks.size(), 1U);
  ASSERT_EQ(late.newest.tracks.size(), 1U);
  const LocalTrack& a = prompt.newest.tracks[0].track;
  const LocalTrack& b = late.newest.tracks[0].track;
  EXPECT_EQ(a.support.sources().size(), 2U);
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.state_O.mean, b.state_O.mean);
  EXPECT_EQ(a.state_O.covariance, b.state_O.covariance);
  EXPECT_EQ(a.existence, b.existence);
}

TEST(ObjectListsInTime, ARepeatedListIsADuplicateAndAnOldOneTooOld) {
  std::vector<Arrival> arrivals = Drive(0.002);
  arrivals.push_back({5.0, List(0, 3.9)});
  arrivals.push_back({5.0, List(0, 1.0)});
  const Drove run(arrivals);
  EXPECT_EQ(run.refusals, (std::vector{Reason::kDuplicate, Reason::kTooOld}));
}

TEST(ObjectListsInTime, ASourceWhoseClockIsAheadCostsItselfAndIsTold) {
  const Drove run(Drive(0.002, 5.0));
  EXPECT_EQ(run.newest.stamp, kStart + FromSeconds(3.9));
  EXPECT_EQ(run.newest.tracks.size(), 1U);
  ASSERT_FALSE(run.refusals.empty());
  for (const Reason reason : run.refusals) EXPECT_EQ(reason, Reason::kFutureStamp);
  std::vector<Notice> notices;
  run.perception->CollectNotices(notices);
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_EQ(notices[0].kind, NoticeKind::kClockAhead);
  EXPECT_EQ(notices[0].subject, (NoticeSubject{NoticeSubject::Kind::kObjects, 1}));
  EXPECT_TRUE(run.perception->IsAlive({SensorKind::kObjects, 0}));
  EXPECT_FALSE(run.perception->IsAlive({SensorKind::kObjects, 1}));
}

TEST(ObjectListsInTime, TheSectorsOfASourceAreWatchedWhileItSpeaks) {
  const Drove run(Drive(0.002));
  for (const SectorHealth& sector : run.newest.sectors) {
    EXPECT_EQ(sector.state, SectorState::kWatched);
    EXPECT_EQ(sector.range_m, 80.0);
  }
}

}  // namespace
}  // namespace v2vouch
