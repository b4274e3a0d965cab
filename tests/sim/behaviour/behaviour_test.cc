// SPDX-License-Identifier: Apache-2.0
#include "sim/behaviour/behaviour.h"

#include <gtest/gtest.h>

#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/random.h"
#include "sim/metrics/consistency.h"
#include "sim/report/behaviour_text.h"

namespace v2vouch::evaluation {
namespace {

Timestamp At(double t_s) { return FromMicros(std::llround(t_s * 1e6)); }

/// An ego that stands at the origin with one radar, and one vehicle ahead; truth and LOCAL lists
/// at 20 Hz for 5 s, changed by the tests before they are judged.
class OneVehicle : public testing::Test {
 protected:
  static constexpr int kSteps = 100;
  static constexpr double kPeriod_s = 0.05;

  struct Instant {
    PlanarMotion truth{30.0, 2.0, 0.0, 8.0, 0.0, 0.0};
    double detection_probability = 0.95;
    bool is_listed = true;
    double yaw_error_rad = 0.0;
    double error_m = 0.0;
    int visibility = 0;
    std::int64_t track = 7;
  };
  std::vector<Instant> instants_ = std::vector<Instant>(kSteps);

  RunLog MakeLog() const {
    RunLog log;
    SensorSpec radar;
    radar.channel = "RADAR_FRONT";
    radar.half_fov_rad = FromDegrees(60.0);
    radar.max_range_m = 80.0;
    log.specs.sensors = {radar};
    TruthObject vehicle;
    vehicle.id = 3;
    vehicle.object_class = 1;
    vehicle.length_m = 4.5;
    vehicle.width_m = 1.8;
    for (int k = 0; k < kSteps; ++k) {
      const Instant& now = instants_[static_cast<std::size_t>(k)];
      const Timestamp t = At(kPeriod_s * k);
      TruthSample ego;
      ego.stamp = t;
      log.truth.ego.Add(ego);
      TruthSample sample;
      sample.stamp = t;
      sample.motion = now.truth;
      sample.is_hidden = now.detection_probability <= 0.0;
      sample.looks = {{"RADAR_FRONT", now.detection_probability, 1.0}};
      vehicle.motion.Add(sample);
      log.looks.push_back({t, t, 0});
      ReceivedList list{t, t, false, {}};
      if (now.is_listed) {
        ListedTrack track;
        track.id = now.track;
        track.motion_B = now.truth;
        track.motion_B.x_m += now.error_m;
        track.motion_B.yaw_rad += now.yaw_error_rad;
        track.start = At(0.0);
        track.visibility = now.visibility;
        list.tracks.push_back(track);
      }
      log.lists[Index(ListKind::kLocal)].push_back(std::move(list));
    }
    log.truth.objects = {vehicle};
    return log;
  }

  ListBehaviour Judge() const {
    const RunLog log = MakeLog();
    ScoringSettings settings;
    settings.skip_s = 0.0;
    const auto grid = MakeGrid(log.truth, settings);
    const Bound bound(log, grid);
    const ListScore score =
        ScoreList(log, grid, bound, ListKind::kLocal, Against::kOwnScope, settings, false);
    return JudgeList(log, grid, bound, score, settings);
  }
  // The vehicle of instants [from, to).
  auto Stretch(int from, int to) {
    return std::span(instants_).subspan(static_cast<std::size_t>(from),
                                        static_cast<std::size_t>(to - from));
  }
};

TEST_F(OneVehicle, EveryFlagIsHeldAgainstTheTruth) {
  for (Instant& now : Stretch(0, 10)) now.visibility = 1;  // Visible, called hidden.
  for (Instant& now : Stretch(10, 30)) {                   // Behind something, called visible.
    now.detection_probability = 0.0;
  }
  for (Instant& now : Stretch(30, 60)) {  // Beside the radar's view, and called so.
    now.detection_probability = 0.0;
    now.truth.x_m = 3.0;
    now.truth.y_m = 30.0;
    now.visibility = 2;
  }
  for (Instant& now : Stretch(60, 65)) {  // Beyond its range, called hidden.
    now.detection_probability = 0.0;
    now.truth.x_m = 90.0;
    now.visibility = 1;
  }
  const VisibilityTable table = Judge().visibility;
  const auto count = [&](Sighting said, Sighting is) {
    return table.count[static_cast<std::size_t>(said)][static_cast<std::size_t>(is)];
  };
  EXPECT_EQ(count(Sighting::kHidden, Sighting::kVisible), 10);
  EXPECT_EQ(count(Sighting::kVisible, Sighting::kHidden), 20);
  EXPECT_EQ(count(Sighting::kOutOfView, Sighting::kOutOfView), 30);
  EXPECT_EQ(count(Sighting::kHidden, Sighting::kOutOfView), 5);
  EXPECT_EQ(count(Sighting::kVisible, Sighting::kVisible), 35);
  EXPECT_EQ(table.total(), kSteps);
  EXPECT_DOUBLE_EQ(table.share_right(), 0.65);
  EXPECT_DOUBLE_EQ(table.share_right_of_said(Sighting::kHidden), 0.0);
  EXPECT_DOUBLE_EQ(table.share_found_of_true(Sighting::kOutOfView), 30.0 / 35.0);
}

TEST_F(OneVehicle, AFlipIsCountedOnceAndYoungTracksAreNotJudged) {
  for (Instant& now : Stretch(0, 15)) now.yaw_error_rad = kPi;  // Younger than a second.
  for (Instant& now : Stretch(40, 50)) now.yaw_error_rad = FromDegrees(170.0);
  for (Instant& now : Stretch(70, 72)) now.yaw_error_rad = FromDegrees(-95.0);
  const HeadingFigures heading = Judge().heading;
  EXPECT_EQ(heading.tracks, 1);
  EXPECT_EQ(heading.flips, 2);
  EXPECT_EQ(heading.reversed, 12);
  EXPECT_EQ(heading.born_reversed, 0);
}

TEST_F(OneVehicle, ATrackThatIsReversedAtOneSecondOfAgeWasBornSo) {
  for (Instant& now : Stretch(0, kSteps)) now.yaw_error_rad = kPi;
  for (Instant& now : Stretch(60, kSteps)) now.track = 8;
  const HeadingFigures heading = Judge().heading;
  EXPECT_EQ(heading.tracks, 2);
  EXPECT_EQ(heading.born_reversed, 2);
  EXPECT_EQ(heading.flips, 0);
  EXPECT_NEAR(heading.rms_moving_rad, kPi, 1e-9);
}

TEST_F(OneVehicle, StandingAndMovingAreToldApart) {
  for (Instant& now : Stretch(0, 40)) {
    now.truth.speed_mps = 0.0;
    now.error_m = 2.0;
    now.yaw_error_rad = 0.5;
  }
  for (Instant& now : Stretch(40, kSteps)) now.error_m = 0.3;
  const ListBehaviour judged = Judge();
  EXPECT_NEAR(judged.standing.rms_m, 2.0, 1e-9);
  EXPECT_NEAR(judged.standing.seconds, 2.0, 1e-9);
  EXPECT_NEAR(judged.moving.rms_m, 0.3, 1e-9);
  EXPECT_NEAR(judged.moving.seconds, 3.0, 1e-9);
  EXPECT_NEAR(judged.heading.rms_standing_rad, 0.5, 1e-9);
  EXPECT_NEAR(judged.heading.rms_moving_rad, 0.0, 1e-9);
}

TEST_F(OneVehicle, LooksAreCountedUpToTheFirstListing) {
  for (Instant& now : Stretch(0, 20)) now.detection_probability = 0.0;   // Not there to be seen.
  for (Instant& now : Stretch(20, 25)) now.detection_probability = 0.3;  // No fair look.
  for (Instant& now : Stretch(0, 27)) now.is_listed = false;
  const Confirmation::Mean all = JudgeConfirmation(MakeLog(), {}).Average(Confirmation::Of::kAll);
  EXPECT_EQ(all.vehicles, 1);
  EXPECT_EQ(all.listed, 1);
  EXPECT_DOUBLE_EQ(all.looks, 3.0);  // Instants 25, 26, 27.
  EXPECT_NEAR(all.expected_hits, 3 * 0.95, 1e-9);
  EXPECT_NEAR(all.delay_s, 0.1, 1e-9);
}

TEST_F(OneVehicle, ATrackTooFarOffIsNoListing) {
  for (Instant& now : Stretch(0, kSteps)) now.error_m = 6.0;
  const auto all = JudgeConfirmation(MakeLog(), {}).Average(Confirmation::Of::kAll);
  EXPECT_EQ(all.vehicles, 1);
  EXPECT_EQ(all.listed, 0);
}

TEST_F(OneVehicle, FormsHoldTheFigures) {
  for (Instant& now : Stretch(40, 50)) now.yaw_error_rad = kPi;
  Behaviour behaviour;
  behaviour.local = Judge();
  behaviour.confirmation = JudgeConfirmation(MakeLog(), {});
  const auto json = BehaviourJson(behaviour);
  EXPECT_EQ(json.at("local").at("heading").at("flips"), 1);
  EXPECT_EQ(json.at("local").at("visibility").at("said").at("visible").at("truly_visible"), kSteps);
  EXPECT_EQ(json.at("confirmation").at("all").at("looks_mean"), 1.0);
  EXPECT_NE(BehaviourTable(behaviour).find("1 flips"), std::string::npos);
  EXPECT_NE(BehaviourHtml(behaviour).find("LOCAL says"), std::string::npos);
}

// Quantiles of the chi-square distribution: Abramowitz and Stegun, table 26.8.
TEST(ChiSquareOfPairs, AgreesWithTheTables) {
  EXPECT_NEAR(ChiSquareOfPairs(0.95, 1), 5.99146, 1e-4);
  EXPECT_NEAR(ChiSquareOfPairs(0.975, 5), 20.4831, 1e-3);
  EXPECT_NEAR(ChiSquareOfPairs(0.025, 5), 3.24697, 1e-4);
  EXPECT_NEAR(ChiSquareOfPairs(0.975, 50), 129.561, 1e-2);
  EXPECT_NEAR(ChiSquareOfPairs(0.5, 20000), 40000.0, 1.0);
}

// Errors of an honest filter: unit normal per axis, one value following the last.
std::vector<MatchedPair> HonestErrors(Random& random, int vehicles, int instants, double keep,
                                      double scale) {
  std::vector<MatchedPair> pairs;
  std::vector<Eigen::Vector2d> errors(static_cast<std::size_t>(vehicles));
  for (auto& e : errors) e = {random.Normal(), random.Normal()};
  for (int k = 0; k < instants; ++k) {
    for (std::size_t v = 0; v < errors.size(); ++v) {
      pairs.push_back({static_cast<std::size_t>(k), v, 1, 0.0,
                       scale * scale * errors[v].squaredNorm(), Sighting::kVisible});
      errors[v] = keep * errors[v] +
                  std::sqrt(1.0 - keep * keep) * Eigen::Vector2d(random.Normal(), random.Normal());
    }
  }
  return pairs;
}

Anees BandOf(const std::vector<MatchedPair>& pairs) {
  Anees anees;
  for (const MatchedPair& pair : pairs) {
    anees.sum += pair.nees;
    ++anees.count;
  }
  SetBand(pairs, Sighting::kVisible, anees);
  return anees;
}

TEST(AneesBand, CountsOnlyIndependentSamples) {
  Random random(20240611);
  const Anees white = BandOf(HonestErrors(random, 10, 600, 0.0, 1.0));
  EXPECT_NEAR(white.independent, 6000.0, 900.0);
  // A squared AR(1) forgets with keep^2: tau = (1 + keep^2) / (1 - keep^2) = 9.5 at 0.9.
  const Anees slow = BandOf(HonestErrors(random, 10, 600, 0.9, 1.0));
  EXPECT_NEAR(slow.independent, 6000.0 / 9.53, 250.0);
  EXPECT_GT(slow.high - slow.low, 2.0 * (white.high - white.low));
}

TEST(AneesBand, HoldsHonestRunsAndNotTooConfidentOnes) {
  Random random(7);
  int honest = 0, confident = 0;
  constexpr int kRuns = 200;
  for (int run = 0; run < kRuns; ++run) {
    honest += BandOf(HonestErrors(random, 8, 400, 0.9, 1.0)).is_in_band() ? 1 : 0;
    confident += BandOf(HonestErrors(random, 8, 400, 0.9, 1.3)).is_in_band() ? 1 : 0;
  }
  // Nominally 95 %; the number of independent samples is itself estimated.
  EXPECT_GE(honest, 175);
  EXPECT_LE(confident, 10);
}

TEST(AneesBand, OneTrackThatIsWrongForGoodWeighsLittle) {
  Random random(3);
  auto pairs = HonestErrors(random, 4, 400, 0.0, 1.0);
  const double before = BandOf(pairs).independent;
  for (MatchedPair& pair : pairs) {
    if (pair.object == 0) pair.nees += 30.0;
  }
  EXPECT_LT(BandOf(pairs).independent, 0.02 * before);
}

TEST(AneesBand, IsEmptyWithoutSamples) {
  EXPECT_EQ(AneesText(BandOf({})), "none");
  EXPECT_FALSE(BandOf({}).is_in_band());
}

}  // namespace
}  // namespace v2vouch::evaluation
