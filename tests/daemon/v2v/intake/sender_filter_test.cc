// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/intake/sender_filter.h"

#include <gtest/gtest.h>

#include "daemon/common/base/random.h"
#include "daemon/v2v/intake/bsm_checks.h"
#include "tests/daemon/v2v/intake/talking_car.h"

namespace v2vouch {
namespace {

Claim ClaimOf(const Bsm& bsm) { return ToClaim(bsm, ClaimedAge(bsm, {}), {}); }

Eigen::Vector3d InTown(const Eigen::Vector3d& p_E) {
  return LocalPlane(kCrossroads).ToLocal(EcefPoint{p_E}).p_L;
}

class SenderFilterTest : public ::testing::Test {
 protected:
  SenderFilterTest() : track_(StartSender(car_.Say(), ClaimOf(car_.Say()))) {}

  void Hear(const Bsm& bsm) { ASSERT_TRUE(AdvanceSender(track_, bsm, ClaimOf(bsm))); }
  void HearFor(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds * 10.0); ++i) {
      car_.Drive(0.1);
      Hear(car_.Say());
    }
  }

  TalkingCar car_;
  SenderTrack track_;
};

TEST_F(SenderFilterTest, FollowsAnHonestCarAndMakesUpForLatency) {
  HearFor(10.0);
  // Valid at reception: 0.1 s of way beyond the place that was told.
  const Eigen::Vector3d expected(car_.east_m + 1.0, car_.north_m, 0.0);
  EXPECT_LT((InTown(track_.p_E) - expected).norm(), 0.1);
  EXPECT_EQ(track_.clean_run, 101.0);
  EXPECT_EQ(track_.messages, 101U);
  EXPECT_EQ(track_.resets, 0U);
  EXPECT_EQ(track_.lost, 0U);
  EXPECT_LT(track_.nis_mean, 1.0);
}

TEST_F(SenderFilterTest, HonestNoiseStaysClean) {
  Random random(5);
  int clean = 0;
  for (int i = 0; i < 600; ++i) {
    car_.Drive(0.1);
    TalkingCar noisy = car_;
    noisy.east_m += random.Normal(0.0, 0.7);
    noisy.north_m += random.Normal(0.0, 0.7);
    noisy.speed_mps += random.Normal(0.0, 0.2);
    noisy.yaw_rad += random.Normal(0.0, FromDegrees(1.5));
    Hear(noisy.Say());
    clean += track_.clean_run > 0.0 ? 1 : 0;
  }
  EXPECT_GT(clean, 590);
  EXPECT_EQ(track_.resets, 0U);
}

TEST_F(SenderFilterTest, ASpeedThatBeliesTheWayIsNotClean) {
  HearFor(3.0);
  for (int i = 0; i < 50; ++i) {
    car_.Drive(0.1);
    TalkingCar liar = car_;
    liar.speed_mps = 22.0;  // Drives 10.
    Hear(liar.Say());
  }
  EXPECT_GT(track_.nis_mean, 8.0);
}

TEST_F(SenderFilterTest, AJumpStartsAnew) {
  HearFor(3.0);
  car_.north_m += 30.0;
  HearFor(0.1);
  EXPECT_EQ(track_.resets, 1U);
  EXPECT_EQ(track_.clean_run, 0.0);
  EXPECT_NEAR(InTown(track_.p_E).y(), car_.north_m, 0.1);
  HearFor(2.0);
  EXPECT_EQ(track_.clean_run, 20.0);
}

TEST_F(SenderFilterTest, ASmallerJumpIsNotClean) {
  HearFor(3.0);
  car_.north_m += 8.0;
  HearFor(0.1);
  EXPECT_EQ(track_.clean_run, 0.0);
}

TEST_F(SenderFilterTest, ALongSilenceStartsAnew) {
  HearFor(3.0);
  car_.Drive(5.0);
  Hear(car_.Say());
  EXPECT_EQ(track_.resets, 1U);
}

TEST_F(SenderFilterTest, CountsWhatMsgCntMisses) {
  HearFor(1.0);
  car_.msg_count = (car_.msg_count + 3) % 128;
  HearFor(0.1);
  EXPECT_EQ(track_.lost, 3U);
  car_.msg_count = (car_.msg_count + 127) % 128;  // Goes back by one: a restart, not a loss.
  car_.msg_count = (car_.msg_count + 127) % 128;
  HearFor(0.1);
  EXPECT_EQ(track_.lost, 3U);
}

TEST_F(SenderFilterTest, TheAnchorMovesAlongUnnoticed) {
  car_.speed_mps = 30.0;
  HearFor(0.1);
  HearFor(300.0);                // 9 km.
  EXPECT_EQ(track_.resets, 1U);  // Of the sudden change of speed at most.
  EXPECT_LT((InTown(track_.p_E) - Eigen::Vector3d(car_.east_m + 3.0, car_.north_m, 0.0)).norm(),
            0.2);
  EXPECT_LT(track_.state.mean.head<2>().norm(), 2100.0);
}

TEST_F(SenderFilterTest, WorksWithoutCourse) {
  car_.speed_mps = 0.0;
  for (int i = 0; i < 50; ++i) {
    car_.Drive(0.1);
    Bsm bsm = car_.Say();
    bsm.course_rad.reset();
    Hear(bsm);
  }
  EXPECT_GT(track_.clean_run, 40.0);
  EXPECT_LT((InTown(track_.p_E) - Eigen::Vector3d(car_.east_m, car_.north_m, 0.0)).norm(), 0.5);
}

TEST_F(SenderFilterTest, ReversingIsCleanToo) {
  TalkingCar car;
  car.speed_mps = -3.0;  // Looks east, rolls west.
  const auto say = [&car] {
    Bsm bsm = car.Say();
    bsm.transmission = Transmission::kReverse;
    bsm.course_rad = kPi;
    return bsm;
  };
  SenderTrack track = StartSender(say(), ClaimOf(say()));
  for (int i = 0; i < 50; ++i) {
    car.Drive(0.1);
    ASSERT_TRUE(AdvanceSender(track, say(), ClaimOf(say())));
  }
  EXPECT_EQ(track.clean_run, 51.0);
  EXPECT_NEAR(track.state.mean(kSpeed), -3.0, 0.05);
  EXPECT_NEAR(track.state.mean(kYaw), 0.0, 0.01);
}

}  // namespace
}  // namespace v2vouch
