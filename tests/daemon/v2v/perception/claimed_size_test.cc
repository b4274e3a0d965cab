// SPDX-License-Identifier: Apache-2.0
// The length that a validated sender tells moves the centre of its vehicle, and the near face stays
// where the sensors have it.
#include "daemon/v2v/perception/claimed_size.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

namespace v2vouch {
namespace {

// Seen from behind at 20 m: of a lorry only the near face is known, 0.1 m well.
LocalTrack SeenFromBehind() {
  LocalTrack track;
  track.extent = {4.6, 1.85, 0.8, 0.2};
  track.state_O.mean << 20.0 + 0.5 * 4.6, 0.0, 0.0, 5.0, 0.0, 0.0;
  track.state_O.covariance = StateVector(0.17, 0.02, 1e-3, 0.05, 1e-3, 0.05).asDiagonal();
  track.centre_by_length_O = {0.5, 0.0};
  return track;
}

SenderRecord Tells(double length_m, double width_m) {
  SenderRecord record;
  record.length_m = length_m;
  record.width_m = width_m;
  return record;
}

double NearFace(const LocalTrack& track) {
  return track.state_O.mean[kX] - 0.5 * track.extent.length_m;
}

TEST(ClaimedSize, MovesTheCentreAndKeepsTheNearFace) {
  const LocalTrack track = SeenFromBehind();
  const SenderRecord record = Tells(8.3, 2.4);
  const LocalTrack given = GivenClaimedSize(track, &record, TrustConfig{});
  EXPECT_NEAR(given.extent.length_m, 8.3, 0.15);
  EXPECT_LT(given.extent.length_sigma_m, 0.15);
  EXPECT_NEAR(given.extent.width_m, 2.4, 0.25);
  EXPECT_NEAR(NearFace(given), NearFace(track), 1e-9);
  EXPECT_NEAR(given.state_O.mean[kX], 20.0 + 0.5 * 8.3, 0.1);
  EXPECT_LT(given.state_O.covariance(kX, kX), 0.03);
  const Eigen::SelfAdjointEigenSolver<StateMatrix> parts(given.state_O.covariance);
  EXPECT_GT(parts.eigenvalues().minCoeff(), 0.0);
}

TEST(ClaimedSize, MovesNothingThatTheSensorsHaveMeasured) {
  LocalTrack track = SeenFromBehind();
  track.extent.length_sigma_m = 0.05;
  const SenderRecord record = Tells(5.5, 1.9);
  const LocalTrack given = GivenClaimedSize(track, &record, TrustConfig{});
  EXPECT_LT(std::abs(given.state_O.mean[kX] - track.state_O.mean[kX]), 0.06);
}

TEST(ClaimedSize, OfAnImpossibleSizeOrNoneMovesNothing) {
  const LocalTrack track = SeenFromBehind();
  for (const SenderRecord& record : {Tells(18.0, 1.9), Tells(4.6, 4.5), SenderRecord{}}) {
    const LocalTrack given = GivenClaimedSize(track, &record, TrustConfig{});
    EXPECT_EQ(given.state_O.mean, track.state_O.mean);
    EXPECT_EQ(given.extent.length_m, track.extent.length_m);
  }
  EXPECT_EQ(GivenClaimedSize(track, nullptr, TrustConfig{}).state_O.mean, track.state_O.mean);
  LocalTrack point = track;
  point.is_point = true;
  const SenderRecord record = Tells(5.5, 1.9);
  EXPECT_EQ(GivenClaimedSize(point, &record, TrustConfig{}).state_O.mean, point.state_O.mean);
}

}  // namespace
}  // namespace v2vouch
