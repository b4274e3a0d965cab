// SPDX-License-Identifier: Apache-2.0
// Input guards that another open tracker lacks (docs/results/peers.md): it accepts stamps two
// seconds ahead and runs backwards, it knows no age limit, and what is not a number becomes one.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "daemon/pipeline/perception.h"
#include "tests/support/synthetic_drive.h"

namespace v2vouch {
namespace {

using testing::MakeInputs;
using testing::SyntheticDrive;

// What a run of the pipeline ended in.
struct End {
  std::vector<StateVector> states;
  std::uint64_t future = 0, old = 0, not_finite = 0;
};

End FeedAll(const std::vector<Input>& inputs) {
  Perception perception(PerceptionConfig{}, std::make_unique<NullBiasEstimator>());
  Outputs outputs;
  End end;
  for (const Input& input : inputs) {
    perception.Step(input, outputs);
    for (const Diagnostic& diagnostic : outputs.diagnostics) {
      end.future += diagnostic.reason == Reason::kFutureStamp ? 1 : 0;
      end.old += diagnostic.reason == Reason::kTooOld ? 1 : 0;
      end.not_finite += diagnostic.reason == Reason::kNotFinite ? 1 : 0;
    }
    if (!outputs.has_lists) continue;
    end.states.clear();
    for (const PublishedTrack& line : outputs.local.tracks) {
      end.states.push_back(line.track.state_O.mean);
    }
  }
  return end;
}

std::vector<Input> Drive() {
  SyntheticDrive drive;
  drive.duration_s = 5.0;
  drive.cars = {{.x_m = 30.0, .speed_mps = 9.0},
                {.x_m = 90.0, .y_m = 3.5, .yaw_rad = 3.14159, .speed_mps = 6.0}};
  return MakeInputs(drive);
}

// The drive with a copy of every tenth scan after its first second, changed by `spoil`.
template <class Spoil>
std::vector<Input> Spoilt(Spoil&& spoil, std::uint64_t& copies) {
  std::vector<Input> out;
  int scans = 0;
  copies = 0;
  for (const Input& input : Drive()) {
    out.push_back(input);
    const auto* scan = std::get_if<RadarScan>(&input);
    if (scan == nullptr || ++scans < 40 || scans % 10 != 0) continue;
    RadarScan copy = *scan;
    copy.seq += 1'000'000;
    spoil(copy);
    out.emplace_back(copy);
    ++copies;
  }
  return out;
}

TEST(PeerGuards, StampsFarAheadAreRefusedCountedAndWithoutEffect) {
  std::uint64_t copies = 0;
  const End clean = FeedAll(Drive());
  const End spoilt =
      FeedAll(Spoilt([](RadarScan& scan) { scan.stamp += FromSeconds(2.0); }, copies));
  ASSERT_GT(copies, 5u);
  EXPECT_EQ(spoilt.future, copies);
  ASSERT_GE(clean.states.size(), 2u);
  EXPECT_EQ(spoilt.states, clean.states);
}

TEST(PeerGuards, OldScansAreRefusedCountedAndWithoutEffect) {
  std::uint64_t copies = 0;
  const End clean = FeedAll(Drive());
  const End spoilt =
      FeedAll(Spoilt([](RadarScan& scan) { scan.stamp -= FromSeconds(1.0); }, copies));
  EXPECT_EQ(spoilt.old, copies);
  EXPECT_EQ(spoilt.states, clean.states);
}

TEST(PeerGuards, NumbersThatAreNoneReachNoTrack) {
  std::uint64_t copies = 0;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const End spoilt = FeedAll(Spoilt(
      [nan](RadarScan& scan) {
        for (RadarDetection& detection : scan.detections) detection.range_m = nan;
      },
      copies));
  ASSERT_GE(spoilt.states.size(), 2u);
  for (const StateVector& state : spoilt.states) EXPECT_TRUE(state.allFinite());
}

}  // namespace
}  // namespace v2vouch
