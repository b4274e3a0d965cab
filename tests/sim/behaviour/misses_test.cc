// SPDX-License-Identifier: Apache-2.0
#include "sim/behaviour/misses.h"

#include <gtest/gtest.h>

#include <cmath>

#include "daemon/common/base/angle.h"

namespace v2vouch::evaluation {
namespace {

constexpr std::uint32_t kSender = 77;
constexpr int kSteps = 200;
constexpr double kPeriod_s = 0.05;
constexpr int kUnknown = 1, kCandidate = 2, kValidated = 3, kSuspect = 5;

Timestamp At(int step) { return FromMicros(std::llround(kPeriod_s * step * 1e6)); }

/// 10 s: an ego at the origin with one radar, and a sender that drives 30 m ahead, always in LOCAL
/// and in the V2V list with the trust of that instant; PRIORITY has it where it is trusted.
class OneSender : public testing::Test {
 protected:
  struct Instant {
    bool is_hidden = false;
    bool is_local = true;
    bool is_followed = true;
    int trust = kValidated;
    bool is_listed = true;
    double error_m = 0.0;
  };
  std::vector<Instant> instants_ = std::vector<Instant>(kSteps);
  std::vector<VerdictReport> reports_;
  ListScore priority_;

  void Change(int from, int to, const Instant& value) {
    std::fill(instants_.begin() + from, instants_.begin() + to, value);
  }

  std::vector<Miss> Explain() {
    RunLog log;
    SensorSpec radar;
    radar.channel = "RADAR_FRONT";
    radar.half_fov_rad = FromDegrees(60.0);
    radar.max_range_m = 80.0;
    log.specs.sensors = {radar};
    log.reports = reports_;
    TruthObject vehicle;
    vehicle.id = 3;
    vehicle.object_class = 1;
    vehicle.has_v2v = true;
    vehicle.length_m = 4.5;
    vehicle.width_m = 1.8;
    for (int k = 0; k < kSteps; ++k) {
      const Instant& now = instants_[static_cast<std::size_t>(k)];
      const Timestamp t = At(k);
      TruthSample ego;
      ego.stamp = t;
      log.truth.ego.Add(ego);
      TruthSample sample;
      sample.stamp = t;
      sample.motion = {30.0, 2.0, 0.0, 8.0, 0.0, 0.0};
      sample.sender = kSender;
      sample.is_hidden = now.is_hidden;
      sample.looks = {{"RADAR_FRONT", now.is_hidden ? 0.0 : 0.95, 1.0}};
      vehicle.motion.Add(sample);
      log.looks.push_back({t, t, 0});
      log.bsms.push_back({t, kSender});
      ListedTrack track;
      track.id = 7;
      track.motion_B = sample.motion;
      ReceivedList local{t, t, false, {}}, v2v = local, priority = local;
      if (now.is_local) local.tracks.push_back(track);
      track.sender = kSender;
      track.trust = now.trust;
      if (now.is_followed) v2v.tracks.push_back(track);
      track.motion_B.x_m += now.error_m;
      if (now.is_listed) priority.tracks.push_back(track);
      log.lists[Index(ListKind::kLocal)].push_back(local);
      log.lists[Index(ListKind::kV2v)].push_back(v2v);
      log.lists[Index(ListKind::kPriority)].push_back(priority);
    }
    log.truth.objects = {vehicle};
    ScoringSettings settings;
    settings.skip_s = 0.0;
    const auto grid = MakeGrid(log.truth, settings);
    const Bound bound(log, grid);
    const auto score = [&](ListKind kind) {
      return ScoreList(log, grid, bound, kind, Against::kOwnScope, settings, false);
    };
    priority_ = score(ListKind::kPriority);
    return ExplainMisses(log, grid, bound, score(ListKind::kLocal), priority_, settings);
  }
};

TEST_F(OneSender, EveryReasonIsToldFromTheOthers) {
  reports_ = {{At(90), kSender, "velocity_residual"}, {At(91), 5, "position_jump"}};
  Change(40, 50, {.is_local = false, .trust = kCandidate, .is_listed = false});
  Change(50, 60, {.trust = kCandidate, .is_listed = false});
  Change(60, 70, {.trust = kUnknown, .is_listed = false});
  Change(70, 80, {.is_followed = false, .is_listed = false});
  Change(80, 90, {.error_m = 25.0});
  Change(90, 110, {.trust = kSuspect, .is_listed = false});
  Change(150, 170, {.is_hidden = true, .is_local = false, .trust = kCandidate, .is_listed = false});
  const auto misses = Explain();
  const auto seconds = [&](MissReason reason) {
    double sum = 0.0;
    for (const Miss& miss : misses) sum += miss.reason == reason ? miss.seconds : 0.0;
    return sum;
  };
  EXPECT_NEAR(seconds(MissReason::kNoLocalTrack), 0.5, 1e-9);
  EXPECT_NEAR(seconds(MissReason::kNotValidated), 0.5, 1e-9);
  EXPECT_NEAR(seconds(MissReason::kUnknownSender), 0.5, 1e-9);
  EXPECT_NEAR(seconds(MissReason::kNotFollowed), 0.5, 1e-9);
  EXPECT_NEAR(seconds(MissReason::kElsewhere), 0.5, 1e-9);
  EXPECT_NEAR(seconds(MissReason::kWithdrawn), 1.0, 1e-9);
  EXPECT_NEAR(seconds(MissReason::kBridgeEnded), 1.0, 1e-9);
  EXPECT_EQ(seconds(MissReason::kNeverBridged), 0.0);
  double sum = 0.0;
  for (const Miss& miss : misses) {
    sum += miss.seconds;
    EXPECT_EQ(miss.vehicle, 3);
    EXPECT_EQ(miss.check, miss.reason == MissReason::kWithdrawn ? "velocity_residual" : "");
  }
  EXPECT_NEAR(sum, priority_.excess_missed_seconds, 1e-9);
}

TEST_F(OneSender, HiddenBeforeItWasEverListedIsNoEndedBridge) {
  Change(0, 60, {.trust = kCandidate, .is_listed = false});
  Change(60, 80, {.is_hidden = true, .is_local = false, .trust = kCandidate, .is_listed = false});
  double never_s = 0.0;
  for (const Miss& miss : Explain()) {
    EXPECT_NE(miss.reason, MissReason::kBridgeEnded);
    if (miss.reason == MissReason::kNeverBridged) never_s += miss.seconds;
  }
  EXPECT_NEAR(never_s, 1.0, 1e-9);
}

TEST_F(OneSender, NothingIsMissedNothingIsExplained) { EXPECT_TRUE(Explain().empty()); }

}  // namespace
}  // namespace v2vouch::evaluation
