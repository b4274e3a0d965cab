// SPDX-License-Identifier: Apache-2.0
// How long the sensors have had no more than a part of a vehicle.
#include "daemon/v2v/perception/track_snapshots.h"

#include <gtest/gtest.h>

namespace v2vouch {
namespace {

constexpr std::uint64_t kTrack = 7;
constexpr double kFrame_s = 0.1;

class PartialPhase : public ::testing::Test {
 protected:
  // So many frames of the whole vehicle or of a part of it; what the last one says.
  const TrackSnapshot& See(bool is_partial, int frames) {
    LocalTrack track;
    track.id = kTrack;
    for (int k = 0; k < frames; ++k) {
      now_ = now_ + FromSeconds(kFrame_s);
      track.support.Add({SensorKind::kRadar, 0}, now_);
      snapshots_.Begin(now_);
      snapshots_.Add(track, {.is_sure = true, .is_hit = true, .is_partial = is_partial});
    }
    return *snapshots_.Find(kTrack);
  }

 private:
  Timestamp now_ = FromMicros(1'700'000'000'000'000);
  TrackSnapshots snapshots_;
};

TEST_F(PartialPhase, IsBriefForAsLongAsSomethingTakesToCoverAVehicle) {
  EXPECT_FALSE(See(false, 5).is_briefly_partial);
  EXPECT_TRUE(See(true, 1).is_briefly_partial);
  EXPECT_TRUE(See(true, 33).is_briefly_partial);
  const TrackSnapshot& late = See(true, 4);
  EXPECT_TRUE(late.is_partial);
  EXPECT_FALSE(late.is_briefly_partial);
}

// A whole view of a moment is no new beginning: a sender that walks off could live on it.
TEST_F(PartialPhase, BeginsAnewOnlyAfterAWholeViewThatLasted) {
  See(true, 40);
  See(false, 2);
  EXPECT_FALSE(See(true, 1).is_briefly_partial);
  See(false, 8);
  EXPECT_TRUE(See(true, 1).is_briefly_partial);
}

}  // namespace
}  // namespace v2vouch
