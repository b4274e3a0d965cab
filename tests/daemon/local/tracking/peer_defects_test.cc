// SPDX-License-Identifier: Apache-2.0
// Four defects measured in another open tracker (docs/results/peers.md), each as a test that ours
// does not have it.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "daemon/common/assignment/assignment.h"
#include "daemon/common/base/angle.h"
#include "daemon/common/models/extent.h"
#include "daemon/local/tracking/track_filter.h"
#include "daemon/local/tracking/tracker.h"

namespace v2vouch {
namespace {

PoseMeasurement At(double x, double y, double yaw, double speed) {
  PoseMeasurement z{.x_m = x, .y_m = y, .yaw_rad = yaw, .speed_mps = speed};
  z.covariance.diagonal() << 0.25, 0.25, 0.0025, 0.25, 0.0004;
  return z;
}

// 1. There, one gated-out pair anywhere made the crossed matching (0.1) lose against the straight
// one (0.9).
TEST(PeerDefects, AGatedOutPairDoesNotBreakOptimality) {
  const std::vector<double> lone = {10.0, 10.0, 10.0};
  const std::array<double, 4> straight_and_crossed = {0.9, 0.1, 0.1, 0.9};
  for (const bool with_unrelated : {false, true}) {
    const std::size_t n = with_unrelated ? 3 : 2;
    std::vector<double> dense(n * n, kForbidden);
    std::vector<SparsePair> sparse;
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) {
        const double cost = straight_and_crossed[static_cast<std::size_t>(2 * i + j)];
        dense[static_cast<std::size_t>(i) * n + static_cast<std::size_t>(j)] = cost;
        sparse.push_back({i, j, cost});
      }
    }
    if (with_unrelated) {
      dense[8] = 0.5;
      sparse.push_back({2, 2, 0.5});
    }
    const auto prices = std::span<const double>(lone).first(n);
    AssignmentSolver solver;
    const auto a = solver.Solve(dense, n, n, prices);
    EXPECT_EQ(a[0], 1);
    EXPECT_EQ(a[1], 0);
    ClusteredAssignmentSolver clustered;
    const auto b = clustered.Solve(sparse, n, n, prices);
    EXPECT_EQ(b[0], 1);
    EXPECT_EQ(b[1], 0);
  }
}

// 2. There, two headings 0.02 rad apart across the wrap scored 62.6 instead of 0.2.
TEST(PeerDefects, HeadingsAcrossTheWrapAreNear) {
  for (const double axis : {0.0, kPi, 0.5 * kPi, -0.5 * kPi, 0.6}) {
    const TrackFilter filter = TrackFilter::FromPose(At(0.0, 0.0, WrapAngle(axis - 0.01), 20.0));
    const PoseMeasurement z = At(0.0, 0.0, WrapAngle(axis + 0.01), 20.0);
    const auto likelihood = filter.Evaluate(z, FilterSettings{});
    ASSERT_TRUE(likelihood.has_value());
    EXPECT_NEAR(likelihood->distance_squared, 0.02 * 0.02 / 0.005, 1e-9) << axis;
  }
}

TEST(PeerDefects, AnUpdateAcrossTheWrapTurnsTheShortWay) {
  TrackFilter filter = TrackFilter::FromPose(At(0.0, 0.0, kPi - 0.01, 20.0));
  ASSERT_TRUE(filter.Update(At(0.0, 0.0, -kPi + 0.01, 20.0)));
  LocalTrack track;
  filter.Show(FilterSettings{}, track);
  EXPECT_NEAR(std::abs(track.state_O.mean[kYaw]), kPi, 1e-9);
}

// 3. There, five seconds of prediction left the speed variance unchanged.
TEST(PeerDefects, PredictionGrowsEveryVariance) {
  TrackFilter filter = TrackFilter::FromPose(At(0.0, 0.0, 0.4, 15.0));
  LocalTrack before, after;
  filter.Show(FilterSettings{}, before);
  filter.Predict(5.0, FilterSettings{});
  filter.Show(FilterSettings{}, after);
  for (const int i : {kX, kY, kYaw, kSpeed, kYawRate}) {
    EXPECT_GT(after.state_O.covariance(i, i), 1.2 * before.state_O.covariance(i, i)) << i;
  }
  // A jerk of 1 m/s^3 over a second, 1 sigma and more, is what ordinary braking does.
  EXPECT_GT(after.state_O.covariance(kSpeed, kSpeed), 1.0);
}

// ... and the score ignored the covariance of the detection.
TEST(PeerDefects, TheScoreKnowsTheDetectionsCovariance) {
  const TrackFilter filter = TrackFilter::FromPose(At(0.0, 0.0, 0.0, 20.0));
  PoseMeasurement z = At(2.0, 0.0, 0.0, 20.0);
  const double sharp = filter.Evaluate(z, FilterSettings{})->distance_squared;
  z.covariance *= 10.0;
  EXPECT_LT(filter.Evaluate(z, FilterSettings{})->distance_squared, 0.3 * sharp);
}

// 4. There, a zero covariance gave NaN. Stamps and ages: tests/daemon/pipeline/peer_guards_test.cc.
TEST(PeerDefects, AZeroCovarianceIsRefusedAndHarmsNoTrack) {
  Tracker tracker(TrackerConfig{}, VehicleConfig{});
  Timestamp time = FromMicros(1'700'000'000'000'000);
  const DetectabilityOf visible = [](const LocalTrack&) {
    return Detectability{.probability = 0.95};
  };
  for (int k = 0; k < 5; ++k) {
    time = time + FromSeconds(0.1);
    tracker.Predict(time);
    std::vector<PoseMeasurement> poses = {At(2.0 * k, 0.0, 0.0, 20.0)};
    if (k == 3) poses[0].covariance.setZero();
    tracker.UpdatePoses(PoseSensor{}, poses, visible);
    EXPECT_EQ(tracker.failures().size(), k == 3 ? 1u : 0u);
    ASSERT_EQ(tracker.tracks().size(), 1u);
    EXPECT_TRUE(tracker.tracks()[0].state_O.mean.allFinite());
    EXPECT_TRUE(tracker.tracks()[0].state_O.covariance.allFinite());
  }
}

}  // namespace
}  // namespace v2vouch
