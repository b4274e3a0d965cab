// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/association/paper_list.h"

#include <gmock/gmock.h>

namespace v2vouch {
namespace {

ClaimInOdometry ClaimAt(SenderId sender, double time_s, double x_m, double speed_mps = 0.0) {
  ClaimInOdometry claim;
  claim.sender = sender;
  claim.stamp = FromMicros(0) + FromSeconds(time_s);
  claim.p_O = {x_m, 0.0};
  claim.speed_mps = speed_mps;
  return claim;
}

LocalTrack TrackAt(std::uint64_t id, double x_m) {
  LocalTrack track;
  track.id = id;
  track.is_confirmed = true;
  track.state_O.mean[kX] = x_m;
  track.state_O.covariance *= 0.25;
  return track;
}

Timestamp At(double time_s) { return FromMicros(0) + FromSeconds(time_s); }

TEST(PaperList, TwoSendersOnOneCarAreTwoTracks) {
  const PaperConfig config;
  PaperList list;
  list.OnClaim(ClaimAt(1, 10.0, 0.5), config);
  list.OnClaim(ClaimAt(2, 10.0, -0.5), config);
  const std::vector<LocalTrack> tracks = {TrackAt(7, 0.0)};
  list.OnFrame(At(10.0), tracks, config);
  ASSERT_EQ(list.entries().size(), 2u);
  EXPECT_NE(list.entries()[0].id, list.entries()[1].id);
  EXPECT_EQ(list.entries()[0].local_id, 7u);
}

TEST(PaperList, LivesOnBsmsAloneAndFollowsThemAnywhere) {
  const PaperConfig config;
  PaperList list;
  list.OnClaim(ClaimAt(1, 10.0, 0.5), config);
  const std::vector<LocalTrack> tracks = {TrackAt(7, 0.0)};
  list.OnFrame(At(10.0), tracks, config);
  const std::uint64_t id = list.entries()[0].id;
  for (int i = 1; i <= 100; ++i) {
    list.OnClaim(ClaimAt(1, 10.0 + 0.1 * i, 3.0 * i), config);
    list.OnFrame(At(10.0 + 0.1 * i), {}, config);
  }
  ASSERT_EQ(list.entries().size(), 1u);
  EXPECT_EQ(list.entries()[0].id, id);
  EXPECT_EQ(list.entries()[0].local_id, 0u);
  EXPECT_NEAR(list.entries()[0].track.state_O.mean[kX], 300.0, 1e-9);
}

TEST(PaperList, EndsWhenTheSenderFallsSilent) {
  const PaperConfig config;
  PaperList list;
  list.OnClaim(ClaimAt(1, 10.0, 0.5), config);
  const std::vector<LocalTrack> tracks = {TrackAt(7, 0.0)};
  list.OnFrame(At(10.0), tracks, config);
  list.OnFrame(At(10.0 + config.keep_alive_s + 0.1), {}, config);
  EXPECT_TRUE(list.entries().empty());
}

TEST(PaperList, WithoutASensorTrackThereIsNothing) {
  const PaperConfig config;
  PaperList list;
  list.OnClaim(ClaimAt(1, 10.0, 0.5), config);
  list.OnFrame(At(10.0), {}, config);
  EXPECT_TRUE(list.entries().empty());
}

}  // namespace
}  // namespace v2vouch
