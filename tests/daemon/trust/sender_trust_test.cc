// SPDX-License-Identifier: Apache-2.0
#include "daemon/trust/sender_trust.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "daemon/base/random.h"

namespace v2vouch {
namespace {

const TrustConfig kConfig;

Timestamp At(double time_s) { return FromMicros(1'000'000'000) + FromSeconds(time_s); }

ValidationEvidence Good() {
  return {.co_observations = 20,
          .span_s = 2.0,
          .is_nis_consistent = true,
          .margin = 10.0,
          .is_assigned = true,
          .are_sensors_sure = true};
}

SenderTrust Candidate() {
  SenderTrust trust;
  for (int i = 0; i < 3; ++i) trust.OnMessage(At(0.1 * i), true, kConfig);
  return trust;
}

SenderTrust Validated() {
  SenderTrust trust = Candidate();
  EXPECT_TRUE(trust.TryValidate(Good(), kConfig));
  return trust;
}

// Feeds residuals at 10 Hz from `from_s` on; @return when a verdict came, or NaN.
double RunUntilVerdict(SenderTrust& trust, double from_s, double for_s,
                       const std::function<CoObservation(double)>& residual, Verdict wanted) {
  for (int i = 0; i < static_cast<int>(for_s * 10.0); ++i) {
    const double t = 0.1 * i;
    CoObservation observation = residual(t);
    observation.stamp = At(from_s + t);
    trust.OnMessage(observation.stamp, true, kConfig);
    trust.OnCoObservation(observation, true, kConfig);
    const auto verdict = trust.TakeVerdict();
    if (verdict && verdict->verdict == wanted) return t;
  }
  return std::nan("");
}

CoObservation Residual(double x_m, double y_m) {
  CoObservation observation;
  observation.residual_O = {x_m, y_m};
  observation.track_speed_mps = 10.0;
  return observation;
}

// Agrees with the sensors at 10 Hz; @return for how long until no longer SUSPECT, or NaN.
double AgreeUntilClean(SenderTrust& trust, double from_s) {
  for (int i = 0; i < 1200; ++i) {
    CoObservation observation = Residual(0.0, 0.0);
    observation.stamp = At(from_s + 0.1 * i);
    trust.OnMessage(observation.stamp, true, kConfig);
    if (trust.state() != TrustState::kSuspect) return 0.1 * i;
    trust.OnCoObservation(observation, true, kConfig);
  }
  return std::nan("");
}

TEST(SenderTrust, ThreeConsistentMessagesMakeACandidate) {
  SenderTrust trust;
  trust.OnMessage(At(0.0), true, kConfig);
  trust.OnMessage(At(0.1), true, kConfig);
  trust.OnMessage(At(0.2), false, kConfig);
  trust.OnMessage(At(0.3), true, kConfig);
  EXPECT_EQ(trust.state(), TrustState::kUnknown);
  trust.OnMessage(At(0.4), true, kConfig);
  trust.OnMessage(At(0.5), true, kConfig);
  EXPECT_EQ(trust.state(), TrustState::kCandidate);
}

TEST(SenderTrust, EveryPieceOfEvidenceIsNeeded) {
  using Spoil = void (*)(ValidationEvidence&);
  const Spoil spoils[] = {[](ValidationEvidence& e) { e.co_observations = 9; },
                          [](ValidationEvidence& e) { e.span_s = 1.4; },
                          [](ValidationEvidence& e) { e.is_nis_consistent = false; },
                          [](ValidationEvidence& e) { e.is_speed_consistent = false; },
                          [](ValidationEvidence& e) { e.is_level_plausible = false; },
                          [](ValidationEvidence& e) { e.margin = 3.9; },
                          [](ValidationEvidence& e) { e.is_assigned = false; },
                          [](ValidationEvidence& e) { e.are_sensors_sure = false; },
                          [](ValidationEvidence& e) { e.is_ego_gnss_suspect = true; }};
  for (const Spoil spoil : spoils) {
    SenderTrust trust = Candidate();
    ValidationEvidence evidence = Good();
    spoil(evidence);
    EXPECT_FALSE(trust.TryValidate(evidence, kConfig));
    EXPECT_EQ(trust.state(), TrustState::kCandidate);
  }
  SenderTrust unknown;
  EXPECT_FALSE(unknown.TryValidate(Good(), kConfig));
}

// What a channel that is full leaves of a sender's rate.
TEST(SenderTrust, WhoSpeaksOnceASecondIsValidatedByFewerMessagesOverALongerTime) {
  ValidationEvidence evidence = Good();
  evidence.co_observations = 4;
  evidence.span_s = 3.0;
  EXPECT_TRUE(Candidate().TryValidate(evidence, kConfig));
  evidence.span_s = 2.0;
  EXPECT_FALSE(Candidate().TryValidate(evidence, kConfig));
  evidence.co_observations = 3;
  evidence.span_s = 3.0;
  EXPECT_FALSE(Candidate().TryValidate(evidence, kConfig));
}

TEST(SenderTrust, BridgesAndComesBack) {
  SenderTrust trust = Validated();
  trust.OnSensorsLost();
  EXPECT_EQ(trust.state(), TrustState::kBridged);
  trust.OnSensorsRegained();
  EXPECT_EQ(trust.state(), TrustState::kValidated);
  trust.Release(At(5.0));
  EXPECT_EQ(trust.state(), TrustState::kCandidate);

  // Known and not blamed: validated again sooner, but not much later.
  ValidationEvidence again = Good();
  again.co_observations = kConfig.again_observations;
  again.span_s = kConfig.again_observed_s;
  SenderTrust late = trust;
  again.stamp = At(8.0);
  EXPECT_TRUE(trust.TryValidate(again, kConfig));
  again.stamp = At(20.0);
  EXPECT_FALSE(late.TryValidate(again, kConfig));
}

TEST(SenderTrust, SuspectMustBeCleanAndTwiceAsLongTheSecondTime) {
  SenderTrust trust = Validated();
  const Finding finding{"test", Verdict::kWithdraw, "x", 1.0, 0.0};
  trust.OnFinding(At(10.0), finding, true);
  EXPECT_EQ(trust.state(), TrustState::kSuspect);
  EXPECT_TRUE(trust.TakeVerdict().has_value());
  EXPECT_FALSE(trust.TakeVerdict().has_value());
  // Silence cleans nobody, however long it lasts.
  trust.OnMessage(At(60.0), true, kConfig);
  EXPECT_EQ(trust.state(), TrustState::kSuspect);
  EXPECT_NEAR(AgreeUntilClean(trust, 60.0), kConfig.clean_s, 0.6);

  for (int i = 0; i < 3; ++i) trust.OnMessage(At(80.0 + 0.1 * i), true, kConfig);
  ASSERT_TRUE(trust.TryValidate(Good(), kConfig));
  trust.OnFinding(At(81.0), finding, true);
  EXPECT_EQ(trust.state(), TrustState::kSuspect);
  EXPECT_NEAR(AgreeUntilClean(trust, 81.0), 2.0 * kConfig.clean_s, 0.6);
}

TEST(SenderTrust, StrangersAreSuspectedForWhatIsTheirOwnAndNotForTheTrackTheyAreTakenFor) {
  SenderTrust stranger = Candidate();
  for (int i = 0; i < 30; ++i) {
    CoObservation far = Residual(0.0, 9.0);
    far.stamp = At(1.0 + 0.1 * i);
    stranger.OnCoObservation(far, true, kConfig);
  }
  EXPECT_EQ(stranger.state(), TrustState::kUnknown);
  EXPECT_FALSE(stranger.TakeVerdict().has_value());
  stranger.OnFinding(At(5.0), {"empty_place", Verdict::kWithdraw, "log_ratio", -5.0, -4.6}, true);
  EXPECT_EQ(stranger.state(), TrustState::kSuspect);
  EXPECT_TRUE(stranger.TakeVerdict().has_value());
}

TEST(SenderTrust, PenaltyIsInheritedWithItsDoubling) {
  SenderTrust liar = Validated();
  liar.OnFinding(At(10.0), {"test", Verdict::kWithdraw, "x", 1.0, 0.0}, true);
  SenderTrust heir = Candidate();
  heir.Inherit(liar.penalty());
  EXPECT_EQ(heir.state(), TrustState::kSuspect);
  EXPECT_NEAR(AgreeUntilClean(heir, 10.0), kConfig.clean_s, 0.6);
  SenderTrust other = Candidate();
  other.Inherit(Validated().penalty());
  EXPECT_EQ(other.state(), TrustState::kCandidate) << "no penalty, nothing to inherit";
}

TEST(SenderTrust, AccusationNeedsEvidenceThatLastsAndIsForbiddenWhileEgoIsInDoubt) {
  SenderTrust trust = Validated();
  const auto lie = [](double) { return Residual(0.0, 14.0); };
  const double t = RunUntilVerdict(trust, 0.0, 20.0, lie, Verdict::kAccuse);
  EXPECT_GE(t, kConfig.accuse_hold_s);
  EXPECT_LT(t, kConfig.accuse_hold_s + 2.0);
  EXPECT_EQ(trust.state(), TrustState::kRevoked);
  trust.OnMessage(At(t + 59.0), true, kConfig);
  EXPECT_EQ(trust.state(), TrustState::kRevoked);
  trust.OnMessage(At(t + 60.1), true, kConfig);
  EXPECT_EQ(trust.state(), TrustState::kUnknown);

  SenderTrust doubtful = Validated();
  for (int i = 0; i < 200; ++i) {
    CoObservation observation = Residual(0.0, 14.0);
    observation.stamp = At(0.1 * i);
    doubtful.OnCoObservation(observation, false, kConfig);
  }
  EXPECT_EQ(doubtful.state(), TrustState::kSuspect);
}

// With honest noise 0.5 m/s is withdrawn after 6 s (median); here there is none.
TEST(SenderTrust, SlowDriftIsWithdrawn) {
  SenderTrust trust = Validated();
  EXPECT_TRUE(std::isnan(RunUntilVerdict(
      trust, 0.0, 10.0, [](double) { return Residual(0.0, 1.0); }, Verdict::kWithdraw)));
  const double t = RunUntilVerdict(
      trust, 10.0, 20.0, [](double s) { return Residual(0.0, 1.0 + 0.5 * s); }, Verdict::kWithdraw);
  EXPECT_LT(t, 9.0);
  EXPECT_GT(t, 5.0);
}

// A sender that walks away from its vehicle at 2 m/s, as its claimed speed says too.
TEST(SenderTrust, LeavingIsWithdrawnUnlessTheSensorsAreUnsureThemselves) {
  const auto leaving = [](double sigma) {
    return [sigma](double t) {
      CoObservation observation = Residual(2.0 * t, 0.0);
      observation.speed_residual_mps = 2.0;
      observation.speed_sigma_mps = sigma;
      return observation;
    };
  };
  const auto staying = [](double) { return Residual(0.0, 0.0); };
  SenderTrust sure = Validated();
  RunUntilVerdict(sure, 0.0, 3.0, staying, Verdict::kWithdraw);
  EXPECT_LT(RunUntilVerdict(sure, 3.0, 5.0, leaving(0.1), Verdict::kWithdraw), 2.0);
  SenderTrust unsure = Validated();
  RunUntilVerdict(unsure, 0.0, 3.0, staying, Verdict::kWithdraw);
  EXPECT_GT(RunUntilVerdict(unsure, 3.0, 5.0, leaving(1.0), Verdict::kWithdraw), 2.0)
      << "found by its drift at last";
}

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
  EXPECT_EQ(liar.TakeVerdict()->finding.check, "residual_jump");
}

// A step that the two velocities explain is no tear: that is a sender walking off.
TEST(SenderTrust, WalkingOffIsNoTear) {
  SenderTrust trust = Validated();
  for (int i = 0; i < 40; ++i) {
    CoObservation observation = Residual(0.4 * i, 0.0);
    observation.stamp = At(0.1 * i);
    observation.velocity_residual_O = Eigen::Vector2d(4.0, 0.0);
    EXPECT_TRUE(trust.OnCoObservation(observation, true, kConfig)) << i;
  }
  EXPECT_EQ(trust.state(), TrustState::kSuspect) << "by its level";
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

TEST(SenderTrust, AShiftThatAllShareIsNotTheSendersFault) {
  const auto shifted = [](double) {
    CoObservation observation = Residual(6.0, 0.0);
    observation.is_ego_shifted = true;
    observation.shift_O = {5.0, 0.5};
    return observation;
  };
  SenderTrust honest = Validated();
  EXPECT_TRUE(std::isnan(RunUntilVerdict(honest, 0.0, 10.0, shifted, Verdict::kWithdraw)));
  const auto liar = [](double) {
    CoObservation observation = Residual(0.0, -8.0);
    observation.is_ego_shifted = true;
    observation.shift_O = {5.0, 0.5};
    return observation;
  };
  SenderTrust caught = Validated();
  EXPECT_LT(RunUntilVerdict(caught, 0.0, 10.0, liar, Verdict::kWithdraw), 3.0);
}

TEST(SenderTrust, WhoIsNotOffIsNotBlamedForAShiftThatOthersTellTogether) {
  const auto outvoted = [](double) {
    CoObservation observation = Residual(-1.2, -1.4);
    observation.is_ego_shifted = true;
    observation.shift_O = {-10.0, 3.0};
    return observation;
  };
  SenderTrust honest = Validated();
  EXPECT_TRUE(std::isnan(RunUntilVerdict(honest, 0.0, 10.0, outvoted, Verdict::kWithdraw)));
}

TEST(SenderTrust, FeignedBrakingIsWithdrawnAfterThreeSeconds) {
  SenderTrust trust = Validated();
  const double t = RunUntilVerdict(
      trust, 0.0, 10.0,
      [](double) {
        CoObservation observation = Residual(0.0, 0.0);
        observation.accel_residual_mps2 = -6.0;
        return observation;
      },
      Verdict::kWithdraw);
  EXPECT_GE(t, 3.0);
  EXPECT_LT(t, 5.0);
}

// 0.1 h of an honest receiver: bias of 1.5 m per axis that wanders with 100 s, 1 m of noise. A
// linear Monte Carlo of these gates gave 2.1 withdrawals per vehicle-hour and no accusation.
TEST(SenderTrust, HonestGnssErrorIsNeverAccusedAndRarelyWithdrawn) {
  Random random(11);
  int withdrawn = 0;
  int accused = 0;
  for (int run = 0; run < 60; ++run) {  // 60 x 60 s = 1 vehicle-hour.
    SenderTrust trust = Validated();
    Eigen::Vector2d bias(1.5 * random.Normal(), 1.5 * random.Normal());
    const double phi = std::exp(-0.1 / 100.0);
    const double drive = 1.5 * std::sqrt(1.0 - phi * phi);
    for (int i = 0; i < 600; ++i) {
      bias = phi * bias + drive * Eigen::Vector2d(random.Normal(), random.Normal());
      CoObservation observation = Residual(bias.x() + random.Normal(), bias.y() + random.Normal());
      observation.stamp = At(0.1 * i);
      trust.OnMessage(observation.stamp, true, kConfig);
      trust.OnCoObservation(observation, true, kConfig);
      const auto verdict = trust.TakeVerdict();
      withdrawn += verdict && verdict->verdict == Verdict::kWithdraw ? 1 : 0;
      accused += verdict && verdict->verdict == Verdict::kAccuse ? 1 : 0;
    }
  }
  EXPECT_EQ(accused, 0);
  EXPECT_LE(withdrawn, 5);
  RecordProperty("withdrawn_per_hour", withdrawn);
}

TEST(Checks, ASizeThatCannotBeTheSensedVehiclesIsNotPlausible) {
  const Extent car{.length_m = 4.5, .width_m = 1.8, .length_sigma_m = 0.3, .width_sigma_m = 0.1};
  EXPECT_TRUE(IsSizePlausible(4.2, 1.9, car, kConfig));
  EXPECT_TRUE(IsSizePlausible(std::nullopt, std::nullopt, car, kConfig));
  EXPECT_FALSE(IsSizePlausible(13.5, 1.8, car, kConfig));
  EXPECT_FALSE(IsSizePlausible(4.5, 4.5, car, kConfig));
  const Extent unknown{
      .length_m = 4.5, .width_m = 1.8, .length_sigma_m = 3.0, .width_sigma_m = 0.3};
  EXPECT_TRUE(IsSizePlausible(12.0, 2.5, unknown, kConfig)) << "the sensors do not know better";
}

}  // namespace
}  // namespace v2vouch
