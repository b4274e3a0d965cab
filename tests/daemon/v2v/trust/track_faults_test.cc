// SPDX-License-Identifier: Apache-2.0
// A claim and its LOCAL track come apart: whose own continuity broke?
#include "tests/daemon/v2v/trust/sender_evidence.h"

namespace v2vouch {
namespace {

// Sensors that have a velocity wrong, while claimed and sensed places stay together.
TEST(SenderTrust, AFalseSensedVelocityBlamesNobody) {
  SenderTrust trust = Validated();
  EXPECT_TRUE(std::isnan(RunUntilVerdict(
      trust, 0.0, 10.0,
      [](double) {
        CoObservation observation = Residual(0.3, 0.2);
        observation.speed_residual_mps = 5.0;
        observation.speed_sigma_mps = 0.2;
        return observation;
      },
      Verdict::kWithdraw)));
}

// A reflection runs along a car: LOCAL's speed goes from 33 to 38 m/s within 0.4 s, and the track
// leaves the sender at 5 m/s.
TEST(SenderTrust, ATrackThatMovesAsNoVehicleCanBlamesNobody) {
  const auto run = [](bool is_the_tracks_doing) {
    SenderTrust trust = Validated();
    for (int i = 0; i < 60 && trust.is_relied_on(); ++i) {
      const double t = 0.1 * i;
      const double apart_mps = 5.0 * std::clamp((t - 3.0) / 0.4, 0.0, 1.0);
      CoObservation observation = Residual(-5.0 * std::max(0.0, t - 3.2), 0.0);
      observation.stamp = At(t);
      observation.track_speed_mps = is_the_tracks_doing ? 33.0 + apart_mps : 33.0;
      observation.speed_residual_mps = -apart_mps;
      observation.velocity_residual_O = Eigen::Vector2d(-apart_mps, 0.0);
      trust.OnCoObservation(observation, true, kConfig);
    }
    return trust;
  };
  SenderTrust honest = run(true);
  EXPECT_EQ(honest.state(), TrustState::kCandidate);
  EXPECT_FALSE(honest.TakeVerdict().has_value());
  SenderTrust liar = run(false);
  EXPECT_EQ(liar.state(), TrustState::kSuspect);
}

// It breaks off twice a second and strays on, 2 m a second: the checks never settle.
TEST(SenderTrust, ATrackThatBreaksOffAgainAndAgainIsLeftBeforeItIsFar) {
  SenderTrust trust = Validated();
  double apart_m = 0.0;
  for (int i = 0; i < 100 && trust.is_relied_on(); ++i) {
    apart_m = 0.2 * std::max(0, i - 20);
    CoObservation observation = Residual(0.0, apart_m);
    observation.stamp = At(0.1 * i);
    observation.is_partial = i % 3 != 0;
    observation.sensed_sigma_m = 1.3;
    observation.track_yaw_rad = i > 20 && i / 5 % 2 == 0 ? 0.4 : 0.0;
    observation.velocity_residual_O = Eigen::Vector2d(0.0, 2.0);
    trust.OnCoObservation(observation, true, kConfig);
  }
  EXPECT_EQ(trust.state(), TrustState::kCandidate);
  EXPECT_FALSE(trust.TakeVerdict().has_value());
  EXPECT_LT(apart_m, 7.0);
}

// While the sender was a stranger, the track strayed and came back in one step.
TEST(SenderTrust, WhatWasOffBeforeTheTrackCameBackIsNoDrift) {
  SenderTrust trust = Candidate();
  for (int i = 0; i < 80; ++i) {
    const bool is_astray = i < 25;
    CoObservation observation = Residual(0.0, is_astray ? 4.3 : 0.2);
    observation.sensed_sigma_m = is_astray ? 1.0 : 0.1;

    observation.stamp = At(1.0 + 0.1 * i);
    observation.track_speed_mps = is_astray ? 30.0 : 35.0;
    trust.OnMessage(observation.stamp, true, kConfig);
    if (i == 30) {
      ASSERT_TRUE(trust.TryValidate(Good(), kConfig));
    }
    trust.OnCoObservation(observation, true, kConfig);
  }
  EXPECT_EQ(trust.state(), TrustState::kValidated);
}

// A LOCAL track of which but a part is seen drives off with another car, at a speed that it tells.
TEST(SenderTrust, APartExplainsNoMoreThanTheSizeOfAVehicle) {
  SenderTrust trust = Validated();
  double left_s = -1.0;
  for (int i = 0; i < 200 && left_s < 0.0; ++i) {
    const double t = 0.1 * i;
    CoObservation observation = Residual(t < 3.0 ? 0.5 : 0.5 + 2.0 * (t - 3.0), 0.0);
    observation.stamp = At(t);
    observation.is_own_motion_whole = true;
    observation.is_partial = t >= 3.0;
    if (t >= 3.0) observation.velocity_residual_O = Eigen::Vector2d(2.0, 0.0);
    if (!trust.OnCoObservation(observation, true, kConfig)) left_s = t;
  }
  EXPECT_GT(left_s, 4.5);
  EXPECT_LT(left_s, 7.0);
  EXPECT_EQ(trust.state(), TrustState::kCandidate);  // Blames nobody.
  EXPECT_FALSE(trust.TakeVerdict());
}

// The residual jumps by 6 m. Whoever's own continuity broke is at fault.
TEST(SenderTrust, ATornPairBlamesTheSenderOnlyWhereItsOwnMotionBroke) {
  const auto torn = [](bool is_own_motion_whole) {
    SenderTrust trust = Validated();
    for (int i = 0; i < 30; ++i) {
      CoObservation observation = Residual(i < 20 ? 0.0 : 6.0, 0.0);
      observation.stamp = At(0.1 * i);
      observation.velocity_residual_O = Eigen::Vector2d::Zero();
      observation.is_own_motion_whole = is_own_motion_whole;
      if (!trust.OnCoObservation(observation, true, kConfig)) {
        EXPECT_EQ(i, 20);
        break;
      }
    }
    return trust;
  };
  SenderTrust honest = torn(true);
  EXPECT_EQ(honest.state(), TrustState::kCandidate);
  EXPECT_FALSE(honest.TakeVerdict().has_value());
  SenderTrust liar = torn(false);
  EXPECT_EQ(liar.state(), TrustState::kSuspect);
  EXPECT_EQ(liar.TakeVerdict()->finding.check, Check::kResidualJump);
}

// The sensors lose the vehicle for two seconds and come back to one 8 m off.
TEST(SenderTrust, AnotherVehicleTakenForTheOldOneIsTorn) {
  SenderTrust trust = Validated();
  for (int i = 0; i < 15; ++i) {
    CoObservation observation = Residual(0.5, 0.0);
    observation.stamp = At(0.1 * i);
    ASSERT_TRUE(trust.OnCoObservation(observation, true, kConfig));
  }
  CoObservation other = Residual(8.0, 0.0);
  other.stamp = At(3.5);
  EXPECT_FALSE(trust.OnCoObservation(other, true, kConfig));
  EXPECT_EQ(trust.state(), TrustState::kCandidate);
}

// Only a part of the vehicle is seen, then less and less for certain: the LOCAL track strays 9 m at
// a pace of its own. However unsure it is of itself, it is not the sender's vehicle any more.
TEST(SenderTrust, ATrackThatStraysFarIsTornHoweverUnsureItIs) {
  SenderTrust trust = Validated();
  for (int i = 0; i < 15; ++i) {
    CoObservation observation = Residual(0.5, 0.0);
    observation.stamp = At(0.1 * i);
    ASSERT_TRUE(trust.OnCoObservation(observation, true, kConfig));
  }
  double strayed_m = 0.0;
  for (int i = 15; i < 60 && trust.is_relied_on(); ++i) {
    strayed_m = 0.3 * (i - 15);
    CoObservation observation = Residual(0.5, strayed_m);
    observation.stamp = At(0.1 * i);
    observation.velocity_residual_O = Eigen::Vector2d(0.0, 3.0);
    observation.is_partial = true;
    observation.sensed_sigma_m = 3.0;
    trust.OnCoObservation(observation, true, kConfig);
  }
  EXPECT_EQ(trust.state(), TrustState::kCandidate);
  EXPECT_LT(strayed_m, 9.0);
}

}  // namespace
}  // namespace v2vouch
