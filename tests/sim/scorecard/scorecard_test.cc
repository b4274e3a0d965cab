// SPDX-License-Identifier: Apache-2.0
#include "sim/scorecard/scorecard.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "daemon/common/base/angle.h"
#include "sim/metrics/scoring.h"

namespace v2vouch::evaluation {
namespace {

Timestamp At(double t_s) { return FromMicros(std::llround(t_s * 1e6)); }

constexpr double kLength_s = 10.0, kPeriod_s = 0.05;
constexpr int kSteps = 200;
constexpr int kCar = 1, kTruck = 3;

/// An ego that stands at the origin with one radar and one camera, both looking ahead; objects and
/// lists at 20 Hz for 10 s, as functions of time.
struct Drive {
  struct Object {
    std::int64_t id = 1;
    int object_class = kCar;
    bool has_v2v = false;
    double length_m = 4.5, width_m = 1.8;
    std::function<PlanarMotion(double)> motion;
    std::function<bool(double)> is_hidden = [](double) { return false; };
  };
  std::vector<Object> objects;
  std::function<std::vector<ListedTrack>(double)> tracks = [](double) {
    return std::vector<ListedTrack>();
  };

  [[nodiscard]] RunLog Log(ListKind kind = ListKind::kLocal) const {
    RunLog log;
    SensorSpec radar;
    radar.channel = "RADAR_FRONT";
    radar.half_fov_rad = FromDegrees(60.0);
    radar.max_range_m = 100.0;
    SensorSpec camera = radar;
    camera.channel = "CAMERA_FRONT";
    camera.kind = SensorKind::kCamera;
    camera.half_fov_rad = FromDegrees(30.0);
    log.specs.sensors = {radar, camera};
    for (const Object& object : objects) {
      TruthObject truth;
      truth.id = object.id;
      truth.object_class = object.object_class;
      truth.has_v2v = object.has_v2v;
      truth.length_m = object.length_m;
      truth.width_m = object.width_m;
      for (int k = 0; k <= kSteps; ++k) {
        const double t = kPeriod_s * k;
        TruthSample sample;
        sample.stamp = At(t);
        sample.motion = object.motion(t);
        sample.is_hidden = object.is_hidden(t);
        truth.motion.Add(sample);
      }
      log.truth.objects.push_back(truth);
    }
    for (int k = 0; k <= kSteps; ++k) {
      const double t = kPeriod_s * k;
      TruthSample ego;
      ego.stamp = At(t);
      log.truth.ego.Add(ego);
      log.lists[Index(kind)].push_back({At(t), At(t), false, tracks(t)});
    }
    return log;
  }
};

ListedTrack Track(double x_m, double y_m, std::int64_t id = 7) {
  ListedTrack track;
  track.id = id;
  track.motion_B = {x_m, y_m, 0.0, 0.0, 0.0, 0.0};
  track.length_m = 4.5;
  track.width_m = 1.8;
  track.last_hit = At(kLength_s);
  return track;
}

std::function<PlanarMotion(double)> StandsAt(double x_m, double y_m, double yaw_rad = 0.0) {
  return [=](double) { return PlanarMotion{x_m, y_m, yaw_rad, 0.0, 0.0, 0.0}; };
}

Scorecard Judged(const RunLog& log, ListKind kind = ListKind::kLocal) {
  return JudgeScorecard(log, kind, {});
}

TEST(Scorecard, TenListsASecondAreScoredAfterTheFirst) {
  Drive drive;
  drive.objects = {{.motion = StandsAt(20.0, 0.0)}};
  const Scorecard card = Judged(drive.Log());
  EXPECT_EQ(card.instants, 91);
  EXPECT_EQ(card.lists, 91);
  EXPECT_EQ(card.missed_visible.of, 91);
  EXPECT_EQ(card.missed_visible.missed, 91);
}

TEST(Scorecard, AListIsJudgedInItsLastCorrection) {
  Drive drive;
  drive.objects = {{.motion = StandsAt(20.0, 0.0)}};
  drive.tracks = [](double) { return std::vector{Track(25.0, 0.0)}; };
  RunLog log = drive.Log();
  std::vector<ReceivedList> corrections = log.lists[0];
  for (ReceivedList& list : corrections) list.tracks = {Track(20.5, 0.0)};
  for (std::size_t i = corrections.size(); i-- > 0;) {
    log.lists[0].insert(log.lists[0].begin() + static_cast<std::ptrdiff_t>(i) + 1, corrections[i]);
  }
  EXPECT_NEAR(Judged(log).position.all.Rms(), 0.5, 1e-9);
}

TEST(Scorecard, WhereNothingIsPublishedVehiclesAreMissed) {
  Drive drive;
  drive.objects = {{.motion = StandsAt(20.0, 0.0)}};
  drive.tracks = [](double) { return std::vector{Track(20.0, 0.0)}; };
  RunLog log = drive.Log();
  std::erase_if(log.lists[0], [](const ReceivedList& list) { return list.stamp > At(5.0); });
  const Scorecard card = Judged(log);
  EXPECT_EQ(card.instants, 91);
  EXPECT_EQ(card.lists, 42);  // 1.0 to 5.0 s, and the list of 5.0 s once more at 5.1 s.
  EXPECT_EQ(card.missed_visible.missed, 49);
  EXPECT_EQ(card.lead.absent, 49);
}

TEST(Scorecard, ErrorsAreSplitByMotionSightAndClass) {
  Drive drive;
  drive.objects = {
      {.id = 1, .motion = StandsAt(20.0, 0.0)},
      {.id = 2,
       .object_class = kTruck,
       .length_m = 10.0,
       .motion = [](double t) { return PlanarMotion{20.0 + t, 10.0, 0.0, 1.0, 0.0, 0.0}; }},
      // Half behind the first, as seen from the origin.
      {.id = 3, .motion = StandsAt(40.0, 2.2)},
  };
  drive.tracks = [](double t) {
    ListedTrack truck = Track(20.0 + t + 0.6, 10.0, 2);
    truck.length_m = 12.0;
    truck.motion_B.speed_mps = 2.5;
    truck.motion_B.yaw_rad = 0.1;
    return std::vector{Track(20.3, 0.0, 1), truck, Track(40.0, 3.1, 3)};
  };
  const Scorecard card = Judged(drive.Log());
  EXPECT_NEAR(card.position.standing.Rms(), 0.3, 1e-9);
  EXPECT_NEAR(card.position.moving.Rms(), 0.6, 1e-9);
  EXPECT_NEAR(card.position.partly_hidden.Rms(), 0.9, 1e-9);
  EXPECT_NEAR(card.position.plain.Rms(), 0.3, 1e-9);
  EXPECT_NEAR(card.position.lorries.Rms(), 0.6, 1e-9);
  EXPECT_NEAR(card.lorry.length_error_m.Largest(), 2.0, 1e-9);
  EXPECT_NEAR(ToDegrees(card.yaw_moving_rad.Median()), ToDegrees(0.1), 1e-9);
  EXPECT_NEAR(card.velocity_mps.Largest(), std::hypot(2.5 * std::cos(0.1) - 1.0, 0.25), 1e-3);
}

TEST(Scorecard, AVehicleOfWhichASliverShowsCountsNeitherWay) {
  Drive drive;
  drive.objects = {{.id = 1, .motion = StandsAt(20.0, 0.0)},
                   {.id = 2, .motion = StandsAt(30.0, 0.2)}};
  drive.tracks = [](double) { return std::vector{Track(20.0, 0.0, 1), Track(33.0, 0.2, 2)}; };
  Scorecard card = Judged(drive.Log());
  EXPECT_EQ(card.missed_visible.of, 91);
  EXPECT_EQ(card.false_entries, 0);
  EXPECT_NEAR(card.position.all.Rms(), 0.0, 1e-9);
}

TEST(Scorecard, NeesIsSplitByWhetherTheVehicleIsHidden) {
  Drive drive;
  drive.objects = {{.motion = StandsAt(20.0, 0.0), .is_hidden = [](double t) { return t > 4.98; }}};
  drive.tracks = [](double) { return std::vector{Track(22.0, 0.0)}; };  // Covariance: identity.
  const Scorecard card = Judged(drive.Log());
  EXPECT_NEAR(card.visible.nees.Mean(), 4.0, 1e-9);
  EXPECT_EQ(card.visible.nees.count() + card.hidden.nees.count(), 91);
  EXPECT_EQ(card.hidden.nees.count(), 51);
}

TEST(Scorecard, EntriesWithoutAVehicleAreCountedBySecondsAndByWhetherTheyCoast) {
  Drive drive;
  drive.objects = {{.motion = StandsAt(20.0, 0.0)}};
  drive.tracks = [](double t) {
    ListedTrack coasting = Track(60.0, 20.0, 8);
    coasting.last_hit = At(4.0);
    std::vector<ListedTrack> tracks = {Track(20.0, 0.0, 1)};
    if (t > 3.98 && t < 5.98) tracks.push_back(coasting);
    if (t > 6.98) tracks.push_back(Track(20.0, 3.5, 9));  // Near the car's box: false, not unseen.
    return tracks;
  };
  const Scorecard card = Judged(drive.Log());
  EXPECT_EQ(card.unseen.ids, 1);
  EXPECT_EQ(card.unseen.lasting_ids, 1);
  EXPECT_NEAR(card.unseen.seconds, 2.0, 1e-9);
  EXPECT_EQ(card.unseen.coasting, 16);  // From 4.4 s on.
  EXPECT_EQ(card.false_entries, 20 + 31);
}

TEST(Scorecard, IdentitySwitchesAreCountedAcrossGaps) {
  Drive drive;
  drive.objects = {{.motion = StandsAt(20.0, 0.0)}};
  drive.tracks = [](double t) {
    if (t > 4.0 && t < 5.0) return std::vector<ListedTrack>();
    return std::vector{Track(20.0, 0.0, t < 4.5 ? 1 : t < 8.0 ? 2 : 3)};
  };
  EXPECT_EQ(Judged(drive.Log()).switches, 2);
}

TEST(Scorecard, FirstListingCountsTheTimeInSight) {
  Drive drive;
  drive.objects = {
      {.id = 1,
       .motion = [](double t) { return PlanarMotion{20.0 + t, -3.0, 0.0, 1.0, 0.0, 0.0}; },
       .is_hidden = [](double t) { return t > 0.92 && t < 3.0; }},
      {.id = 2, .motion = StandsAt(25.0, 8.0)}};
  drive.tracks = [](double t) {
    if (t < 3.48) return std::vector<ListedTrack>();
    return std::vector{Track(20.0 + t, -3.0)};
  };
  const Scorecard card = Judged(drive.Log());
  ASSERT_EQ(card.first_listing.moving.delay_s.count(), 1);
  EXPECT_NEAR(card.first_listing.moving.delay_s.Mean(), 1.5, 1e-9);  // 0 to 0.9 and 3.0 to 3.4 s.
  EXPECT_EQ(card.first_listing.moving.never, 0);
  EXPECT_EQ(card.first_listing.plain.never, 1);
}

TEST(Scorecard, TheLeadVehicleIsAbsentWhereNoTrackIsNear) {
  Drive drive;
  drive.objects = {{.id = 1, .motion = StandsAt(10.0, 0.5)},
                   {.id = 2, .motion = StandsAt(30.0, 5.0)}};
  drive.tracks = [](double t) {
    if (t > 4.02 && t < 5.98) return std::vector{Track(10.4, 3.0)};  // 2.5 m aside.
    return std::vector{Track(10.4, 0.5), Track(14.0, 0.5, 8)};
  };
  const Scorecard card = Judged(drive.Log());
  EXPECT_EQ(card.lead.lists, 81);  // In sight for 2 s at 2.0 s.
  EXPECT_EQ(card.lead.absent, 19);
  EXPECT_NEAR(card.lead.longest_absence_s, 1.9, 1e-9);
  EXPECT_NEAR(card.lead.along_m.Rms(), 0.4, 1e-9);
}

TEST(Scorecard, AVehicleBesideTheLaneIsNoLead) {
  Drive drive;
  drive.objects = {{.motion = StandsAt(10.0, 2.0)}};
  EXPECT_EQ(Judged(drive.Log()).lead.lists, 0);
}

TEST(Scorecard, PriorityIsJudgedBySendersAndByTheTimeTheyAreHidden) {
  Drive drive;
  drive.objects = {{.id = 1,
                    .has_v2v = true,
                    .motion = StandsAt(20.0, 0.0),
                    .is_hidden = [](double t) { return t > 4.98; }},
                   {.id = 2, .has_v2v = false, .motion = StandsAt(20.0, 9.0)}};
  drive.tracks = [](double t) {
    ListedTrack track = Track(20.0, t < 4.98 ? 0.0 : 0.8);
    track.bridge_budget_s = 3.52;
    if (t > 8.32) return std::vector<ListedTrack>();
    return std::vector{track};
  };
  const Scorecard card = Judged(drive.Log(ListKind::kPriority), ListKind::kPriority);
  EXPECT_EQ(card.missed_visible.of, 40);
  EXPECT_EQ(card.hidden_1_2_s.samples, 10);
  EXPECT_EQ(card.hidden_1_2_s.kept, 10);
  EXPECT_NEAR(card.hidden_1_2_s.error_m.Rms(), 0.8, 1e-9);
  EXPECT_EQ(card.hidden_3_4_s.samples, 10);  // Last visible at 4.9 s: 7.9 to 8.8 s.
  EXPECT_EQ(card.hidden_3_4_s.kept, 5);      // Until 8.3 s.
  EXPECT_EQ(card.hidden_3_4_s.covered, 6);   // Until 8.4 s.
  EXPECT_EQ(card.hidden_3_4_s.covered_kept, 5);
  EXPECT_EQ(card.validated_of, 20);  // 3.0 to 4.9 s.
  EXPECT_EQ(card.validated, 20);
}

TEST(Scorecard, ARunWithoutAVehicleHasNoFigures) {
  const Scorecard card = Judged(Drive().Log());
  EXPECT_TRUE(std::isnan(card.position.all.Rms()));
  EXPECT_TRUE(std::isnan(card.lead.absent_share()));
  EXPECT_EQ(card.false_per_list(), 0.0);
}

TEST(Sample, QuantilesAreNearestRanks) {
  const Sample sample{{4.0, 1.0, 3.0, 2.0}};
  EXPECT_EQ(sample.Median(), 2.0);
  EXPECT_EQ(sample.Quantile(0.95), 4.0);
  EXPECT_EQ(sample.ShareAbove(2.5), 0.5);
  EXPECT_TRUE(std::isnan(Sample().Median()));
}

}  // namespace
}  // namespace v2vouch::evaluation
