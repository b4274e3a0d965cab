// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/perception.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <string>

#include "daemon/common/base/random.h"
#include "tests/support/synthetic_drive.h"

namespace v2vouch {
namespace {

using testing::DriveStart;
using testing::MakeInputs;
using testing::SyntheticCar;
using testing::SyntheticDrive;

SyntheticDrive Traffic() {
  SyntheticDrive drive;
  drive.cars = {
      SyntheticCar{.x_m = 30.0, .y_m = 0.0, .speed_mps = 9.0, .sender = 11},
      SyntheticCar{.x_m = 90.0, .y_m = 3.5, .yaw_rad = kPi, .speed_mps = 6.0},
      SyntheticCar{.x_m = 55.0, .y_m = -3.5, .speed_mps = 8.5, .sender = 12},
  };
  return drive;
}

// Every bit of a list, as text; sequence numbers count lists and are left out where runs may differ
// in how many lists they give.
std::string Bits(const TrackList& list, bool with_counts) {
  std::string bits;
  const auto add = [&bits](const auto& value) {
    bits.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  add(list.stamp);
  if (with_counts) {
    add(list.seq);
    add(list.revision);
  }
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
    add(line.local_id);
    add(line.sender);
    add(line.trust);
  }
  return bits;
}

struct Drive {
  std::string local, priority;  // All lists, every bit.
  TrackList last_local, last_priority;
  ReasonCounts refused{};
  std::size_t most_priority_tracks = 0;
  std::vector<MisbehaviorReport> reports;
};

Drive Feed(const std::vector<Input>& inputs, const PerceptionConfig& config = {}) {
  Perception perception(config, std::make_unique<NullBiasEstimator>());
  Outputs outputs;
  Drive run;
  for (const Input& input : inputs) {
    perception.Step(input, outputs);
    for (const Diagnostic& diagnostic : outputs.diagnostics) {
      ++run.refused[static_cast<std::size_t>(diagnostic.reason)];
    }
    run.reports.insert(run.reports.end(), outputs.reports.begin(), outputs.reports.end());
    if (!outputs.has_lists) continue;
    run.local += Bits(outputs.local, true);
    run.priority += Bits(outputs.priority, true);
    run.last_local = outputs.local;
    run.last_priority = outputs.priority;
    run.most_priority_tracks = std::max(run.most_priority_tracks, outputs.priority.tracks.size());
  }
  return run;
}

std::uint64_t Count(const Drive& run, Reason reason) {
  return run.refused[static_cast<std::size_t>(reason)];
}

TEST(Perception, SeesAllCarsAndVouchesForThoseThatTalk) {
  SyntheticDrive drive = Traffic();
  drive.duration_s = 5.0;  // Then the oncoming car is still ahead.
  const Drive run = Feed(MakeInputs(drive));
  EXPECT_EQ(run.last_local.tracks.size(), 3u);
  ASSERT_EQ(run.last_priority.tracks.size(), 2u);
  EXPECT_NE(run.last_priority.tracks[0].sender, run.last_priority.tracks[1].sender);
  for (const PublishedTrack& line : run.last_priority.tracks) {
    EXPECT_EQ(line.trust, TrustState::kValidated);
    EXPECT_NE(line.local_id, 0u);
  }
}

TEST(Perception, TheSameInputsGiveTheSameBits) {
  const auto inputs = MakeInputs(Traffic());
  const Drive first = Feed(inputs);
  const Drive second = Feed(inputs);
  EXPECT_TRUE(first.local == second.local);
  EXPECT_TRUE(first.priority == second.priority);
}

TEST(Perception, NoBsmAndNoGnssChangesABitOfLocal) {
  SyntheticDrive drive = Traffic();
  const auto inputs = MakeInputs(drive);
  const Drive all = Feed(inputs);
  std::vector<Input> own;
  std::copy_if(inputs.begin(), inputs.end(), std::back_inserter(own), [](const Input& input) {
    return !std::holds_alternative<Bsm>(input) && !std::holds_alternative<GnssFix>(input);
  });
  EXPECT_TRUE(all.local == Feed(own).local);

  drive.gnss_jump_at_s = 5.0;
  EXPECT_TRUE(all.local == Feed(MakeInputs(drive)).local);

  // Nor a radio that is ahead of us in time, which could push our own frames out of the buffer.
  std::vector<Input> ahead = inputs;
  for (Input& input : ahead) {
    if (auto* bsm = std::get_if<Bsm>(&input)) bsm->stamp += FromSeconds(0.9);
  }
  EXPECT_TRUE(all.local == Feed(ahead).local);
}

SyntheticDrive Ghosts() {
  SyntheticDrive drive;
  for (int i = 0; i < 8; ++i) {
    drive.cars.push_back(SyntheticCar{.x_m = 20.0 + 25.0 * i,
                                      .y_m = i % 2 == 0 ? 0.0 : 15.0,
                                      .speed_mps = 8.0,
                                      .sender = static_cast<SenderId>(i + 1),
                                      .is_real = false});
  }
  return drive;
}

TEST(Perception, AGhostThatOnlyTalksIsNeverListed) {
  const Drive run = Feed(MakeInputs(Ghosts()));
  EXPECT_TRUE(run.last_local.tracks.empty());
  EXPECT_EQ(run.most_priority_tracks, 0u);
}

// Any arrival order inside the replay buffer ends in the same state, bit for bit.
// In order of arrival: BSMs late by 0.2 s in their order, everything else by up to 0.3 s.
std::vector<Input> Shuffled(const std::vector<Input>& in_order, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::pair<Timestamp, Input>> arrivals;
  for (const Input& input : in_order) {
    const Timestamp stamp = HeaderOf(input).stamp;
    const bool is_early = ToSeconds(stamp - DriveStart()) < 0.5;
    const bool is_bsm = std::holds_alternative<Bsm>(input);
    const double delay = is_early ? 0.0 : is_bsm ? 0.2 : random.Uniform(0.0, 0.3);
    arrivals.emplace_back(stamp + FromSeconds(delay), input);
  }
  std::stable_sort(arrivals.begin(), arrivals.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Input> shuffled;
  for (auto& arrival : arrivals) shuffled.push_back(arrival.second);
  return shuffled;
}

// Far strangers are none of its business; this one is not.
TEST(Perception, AValidatedSenderThatIsSuddenlyFarAwayIsWithdrawnOnce) {
  SyntheticDrive drive = Traffic();
  auto inputs = MakeInputs(drive);
  for (Input& input : inputs) {
    auto* bsm = std::get_if<Bsm>(&input);
    if (bsm == nullptr || bsm->sender != 11) continue;
    if (bsm->stamp < DriveStart() + FromSeconds(5.0)) continue;
    bsm->latitude_rad = *bsm->latitude_rad + 600.0 / 6.37e6;
  }
  for (std::uint64_t seed = 0; seed <= 8; ++seed) {
    const Drive run = Feed(seed == 0 ? inputs : Shuffled(inputs, seed));
    const auto withdrawals = std::ranges::count_if(run.reports, [](const MisbehaviorReport& one) {
      return one.sender == 11u && one.verdict == Verdict::kWithdraw &&
             one.stamp < DriveStart() + FromSeconds(6.0);
    });
    EXPECT_EQ(withdrawals, 1) << seed;  // Late frames or none.
    EXPECT_TRUE(std::ranges::none_of(run.last_priority.tracks,
                                     [](const auto& line) { return line.sender == 11u; }));
  }
}

// A late frame moves a verdict to another moment; it was told already.
TEST(Perception, AVerdictIsToldOnceThoughLateFramesMoveIt) {
  const SyntheticDrive drive = Ghosts();
  int told = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const Drive run = Feed(Shuffled(MakeInputs(drive), seed));
    for (std::size_t i = 0; i < run.reports.size(); ++i) {
      ++told;
      for (std::size_t j = 0; j < i; ++j) {
        const MisbehaviorReport& one = run.reports[i];
        const MisbehaviorReport& other = run.reports[j];
        if (one.sender != other.sender || one.verdict != other.verdict) continue;
        EXPECT_GT(std::abs(ToSeconds(one.stamp - other.stamp)), 0.5) << seed << " " << one.sender;
      }
    }
  }
  EXPECT_GT(told, 8);
}

TEST(PerceptionProperty, ArrivalOrderWithinTheBufferDoesNotMatter) {
  SyntheticDrive drive = Traffic();
  drive.duration_s = 4.0;
  const auto in_order = MakeInputs(drive);
  const Drive reference = Feed(in_order);
  ASSERT_FALSE(reference.last_local.tracks.empty());
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    std::vector<Input> shuffled = Shuffled(in_order, seed);
    // One more frame after the dust has settled shows the state.
    RadarScan last;
    last.stamp = DriveStart() + FromSeconds(drive.duration_s + 0.1);
    last.seq = 999;
    auto ordered = in_order;
    ordered.emplace_back(last);
    shuffled.emplace_back(last);
    const Drive expected = Feed(ordered);
    const Drive run = Feed(shuffled);
    EXPECT_EQ(Count(run, Reason::kTooOld), 0u);
    EXPECT_TRUE(Bits(run.last_local, false) == Bits(expected.last_local, false)) << seed;
    EXPECT_TRUE(Bits(run.last_priority, false) == Bits(expected.last_priority, false)) << seed;
  }
}

TEST(Perception, PublishedTimeNeverGoesBackAndLateFramesRaiseTheRevision) {
  const auto inputs = MakeInputs(Traffic());
  std::vector<Input> late;
  std::optional<Input> held;
  for (const Input& input : inputs) {
    // Every fourth picture comes after the next radar frames.
    const auto* boxes = std::get_if<CameraDetections>(&input);
    if (boxes != nullptr && boxes->seq % 4 == 0) {
      held = input;
      continue;
    }
    late.push_back(input);
    if (held && HeaderOf(input).stamp > HeaderOf(*held).stamp + FromSeconds(0.2)) {
      late.push_back(*held);
      held.reset();
    }
  }
  Perception perception(PerceptionConfig{}, std::make_unique<NullBiasEstimator>());
  Outputs outputs;
  Timestamp newest{};
  int revisions = 0;
  for (const Input& input : late) {
    perception.Step(input, outputs);
    if (!outputs.has_lists) continue;
    EXPECT_GE(outputs.local.stamp, newest);
    if (outputs.local.stamp == newest) {
      EXPECT_GT(outputs.local.revision, 0);
    } else {
      EXPECT_EQ(outputs.local.revision, 0);
    }
    revisions += outputs.local.revision > 0 ? 1 : 0;
    newest = outputs.local.stamp;
  }
  EXPECT_GT(revisions, 20);
}

TEST(Perception, OldAndRepeatedFramesAreRefusedAndCounted) {
  auto inputs = MakeInputs(Traffic());
  const auto first_scan = std::find_if(inputs.begin(), inputs.end(), [](const Input& input) {
    return std::holds_alternative<RadarScan>(input);
  });
  const Input old = *first_scan;
  const Input newest_scan = *std::find_if(inputs.rbegin(), inputs.rend(), [](const Input& input) {
    return std::holds_alternative<RadarScan>(input);
  });
  inputs.push_back(old);
  inputs.push_back(newest_scan);
  const Drive run = Feed(inputs);
  EXPECT_EQ(Count(run, Reason::kTooOld), 1u);
  EXPECT_EQ(Count(run, Reason::kDuplicate), 1u);
}

TEST(Perception, AStaleCopyChangesNothing) {
  const auto inputs = MakeInputs(Traffic());
  Perception with(PerceptionConfig{}, std::make_unique<NullBiasEstimator>());
  Perception without(PerceptionConfig{}, std::make_unique<NullBiasEstimator>());
  Outputs outputs;
  Outputs copy;
  Outputs other;
  for (const Input& input : inputs) {
    with.Step(input, outputs);
    without.Step(input, other);
    with.PredictedLists(HeaderOf(input).stamp + FromSeconds(0.2), copy);
    if (copy.has_lists) {
      EXPECT_TRUE(copy.local.stale);
    }
    ASSERT_EQ(outputs.has_lists, other.has_lists);
    if (!outputs.has_lists) continue;
    ASSERT_TRUE(Bits(outputs.local, true) == Bits(other.local, true));
    ASSERT_TRUE(Bits(outputs.priority, true) == Bits(other.priority, true));
  }
}

TEST(Perception, SilenceOfAllSensorsEndsInAnEmptyBlindList) {
  Perception perception(PerceptionConfig{}, std::make_unique<NullBiasEstimator>());
  Outputs outputs;
  for (const Input& input : MakeInputs(Traffic())) perception.Step(input, outputs);
  perception.PredictedLists(perception.newest_frame() + FromSeconds(1.0), outputs);
  ASSERT_TRUE(outputs.has_lists);
  EXPECT_FALSE(outputs.local.tracks.empty());
  EXPECT_FALSE(outputs.priority.tracks.empty());
  perception.PredictedLists(perception.newest_frame() + FromSeconds(10.0), outputs);
  ASSERT_TRUE(outputs.has_lists);
  EXPECT_TRUE(outputs.local.stale);
  EXPECT_TRUE(outputs.local.tracks.empty());
  EXPECT_TRUE(outputs.priority.tracks.empty());
  for (const SectorHealth& sector : outputs.local.sectors) {
    EXPECT_EQ(sector.state, SectorState::kBlind);
  }
}

TEST(Perception, ALogPlayedAgainStartsAgain) {
  const auto inputs = MakeInputs(Traffic());
  std::vector<Input> twice = inputs;
  twice.insert(twice.end(), inputs.begin(), inputs.end());
  const Drive once = Feed(inputs);
  const Drive again = Feed(twice);
  EXPECT_EQ(Count(again, Reason::kClockRestart), 1u);
  EXPECT_EQ(again.last_local.tracks.size(), once.last_local.tracks.size());
}

TEST(Perception, AJumpOfTheEgosGnssMovesNoVouchedVehicle) {
  SyntheticDrive drive = Traffic();
  drive.gnss_jump_at_s = 6.0;
  const Drive steady = Feed(MakeInputs(Traffic()));
  const Drive jumped = Feed(MakeInputs(drive));
  ASSERT_EQ(jumped.last_priority.tracks.size(), steady.last_priority.tracks.size());
  EXPECT_TRUE(jumped.last_priority.ego_gnss_suspect);
  for (std::size_t i = 0; i < steady.last_priority.tracks.size(); ++i) {
    const auto& a = steady.last_priority.tracks[i].track.state_O.mean;
    const auto& b = jumped.last_priority.tracks[i].track.state_O.mean;
    EXPECT_LT((a - b).head<2>().norm(), 1.0);
  }
}

}  // namespace
}  // namespace v2vouch
