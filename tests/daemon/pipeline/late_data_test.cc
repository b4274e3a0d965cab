// SPDX-License-Identifier: Apache-2.0
// What late messages cost, counted in steps, and that no order of arrival changes the state.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <map>
#include <memory>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "daemon/common/base/random.h"
#include "daemon/pipeline/perception.h"
#include "daemon/pipeline/timeline.h"
#include "daemon/v2v/gps_bias/gps_bias.h"
#include "tests/support/synthetic_drive.h"

namespace v2vouch {
namespace {

using testing::DriveStart;
using testing::MakeInputs;
using testing::SyntheticCar;
using testing::SyntheticDrive;

/// Two radars, a camera, ego motion, GNSS and two talking cars.
SyntheticDrive Traffic(double duration_s) {
  SyntheticDrive drive;
  drive.duration_s = duration_s;
  drive.vehicle.radars.resize(2);
  drive.cars = {
      SyntheticCar{.x_m = 30.0, .y_m = 0.0, .speed_mps = 9.0, .sender = 11},
      SyntheticCar{.x_m = 70.0, .y_m = 3.5, .yaw_rad = kPi, .speed_mps = 5.0},
      SyntheticCar{.x_m = 45.0, .y_m = -3.5, .speed_mps = 8.5, .sender = 12},
  };
  return drive;
}

PerceptionConfig ConfigOf(const SyntheticDrive& drive) {
  PerceptionConfig config;
  config.vehicle = drive.vehicle;
  return config;
}

bool IsFrame(const Input& input) {
  return std::holds_alternative<RadarScan>(input) ||
         std::holds_alternative<CameraDetections>(input);
}

/// The agreed time, where no source is wrong: the newest stamp so far.
class Newest {
 public:
  Timestamp Hear(Timestamp stamp) { return newest_ = std::max(newest_, stamp); }

 private:
  Timestamp newest_{};
};

std::optional<TimelineInput> ForTimeline(const Input& input) {
  if (const auto* motion = std::get_if<EgoMotion>(&input)) return TimelineInput(*motion);
  if (const auto* fix = std::get_if<GnssFix>(&input)) return TimelineInput(*fix);
  if (const auto* scan = std::get_if<RadarScan>(&input)) return TimelineInput(*scan);
  if (const auto* boxes = std::get_if<CameraDetections>(&input)) return TimelineInput(*boxes);
  return std::nullopt;
}

// A frame costs one step of LOCAL, and one more for each frame that is later than it: never a frame
// that lies before it. Nothing from outside costs LOCAL a step.
TEST(LateData, AFrameCostsItselfAndTheFramesAfterIt) {
  const SyntheticDrive drive = Traffic(3.0);
  const auto inputs = MakeInputs(drive);
  for (const double delay_s : {0.0, 0.05, 0.15, 0.3, 0.6}) {
    // Every picture comes late, each by the same time.
    std::vector<std::pair<Timestamp, Input>> arrivals;
    for (const Input& input : inputs) {
      const bool is_late = std::holds_alternative<CameraDetections>(input);
      arrivals.emplace_back(HeaderOf(input).stamp + FromSeconds(is_late ? delay_s : 0.0), input);
    }
    std::stable_sort(arrivals.begin(), arrivals.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    Timeline timeline(ConfigOf(drive));
    Outputs outputs;
    Newest newest;
    std::vector<EventKey> frames;
    int most = 0;
    for (const auto& [arrival, input] : arrivals) {
      auto event = ForTimeline(input);
      if (!event) continue;
      const EventKey key = KeyOf(*event);
      const auto later = static_cast<int>(
          std::count_if(frames.begin(), frames.end(), [&](const EventKey& k) { return k > key; }));
      const Timeline::Placement placement = timeline.Insert(*event, newest.Hear(key.time), outputs);
      ASSERT_FALSE(placement.refusal);
      if (IsFrame(input)) {
        ASSERT_EQ(placement.local_frames, later + 1) << delay_s;
        ASSERT_EQ(placement.is_correction, later > 0);
        frames.push_back(key);
        most = std::max(most, placement.local_frames);
      } else {
        ASSERT_EQ(placement.local_frames, 0);
      }
    }
    // Two radars at 20 Hz and pictures at 10 Hz: 50 frames a second.
    EXPECT_GE(most, 1 + static_cast<int>(40.0 * delay_s));
    EXPECT_LE(most, 3 + static_cast<int>(50.0 * delay_s));
  }
}

TEST(LateData, ALateFixStepsTheV2vSideAlone) {
  const SyntheticDrive drive = Traffic(2.0);
  Timeline timeline(ConfigOf(drive));
  Outputs outputs;
  Newest newest;
  std::optional<GnssFix> held;
  int frames_since = 0;
  for (const Input& input : MakeInputs(drive)) {
    const auto* fix = std::get_if<GnssFix>(&input);
    if (fix != nullptr && !held && fix->seq == 10) {
      held = *fix;
      continue;
    }
    if (held && IsFrame(input)) ++frames_since;
    const auto event = ForTimeline(input);
    if (event) timeline.Insert(*event, newest.Hear(HeaderOf(input).stamp), outputs);
    if (!held || frames_since < 12) continue;
    const Timeline::Placement placement = timeline.Insert(*held, newest.Hear(held->stamp), outputs);
    EXPECT_EQ(placement.local_frames, 0);
    // Itself, twelve frames, two or three later fixes, and what lies between it and the last
    // checkpoint before it.
    EXPECT_GE(placement.v2v_events, 13);
    EXPECT_LE(placement.v2v_events, 18);
    return;
  }
  FAIL() << "the drive is too short";
}

// A radio that is read a little late, be it for a flood: each of its messages lies before the
// newest frame. The V2V side is re-run once per frame, not once per message.
TEST(LateData, LateClaimsAreRunTogetherWithTheNextFrame) {
  const SyntheticDrive drive = Traffic(2.0);
  for (const double late_s : {0.0, 0.03, 0.3}) {
    Timeline timeline(ConfigOf(drive));
    Outputs outputs;
    Newest newest;
    int tried = 0;
    int claims = 0;
    int frames = 0;
    int steps = 0;
    Timestamp next = DriveStart();
    for (const Input& input : MakeInputs(drive)) {
      // 2000 claims a second, in order among themselves.
      for (; next <= HeaderOf(input).stamp; next += FromSeconds(0.0005)) {
        Claim claim;
        claim.sender = static_cast<SenderId>(100 + tried % 200);
        claim.received = next - FromSeconds(late_s);
        const auto placement =
            timeline.Insert(TimedClaim{claim, tried, std::nullopt}, newest.Hear(next), outputs);
        steps += placement.v2v_events;
        if (!placement.refusal) ++claims;
        ++tried;
      }
      const auto event = ForTimeline(input);
      if (!event) continue;
      steps += timeline.Insert(*event, newest.Hear(HeaderOf(input).stamp), outputs).v2v_events;
      if (IsFrame(input)) ++frames;
    }
    EXPECT_GT(claims, 2500);
    // A re-run covers the time by which they are late, a frame's period and the way back to a
    // checkpoint: 50 frames and 2000 claims a second.
    const double per_frame = 2050.0 * (late_s + 0.06);
    EXPECT_LE(steps, claims + frames * per_frame) << late_s;
  }
}

// One that is 0.3 s late in the middle of 2000 a second would have 600 run again.
TEST(LateData, AClaimFarBackAmongManyIsRefusedAndCounted) {
  const SyntheticDrive drive = Traffic(1.0);
  Timeline timeline(ConfigOf(drive));
  Outputs outputs;
  Newest newest;
  Claim claim;
  Timestamp next = DriveStart() + FromSeconds(0.1);
  for (const Input& input : MakeInputs(drive)) {
    const auto event = ForTimeline(input);
    if (event) timeline.Insert(*event, newest.Hear(HeaderOf(input).stamp), outputs);
    for (; next <= HeaderOf(input).stamp; next += FromSeconds(0.0005)) {
      claim.received = next;
      timeline.Insert(TimedClaim{claim, 0, std::nullopt}, newest.Hear(next), outputs);
    }
  }
  outputs.Clear();
  claim.received = next - FromSeconds(0.3);
  EXPECT_TRUE(timeline.Insert(TimedClaim{claim, 1, std::nullopt}, next, outputs).refusal);
  ASSERT_EQ(outputs.diagnostics.size(), 1u);
  EXPECT_EQ(outputs.diagnostics[0].reason, Reason::kOverBudget);
  claim.received = next - FromSeconds(0.03);
  EXPECT_FALSE(timeline.Insert(TimedClaim{claim, 2, std::nullopt}, next, outputs).refusal);
}

// An ego sample in order, or late but newer than every frame, costs no frame at all.
TEST(LateData, AnEgoSampleReRunsOnlyFramesAfterIt) {
  const SyntheticDrive drive = Traffic(2.0);
  Timeline timeline(ConfigOf(drive));
  Outputs outputs;
  Newest newest;
  std::optional<EgoMotion> held;
  std::vector<Timestamp> frames;
  int tried = 0;
  for (const Input& input : MakeInputs(drive)) {
    const auto* motion = std::get_if<EgoMotion>(&input);
    if (motion != nullptr && motion->seq % 10 == 9 && !held) {
      held = *motion;
      continue;
    }
    if (const auto event = ForTimeline(input)) {
      timeline.Insert(*event, newest.Hear(HeaderOf(input).stamp), outputs);
    }
    if (IsFrame(input)) frames.push_back(HeaderOf(input).stamp);
    if (!held || HeaderOf(input).stamp < held->stamp + FromSeconds(0.015 * (tried % 4))) continue;
    const auto later = std::count_if(frames.begin(), frames.end(),
                                     [&](Timestamp stamp) { return stamp >= held->stamp; });
    EXPECT_EQ(timeline.Insert(*held, newest.Hear(held->stamp), outputs).local_frames, later);
    held.reset();
    ++tried;
  }
  EXPECT_GE(tried, 8);
}

// Every bit of a list's tracks.
std::string Bits(const TrackList& list) {
  std::string bits;
  const auto add = [&bits](const auto& value) {
    bits.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  add(list.stamp);
  add(list.X_OB);
  for (const PublishedTrack& line : list.tracks) {
    add(line.track.id);
    bits.append(reinterpret_cast<const char*>(line.track.state_O.mean.data()), 6 * sizeof(double));
    bits.append(reinterpret_cast<const char*>(line.track.state_O.covariance.data()),
                36 * sizeof(double));
    add(line.track.existence);
    add(line.track.extent.length_m);
    add(line.track.extent.width_m);
    add(line.track.visibility);
    add(line.track.radar_hits());
    add(line.track.camera_hits());
    add(line.local_id);
    add(line.sender);
    add(line.trust);
    add(line.bias_east_m);
    add(line.bias_north_m);
  }
  return bits;
}

struct State {
  std::string local, priority;
  std::size_t local_tracks = 0, priority_tracks = 0;
  ReasonCounts refused{};
};

/// The state after all inputs, shown by one more empty scan when all is in place.
State Feed(const SyntheticDrive& drive, const std::vector<Input>& inputs,
           std::unique_ptr<BiasEstimator> bias = std::make_unique<NullBiasEstimator>()) {
  Perception perception(ConfigOf(drive), std::move(bias));
  Outputs outputs;
  State state;
  const auto step = [&](const Input& input) {
    perception.Step(input, outputs);
    for (const Diagnostic& diagnostic : outputs.diagnostics) {
      ++state.refused[static_cast<std::size_t>(diagnostic.reason)];
    }
  };
  for (const Input& input : inputs) step(input);
  RadarScan last;
  last.stamp = DriveStart() + FromSeconds(drive.duration_s + 0.1);
  last.seq = 99'999;
  step(last);
  EXPECT_TRUE(outputs.has_lists);
  state.local = Bits(outputs.local);
  state.priority = Bits(outputs.priority);
  state.local_tracks = outputs.local.tracks.size();
  state.priority_tracks = outputs.priority.tracks.size();
  return state;
}

/// Inputs in windows of `window_s`, each window in a random order of its own, Fisher-Yates. BSMs
/// keep their order among themselves: one radio receives them, and the intake is a function of its
/// stream. The first half second is left alone.
std::vector<Input> Permuted(const std::vector<Input>& inputs, double window_s, Random& random) {
  std::vector<Input> result;
  for (std::size_t begin = 0; begin < inputs.size();) {
    const auto window_of = [&](const Input& input) {
      return static_cast<int>(ToSeconds(HeaderOf(input).stamp - DriveStart()) / window_s);
    };
    std::size_t end = begin;
    while (end < inputs.size() && window_of(inputs[end]) == window_of(inputs[begin])) ++end;
    std::vector<Input> window(inputs.begin() + static_cast<std::ptrdiff_t>(begin),
                              inputs.begin() + static_cast<std::ptrdiff_t>(end));
    std::vector<Input> radio;
    std::ranges::copy_if(window, std::back_inserter(radio),
                         [](const Input& input) { return std::holds_alternative<Bsm>(input); });
    if (ToSeconds(HeaderOf(window.front()).stamp - DriveStart()) > 0.5) {
      for (std::size_t i = window.size(); i > 1; --i) {
        const auto j = static_cast<std::size_t>(random.Uniform() * static_cast<double>(i));
        std::swap(window[i - 1], window[std::min(j, i - 1)]);
      }
      std::size_t next = 0;
      for (Input& input : window) {
        if (std::holds_alternative<Bsm>(input)) input = radio[next++];
      }
    }
    result.insert(result.end(), window.begin(), window.end());
    begin = end;
  }
  return result;
}

// Property: the state is a function of the set of inputs, whatever their order within the buffer.
TEST(LateDataProperty, EveryPermutationWithinTheBufferEndsInTheSameBits) {
  const SyntheticDrive drive = Traffic(3.0);
  const auto in_order = MakeInputs(drive);
  const State expected = Feed(drive, in_order);
  ASSERT_EQ(expected.local_tracks, 3u);
  ASSERT_EQ(expected.priority_tracks, 2u);
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Random random(seed);
    const double window_s = random.Uniform(0.05, 0.45);
    const State state = Feed(drive, Permuted(in_order, window_s, random));
    EXPECT_TRUE(state.local == expected.local) << "seed " << seed << ", window " << window_s;
    EXPECT_TRUE(state.priority == expected.priority) << "seed " << seed << ", window " << window_s;
    EXPECT_EQ(state.refused[static_cast<std::size_t>(Reason::kTooOld)], 0u) << seed;
    EXPECT_EQ(state.refused[static_cast<std::size_t>(Reason::kDuplicate)], 0u) << seed;
  }
}

// What each message was told of its sender's bias, by sender and time.
using Told = std::map<std::pair<SenderId, Timestamp>, Eigen::Vector3d>;

// GpsBias, overheard.
class OverheardBias final : public BiasEstimator {
 public:
  explicit OverheardBias(Told& told) : told_(told) {}
  void Observe(const BiasResidual& residual) override { bias_.Observe(residual); }
  void AdvanceTo(Timestamp settled) override { bias_.AdvanceTo(settled); }
  [[nodiscard]] std::optional<BiasEstimate> Estimate(SenderId sender, Timestamp at) const override {
    const auto estimate = bias_.Estimate(sender, at);
    if (estimate) {
      told_[{sender, at}] << estimate->mean_en, estimate->covariance.determinant();
    }
    return estimate;
  }
  [[nodiscard]] const BiasReport& report() const override { return bias_.report(); }
  void Restart() override { bias_.Restart(); }

 private:
  GpsBias bias_{GpsBiasConfig{}};
  Told& told_;
};

// The bias estimator is never rolled back, so what it tells of a message must not depend on how
// much had been settled when that message came.
TEST(LateDataProperty, EveryPermutationWithinTheBufferFindsTheSameBiases) {
  const SyntheticDrive drive = Traffic(7.0);
  const auto in_order = MakeInputs(drive);
  Told expected;
  const State state_in_order = Feed(drive, in_order, std::make_unique<OverheardBias>(expected));
  ASSERT_GT(expected.size(), 30u);
  EXPECT_EQ(state_in_order.local, Feed(drive, in_order).local);
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Random random(seed);
    const double window_s = random.Uniform(0.05, 0.45);
    Told told;
    const State state =
        Feed(drive, Permuted(in_order, window_s, random), std::make_unique<OverheardBias>(told));
    EXPECT_TRUE(told == expected) << "seed " << seed << ", window " << window_s;
    EXPECT_TRUE(state.local == state_in_order.local) << "seed " << seed;
    EXPECT_TRUE(state.priority == state_in_order.priority) << "seed " << seed;
  }
}

// A sensor that is always too late is as good as absent, and every frame of it is counted.
TEST(LateData, FramesOlderThanTheBufferAreCountedAndChangeNothing) {
  const SyntheticDrive drive = Traffic(3.0);
  const auto inputs = MakeInputs(drive);
  std::vector<Input> without, late, held;
  for (const Input& input : inputs) {
    if (std::holds_alternative<CameraDetections>(input)) {
      held.push_back(input);
    } else {
      without.push_back(input);
    }
  }
  const PerceptionConfig config;
  const Duration delay = FromSeconds(config.timeline.replay_buffer_s + 0.2);
  std::size_t next = 0;
  std::size_t sent = 0;
  for (const Input& input : without) {
    for (; next < held.size() && HeaderOf(held[next]).stamp + delay < HeaderOf(input).stamp;
         ++next, ++sent) {
      late.push_back(held[next]);
    }
    late.push_back(input);
  }
  ASSERT_GT(sent, 10u);
  const State expected = Feed(drive, without);
  const State state = Feed(drive, late);
  EXPECT_EQ(state.refused[static_cast<std::size_t>(Reason::kTooOld)], sent);
  EXPECT_TRUE(state.local == expected.local);
  EXPECT_TRUE(state.priority == expected.priority);
}

// Twenty scans, each before the last, have used up the work that one second allows. What is left a
// while later is a matter of own time: it must not depend on whether a claim came in between.
bool IsShortAfterAWhile(bool has_claim) {
  PerceptionConfig config;
  config.timeline.rerun_budget = 100.0;
  Timeline timeline(config);
  Outputs outputs;
  EgoMotion ego;
  ego.stamp = DriveStart();
  ego.speed_mps = 8.0;
  timeline.Insert(ego, ego.stamp, outputs);
  for (int i = 19; i > 0; --i) {
    RadarScan scan;
    scan.stamp = DriveStart() + FromSeconds(0.001 * i);
    timeline.Insert(scan, DriveStart(), outputs);
  }
  EXPECT_TRUE(timeline.is_short_of_work());
  if (has_claim) {
    TimedClaim timed;
    timed.claim.received = DriveStart() + FromSeconds(0.7);
    timed.claim.sender = 1;
    timeline.Insert(timed, timed.claim.received, outputs);
  }
  ego.stamp = DriveStart() + FromSeconds(1.4);
  ++ego.seq;
  timeline.Insert(ego, ego.stamp, outputs);
  return timeline.is_short_of_work();
}

TEST(Work, ThatLateDataMayCauseDoesNotDependOnClaims) {
  EXPECT_EQ(IsShortAfterAWhile(true), IsShortAfterAWhile(false));
}

}  // namespace
}  // namespace v2vouch
