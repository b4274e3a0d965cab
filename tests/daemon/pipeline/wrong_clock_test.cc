// SPDX-License-Identifier: Apache-2.0
// What clocks, counters and gaps of single sources and of all of them do to the lists.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "daemon/pipeline/perception.h"
#include "tests/support/synthetic_drive.h"

namespace v2vouch {
namespace {

using testing::DriveStart;
using testing::MakeInputs;
using testing::SyntheticCar;
using testing::SyntheticDrive;

constexpr double kFrom_s = 4.0;

SyntheticDrive Traffic(double duration_s = 8.0) {
  SyntheticDrive drive;
  drive.duration_s = duration_s;
  drive.vehicle.radars.resize(3);
  drive.cars = {SyntheticCar{.x_m = 30.0, .y_m = 0.0, .speed_mps = 9.0, .sender = 11},
                SyntheticCar{.x_m = 45.0, .y_m = -3.5, .speed_mps = 8.5, .sender = 12}};
  return drive;
}

/// Ego motion 0, radars from 1 on, then cameras; -1: none of them.
int SourceOf(const Input& input) {
  if (std::holds_alternative<EgoMotion>(input)) return 0;
  if (const auto* scan = std::get_if<RadarScan>(&input)) return 1 + scan->radar;
  if (const auto* boxes = std::get_if<CameraDetections>(&input)) return 4 + boxes->camera;
  return -1;
}

MessageHeader& Header(Input& input) {
  return std::visit([](auto& message) -> MessageHeader& { return message; }, input);
}

double Seconds(const Input& input) { return ToSeconds(HeaderOf(input).stamp - DriveStart()); }

/// The drive with the stamps of own messages changed; order of arrival as it was.
std::vector<Input> Restamped(const std::vector<Input>& inputs,
                             const std::function<double(int source, double t)>& clock) {
  std::vector<Input> result = inputs;
  for (Input& input : result) {
    const int source = SourceOf(input);
    if (source < 0) continue;
    const double t = Seconds(input);
    Header(input).stamp += FromSeconds(clock(source, t) - t);
  }
  return result;
}

struct Seen {
  int lists = 0;
  double longest_gap_s = 0.0;  ///< Between two lists from 1 s on, of arrival.
  std::size_t local_at_end = 0;
  std::size_t priority_at_end = 0;
  std::set<std::uint64_t> local_ids;  ///< From 2 s on.
  std::set<std::uint64_t> priority_ids;
  int frozen = 0;  ///< Fresh lists without a later time or a revision.
  ReasonCounts refused{};
  std::vector<double> restarts_s;       ///< Arrival.
  double first_after_restart_s = -1.0;  ///< Arrival of the first list with the cars in it again.
};

Seen Feed(const SyntheticDrive& drive, const std::vector<Input>& inputs,
          const std::vector<Input>& arrivals) {
  PerceptionConfig config;
  config.vehicle = drive.vehicle;
  Perception perception(config, std::make_unique<NullBiasEstimator>());
  Outputs outputs;
  Seen seen;
  double last_s = 0.0;
  Timestamp stamp{};
  int revision = 0;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const double now_s = Seconds(arrivals[i]);
    perception.Step(inputs[i], outputs);
    for (const Diagnostic& diagnostic : outputs.diagnostics) {
      ++seen.refused[static_cast<std::size_t>(diagnostic.reason)];
      if (diagnostic.reason == Reason::kClockRestart) {
        seen.restarts_s.push_back(now_s);
        stamp = {};
      }
    }
    if (!outputs.has_lists) continue;
    ++seen.lists;
    if (now_s > 1.0) seen.longest_gap_s = std::max(seen.longest_gap_s, now_s - last_s);
    last_s = now_s;
    if (outputs.local.stamp <= stamp && outputs.local.revision <= revision) ++seen.frozen;
    stamp = outputs.local.stamp;
    revision = outputs.local.revision;
    seen.local_at_end = outputs.local.tracks.size();
    seen.priority_at_end = outputs.priority.tracks.size();
    if (now_s > 2.0) {
      for (const auto& line : outputs.local.tracks) seen.local_ids.insert(line.track.id);
      for (const auto& line : outputs.priority.tracks) seen.priority_ids.insert(line.track.id);
    }
    if (!seen.restarts_s.empty() && seen.first_after_restart_s < 0.0 &&
        outputs.local.tracks.size() >= drive.cars.size()) {
      seen.first_after_restart_s = now_s;
    }
  }
  seen.longest_gap_s = std::max(seen.longest_gap_s, drive.duration_s - last_s);
  return seen;
}

Seen FeedRestamped(const SyntheticDrive& drive,
                   const std::function<double(int source, double t)>& clock) {
  const auto inputs = MakeInputs(drive);
  return Feed(drive, Restamped(inputs, clock), inputs);
}

void ExpectUnharmed(const Seen& seen, const std::string& what) {
  EXPECT_EQ(seen.local_at_end, 2u) << what;
  EXPECT_EQ(seen.priority_at_end, 2u) << what;
  EXPECT_EQ(seen.local_ids.size(), 2u) << what;
  EXPECT_EQ(seen.priority_ids.size(), 2u) << what;
  EXPECT_LE(seen.longest_gap_s, 0.15) << what;
  EXPECT_EQ(seen.frozen, 0) << what;
  EXPECT_TRUE(seen.restarts_s.empty()) << what;
}

TEST(WrongClock, OfOneRadarOrCameraCostsNoListAndNoTrack) {
  const SyntheticDrive drive = Traffic();
  ExpectUnharmed(FeedRestamped(drive, [](int, double t) { return t; }), "good");
  for (const int wrong : {1, 2, 3, 4}) {
    for (const double off_s : {-3600.0, -1.0, -0.5, 0.6, 0.9, 37.0, 3.2e7}) {
      const Seen seen = FeedRestamped(drive, [=](int source, double t) {
        return source == wrong && t >= kFrom_s ? t + off_s : t;
      });
      ExpectUnharmed(seen, std::to_string(wrong) + " by " + std::to_string(off_s));
    }
    for (const double rate : {0.05, -0.05, -1.0}) {  // The last one: stuck.
      const Seen seen = FeedRestamped(drive, [=](int source, double t) {
        return source == wrong && t >= kFrom_s ? t + rate * (t - kFrom_s) : t;
      });
      ExpectUnharmed(seen, std::to_string(wrong) + " rate " + std::to_string(rate));
    }
  }
}

TEST(WrongClock, OfTheFirstSourceHeardIsFoundAtOnce) {
  const SyntheticDrive drive = Traffic();
  for (const int wrong : {1, 4}) {
    for (const double off_s : {-3600.0, 1.5, 37.0, 3600.0, 3.2e7}) {
      std::vector<Input> arrivals = MakeInputs(drive);
      const auto first = std::ranges::find(arrivals, wrong, SourceOf);
      std::rotate(arrivals.begin(), first, first + 1);
      const auto inputs = Restamped(
          arrivals, [=](int source, double t) { return source == wrong ? t + off_s : t; });
      const Seen seen = Feed(drive, inputs, arrivals);
      const std::string what = std::to_string(wrong) + " by " + std::to_string(off_s);
      EXPECT_EQ(seen.local_at_end, 2u) << what;
      EXPECT_LE(seen.longest_gap_s, 0.15) << what;
      for (const double at_s : seen.restarts_s) EXPECT_LE(at_s, 0.3) << what;
    }
  }
}

TEST(WrongClock, OfAllSteppingTogetherStartsAgainWithinHalfASecond) {
  const SyntheticDrive drive = Traffic();
  for (const double step_s : {-3.2e7, -86400.0, -3600.0, -2.0, -0.5, 5.0, 3600.0, 86400.0, 3.2e7}) {
    std::vector<Input> inputs = MakeInputs(drive);
    const std::vector<Input> arrivals = inputs;
    for (Input& input : inputs) {
      if (Seconds(input) < kFrom_s) continue;
      Header(input).stamp += FromSeconds(step_s);
      // What the senders tell of their time shall fit the new clock as it fitted the old one.
      if (auto* bsm = std::get_if<Bsm>(&input)) {
        if (bsm->generation) *bsm->generation += FromSeconds(step_s);
        if (bsm->sec_mark_ms) {
          const auto minute = std::int64_t{60'000};
          const auto moved = (*bsm->sec_mark_ms + std::llround(1e3 * step_s)) % minute;
          bsm->sec_mark_ms = static_cast<int>((moved + minute) % minute);
        }
      }
    }
    const Seen seen = Feed(drive, inputs, arrivals);
    ASSERT_EQ(seen.restarts_s.size(), 1u) << step_s;
    EXPECT_LE(seen.restarts_s[0], kFrom_s + 0.5) << step_s;
    EXPECT_GE(seen.first_after_restart_s, kFrom_s) << step_s;
    EXPECT_LE(seen.first_after_restart_s, kFrom_s + 1.5) << step_s;
    EXPECT_EQ(seen.local_at_end, 2u) << step_s;
    EXPECT_EQ(seen.priority_at_end, 2u) << step_s;
    EXPECT_EQ(seen.frozen, 0) << step_s;
  }
}

// Nothing of the car's own disagrees, so only the senders' time can show it.
TEST(WrongClock, OfTheWholeCarAgainstUtcIsTold) {
  const SyntheticDrive drive = Traffic(14.0);
  for (const double off_s : {-0.5, 0.0, 0.6, 2.5}) {
    PerceptionConfig config;
    config.vehicle = drive.vehicle;
    Perception perception(config, std::make_unique<NullBiasEstimator>());
    Outputs outputs;
    for (Input input : MakeInputs(drive)) {
      if (auto* bsm = std::get_if<Bsm>(&input)) {
        if (!bsm->sec_mark_ms && !bsm->generation) bsm->generation = bsm->stamp;
      }
      Header(input).stamp += FromSeconds(off_s);
      perception.Step(input, outputs);
    }
    std::vector<Notice> notices;
    perception.CollectNotices(notices);
    const NoticeSubject radio{NoticeSubject::Kind::kV2v, 0};
    std::erase_if(notices, [&](const Notice& notice) { return notice.subject != radio; });
    if (off_s == 0.0) {
      EXPECT_TRUE(notices.empty());
      continue;
    }
    ASSERT_EQ(notices.size(), 1u) << off_s;
    EXPECT_EQ(notices[0].kind, off_s > 0.0 ? NoticeKind::kClockBehind : NoticeKind::kClockAhead);
    EXPECT_NEAR(notices[0].value, std::abs(off_s), 0.2);
  }
}

// The scans of half a second to ten seconds at once, after a hung bridge.
TEST(WrongClock, ABacklogOfOneSensorCostsNoTrackAndNoTrust) {
  const SyntheticDrive drive = Traffic();
  for (const int wrong : {1, 2, 4}) {
    for (const double held_s : {0.5, 1.25, 3.0}) {
      std::vector<Input> arrivals;
      std::vector<Input> held;
      for (const Input& input : MakeInputs(drive)) {
        const double t = Seconds(input);
        if (SourceOf(input) == wrong && t >= kFrom_s && t < kFrom_s + held_s) {
          held.push_back(input);
          continue;
        }
        if (t >= kFrom_s + held_s && !held.empty()) {
          arrivals.insert(arrivals.end(), held.begin(), held.end());
          held.clear();
        }
        arrivals.push_back(input);
      }
      const Seen seen = Feed(drive, arrivals, arrivals);
      const std::string what = std::to_string(wrong) + " " + std::to_string(held_s);
      EXPECT_EQ(seen.local_ids.size(), 2u) << what;
      EXPECT_EQ(seen.priority_ids.size(), 2u) << what;
      EXPECT_EQ(seen.priority_at_end, 2u) << what;
      EXPECT_TRUE(seen.restarts_s.empty()) << what;
    }
  }
}

TEST(Counters, ThatStandOrCountModuloLoseNothing) {
  const SyntheticDrive drive = Traffic();
  const std::vector<Input> good = MakeInputs(drive);
  const Seen expected = Feed(drive, good, good);
  for (const std::int64_t modulus : {1, 2, 4, 16}) {
    std::vector<Input> inputs = good;
    for (Input& input : inputs) {
      if (!std::holds_alternative<Bsm>(input)) Header(input).seq %= modulus;
    }
    const Seen seen = Feed(drive, inputs, good);
    ExpectUnharmed(seen, std::to_string(modulus));
    EXPECT_EQ(seen.lists, expected.lists) << modulus;
    EXPECT_EQ(seen.refused, expected.refused) << modulus;
  }
}

// Equal stamps happen: two half scans, or a coarse clock. Their tracks must not share an id.
TEST(Counters, TwoMessagesOfOneStampAreBothTaken) {
  SyntheticDrive drive = Traffic();
  std::vector<Input> inputs;
  for (const Input& input : MakeInputs(drive)) {
    inputs.push_back(input);
    const auto* scan = std::get_if<RadarScan>(&input);
    if (scan == nullptr) continue;
    RadarScan second = *scan;
    second.seq += 1'000'000;
    inputs.emplace_back(second);
  }
  const Seen seen = Feed(drive, inputs, inputs);
  EXPECT_EQ(seen.refused[static_cast<std::size_t>(Reason::kDuplicate)], 0u);
  EXPECT_EQ(seen.local_at_end, 2u);
}

// Without ego motion frames mean nothing: no list goes out that looks fresh and stands still.
TEST(Silence, OfEgoMotionEndsTheListsInsteadOfFreezingThem) {
  const SyntheticDrive drive = Traffic();
  std::vector<Input> inputs;
  for (const Input& input : MakeInputs(drive)) {
    if (SourceOf(input) == 0 && Seconds(input) >= kFrom_s && Seconds(input) < 6.0) continue;
    inputs.push_back(input);
  }
  const Seen seen = Feed(drive, inputs, inputs);
  EXPECT_EQ(seen.frozen, 0);
  EXPECT_GT(seen.refused[static_cast<std::size_t>(Reason::kNoEgoMotion)], 50u);
  EXPECT_LE(seen.longest_gap_s, 1.6);
  EXPECT_EQ(seen.local_at_end, 2u);
}

// A gap stays a gap: who drives as fast as the ego stays as far ahead of it.
TEST(Silence, OfAllLetsTheEgoDriveOnAndGrowsTheDoubt) {
  SyntheticDrive drive = Traffic();
  drive.cars[0].speed_mps = drive.ego_speed_mps;
  PerceptionConfig config;
  config.vehicle = drive.vehicle;
  Perception perception(config, std::make_unique<NullBiasEstimator>());
  Outputs outputs;
  for (const Input& input : MakeInputs(drive)) perception.Step(input, outputs);
  double last_sigma_m = 0.0;
  double first_gap_m = -1.0;
  for (const double after_s : {0.1, 0.3, 0.5, 0.7, 0.9, 1.0}) {
    perception.PredictedLists(perception.newest_frame() + FromSeconds(after_s), outputs);
    ASSERT_TRUE(outputs.has_lists);
    EXPECT_TRUE(outputs.local.stale && outputs.priority.stale);
    for (const TrackList* list : {&outputs.local, &outputs.priority}) {
      ASSERT_EQ(list->tracks.size(), 2u) << after_s;
      const auto lead = std::ranges::min_element(list->tracks, {}, [](const PublishedTrack& line) {
        return std::abs(line.track.state_O.mean[kY]);
      });
      const Point<Body> p_B = list->X_OB.Inverse() * Point<Odometry>{lead->track.state_O.mean[kX],
                                                                     lead->track.state_O.mean[kY]};
      if (first_gap_m < 0.0) first_gap_m = p_B.x_m;
      EXPECT_NEAR(p_B.x_m, first_gap_m, 1.0) << after_s;
      if (list == &outputs.local) {
        const double sigma_m = std::sqrt(lead->track.state_O.covariance(kX, kX));
        EXPECT_GT(sigma_m, last_sigma_m);
        last_sigma_m = sigma_m;
      }
    }
  }
  EXPECT_GT(last_sigma_m, 0.9);
  perception.PredictedLists(perception.newest_frame() + FromSeconds(1.1), outputs);
  EXPECT_TRUE(outputs.local.tracks.empty());
  EXPECT_TRUE(outputs.priority.tracks.empty());
}

// Everything late by the agreed time beyond the budget is refused; what is on time never is.
TEST(Work, ThatLateDataCauseIsBounded) {
  const SyntheticDrive drive = Traffic();
  PerceptionConfig config;
  config.vehicle = drive.vehicle;
  config.timeline.rerun_budget = 100.0;
  Perception perception(config, std::make_unique<NullBiasEstimator>());
  // The camera's pictures come 0.5 s late: ten a second, each before some thirty frames.
  std::vector<std::pair<double, Input>> arrivals;
  for (const Input& input : MakeInputs(drive)) {
    arrivals.emplace_back(Seconds(input) + (SourceOf(input) == 4 ? 0.5 : 0.0), input);
  }
  std::ranges::stable_sort(arrivals, {}, &std::pair<double, Input>::first);
  Outputs outputs;
  int refused = 0;
  int pictures = 0;
  for (const auto& [at_s, input] : arrivals) {
    perception.Step(input, outputs);
    pictures += SourceOf(input) == 4 ? 1 : 0;
    for (const Diagnostic& diagnostic : outputs.diagnostics) {
      if (diagnostic.reason != Reason::kOverBudget) continue;
      ++refused;
      EXPECT_EQ(SourceOf(input), 4);
    }
  }
  EXPECT_GT(refused, pictures / 2);
  EXPECT_LT(refused, pictures);
}

}  // namespace
}  // namespace v2vouch
