// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "daemon/common/base/random.h"
#include "daemon/v2v/association/height_offset.h"
#include "daemon/v2v/association/height_track.h"

namespace v2vouch {
namespace {

Timestamp At(double seconds) { return FromMicros(1'700'000'000'000'000) + FromSeconds(seconds); }

// Drives `way_m` in steps of 1.2 m (12 m/s, ten heights a second).
HeightTrack Driven(double way_m, double grade, double noise_m, std::uint64_t seed = 1) {
  HeightTrack track;
  Random random(seed);
  double t = 0.0;
  for (double s = 0.0; s < way_m; s += 1.2, t += 0.1) {
    track.Add(At(t), s == 0.0 ? 0.0 : 1.2, 100.0 + grade * s + random.Normal(0.0, noise_m));
  }
  return track;
}

TEST(HeightTrack, FollowsAClimbWithoutLag) {
  const HeightTrack track = Driven(200.0, 0.12, 0.2);
  EXPECT_NEAR(*track.HeightAt(At(16.6)), 100.0 + 0.12 * 199.2, 0.5);
  EXPECT_NEAR(track.grade(), 0.12, 0.03);
  EXPECT_NEAR(Driven(200.0, -0.08, 0.2).grade(), -0.08, 0.03);
}

TEST(HeightTrack, AFlatRoadHasNoGradeHoweverNoisyTheHeights) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    EXPECT_NEAR(Driven(150.0, 0.0, 1.0, seed).grade(), 0.0, 0.012) << seed;
  }
}

TEST(HeightTrack, AStandingVehicleHasAHeightAndNoGrade) {
  HeightTrack track;
  for (int i = 0; i < 50; ++i) track.Add(At(0.1 * i), 0.0, 100.0 + (i % 2));
  EXPECT_NEAR(*track.HeightAt(At(5.0)), 100.5, 0.1);
  EXPECT_EQ(track.grade(), 0.0);
}

TEST(HeightTrack, WithoutHeightsItIsUnknownAfterFiveSeconds) {
  HeightTrack track;
  EXPECT_FALSE(track.HeightAt(At(0.0)));
  track.Add(At(0.0), 0.0, 50.0);
  for (int i = 1; i < 100; ++i) {
    track.Add(At(0.1 * i), 1.0, std::nullopt);
    EXPECT_EQ(track.HeightAt(At(0.1 * i)).has_value(), i <= 50) << i;
  }
}

HeightWitness Says(SenderId sender, double difference_m, double agreed_m) {
  return {sender, difference_m, 4.0, agreed_m};
}

using Witnesses = std::vector<HeightWitness>;

TEST(HeightOffset, TwoThatTheSensorsAgreeWithShowIt) {
  HeightOffset offset;
  EXPECT_FALSE(offset.Judge(Witnesses{Says(1, 47.3, 9.0), Says(2, 46.6, 9.5), Says(3, 46.0, 0.0)}));
  EXPECT_EQ(offset.offset_m(), 0.0);
  EXPECT_NEAR(*offset.unexplained_m(), 47.3, 1e-9);
  EXPECT_TRUE(offset.Judge(Witnesses{Says(1, 47.3, 11.0), Says(2, 46.7, 300.0)}));
  EXPECT_NEAR(offset.offset_m(), 47.0, 1e-9);
  EXPECT_FALSE(offset.Judge(Witnesses{Says(1, 47.3, 11.0), Says(2, 46.7, 300.0)}));
  EXPECT_FALSE(offset.unexplained_m());
  EXPECT_FALSE(offset.Judge(Witnesses{}));
  EXPECT_NEAR(offset.offset_m(), 47.0, 1e-9);  // It holds.
}

TEST(HeightOffset, OneAloneShowsALargeOneAfterMoreWay) {
  HeightOffset offset;
  EXPECT_FALSE(offset.Judge(Witnesses{Says(1, -47.0, 24.0)}));
  EXPECT_TRUE(offset.Judge(Witnesses{Says(1, -47.0, 26.0)}));
  EXPECT_EQ(offset.offset_m(), -47.0);
  HeightOffset beside;  // Another is heard, unseen, and tells the same.
  EXPECT_TRUE(beside.Judge(Witnesses{Says(1, -47.0, 11.0), Says(2, -46.0, 0.0)}));
}

TEST(HeightOffset, TwoShowASmallOneOverALongWay) {
  HeightOffset offset;
  EXPECT_FALSE(offset.Judge(Witnesses{Says(1, 9.0, 900.0), Says(2, 9.5, 49.0)}));
  EXPECT_TRUE(offset.Judge(Witnesses{Says(1, 9.0, 900.0), Says(2, 9.5, 51.0)}));
}

TEST(HeightOffset, OneAloneNeverShowsWhatABridgeMayHave) {
  for (const double bridge_m : {4.5, 6.0, 12.0, 19.9, -6.0}) {
    HeightOffset offset;
    EXPECT_FALSE(offset.Judge(Witnesses{Says(1, bridge_m, 900.0)})) << bridge_m;
    EXPECT_FALSE(offset.Judge(Witnesses{Says(1, bridge_m, 900.0), Says(2, 0.3, 0.0)}));
    EXPECT_EQ(offset.offset_m(), 0.0);
  }
}

TEST(HeightOffset, OneAloneShowsNothingWhereAnotherTellsAnotherHeight) {
  HeightOffset offset;
  EXPECT_FALSE(offset.Judge(Witnesses{Says(1, 47.0, 900.0), Says(2, 0.0, 0.0)}));
  EXPECT_FALSE(offset.Judge(Witnesses{Says(1, 47.0, 900.0), Says(2, 0.0, 100.0)}));
}

TEST(HeightOffset, NoOffsetWinsATie) {
  HeightOffset offset;
  EXPECT_FALSE(offset.Judge(
      Witnesses{Says(1, 8.0, 99.0), Says(2, 8.5, 99.0), Says(3, 0.0, 99.0), Says(4, 0.2, 99.0)}));
  EXPECT_EQ(offset.offset_m(), 0.0);
  // More than those who tell none.
  EXPECT_TRUE(offset.Judge(Witnesses{Says(1, 8.0, 99.0), Says(2, 8.5, 99.0), Says(3, 0.0, 99.0)}));
  EXPECT_NEAR(offset.offset_m(), 8.25, 1e-9);
  EXPECT_TRUE(offset.Judge(
      Witnesses{Says(1, 8.0, 99.0), Says(2, 8.5, 99.0), Says(3, 0.0, 99.0), Says(4, 0.2, 99.0)}));
  EXPECT_EQ(offset.offset_m(), 0.0);
}

// A liar alone pushes honest senders onto another level only until one of them is seen.
TEST(HeightOffset, ALiarsOffsetGoesWithTheFirstHonestSenderThatIsSeen) {
  HeightOffset offset;
  EXPECT_TRUE(offset.Judge(Witnesses{Says(9, 60.0, 60.0)}));
  EXPECT_FALSE(offset.Judge(Witnesses{Says(9, 60.0, 80.0), Says(1, 0.4, 9.0)}));
  EXPECT_TRUE(offset.Judge(Witnesses{Says(9, 60.0, 99.0), Says(1, 0.4, 11.0)}));
  EXPECT_EQ(offset.offset_m(), 0.0);
}

}  // namespace
}  // namespace v2vouch
