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
                          [](ValidationEvidence& e) { e.is_level_plausible = false; },
                          [](ValidationEvidence& e) { e.margin = 3.9; },
                          [](ValidationEvidence& e) { e.is_assigned = false; },
                          [](ValidationEvidence& e) { e.are_sensors_sure = false; },
                          [](ValidationEvidence& e) { e.is_accuracy_poor = true; },
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

TEST(SenderTrust, BridgesAndComesBack) {
  SenderTrust trust = Validated();
  trust.OnSensorsLost();
  EXPECT_EQ(trust.state(), TrustState::kBridged);
  trust.OnSensorsRegained();
  EXPECT_EQ(trust.state(), TrustState::kValidated);
  trust.Release();
  EXPECT_EQ(trust.state(), TrustState::kCandidate);
}

TEST(SenderTrust, SuspectMustBeCleanAndTwiceAsLongTheSecondTime) {
  SenderTrust trust = Validated();
  const Finding finding{"test", Verdict::kWithdraw, "x", 1.0, 0.0};
  trust.OnFinding(At(10.0), finding, true);
  EXPECT_EQ(trust.state(), TrustState::kSuspect);
  EXPECT_TRUE(trust.TakeVerdict().has_value());
  EXPECT_FALSE(trust.TakeVerdict().has_value());
  trust.OnMessage(At(14.9), true, kConfig);
  EXPECT_EQ(trust.state(), TrustState::kSuspect);
  trust.OnMessage(At(15.0), true, kConfig);
  EXPECT_EQ(trust.state(), TrustState::kCandidate);

  for (int i = 0; i < 3; ++i) trust.OnMessage(At(15.1 + 0.1 * i), true, kConfig);
  ASSERT_TRUE(trust.TryValidate(Good(), kConfig));
  trust.OnFinding(At(20.0), finding, true);
  trust.OnMessage(At(29.9), true, kConfig);
  EXPECT_EQ(trust.state(), TrustState::kSuspect);
  trust.OnMessage(At(30.0), true, kConfig);
  EXPECT_EQ(trust.state(), TrustState::kCandidate);
}

TEST(SenderTrust, AccusationNeedsEvidenceThatLastsAndIsForbiddenWhileEgoIsInDoubt) {
  SenderTrust trust = Validated();
  const auto lie = [](double) { return Residual(0.0, 9.0); };
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
    CoObservation observation = Residual(0.0, 9.0);
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

TEST(SenderTrust, FalseSpeedIsWithdrawnUnlessTheSensorsAreUnsureThemselves) {
  const auto fast = [](double sigma) {
    return [sigma](double) {
      CoObservation observation = Residual(0.0, 0.0);
      observation.speed_residual_mps = 2.0;
      observation.speed_sigma_mps = sigma;
      return observation;
    };
  };
  SenderTrust sure = Validated();
  EXPECT_LT(RunUntilVerdict(sure, 0.0, 5.0, fast(0.1), Verdict::kWithdraw), 1.5);
  SenderTrust unsure = Validated();
  EXPECT_TRUE(std::isnan(RunUntilVerdict(unsure, 0.0, 5.0, fast(1.0), Verdict::kWithdraw)));
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

TEST(Checks, JumpIsJudgedAgainstDistanceAndTime) {
  EXPECT_FALSE(CheckJump(9.9, 0.1, kConfig).has_value());
  EXPECT_TRUE(CheckJump(10.1, 0.1, kConfig).has_value());
  EXPECT_FALSE(CheckJump(60.0, 1.0, kConfig).has_value());
}

}  // namespace
}  // namespace v2vouch
