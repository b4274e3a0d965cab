// SPDX-License-Identifier: Apache-2.0
// The state machine: how a sender comes to be trusted, loses it and wins it back.
#include "tests/daemon/v2v/trust/sender_evidence.h"

namespace v2vouch {
namespace {

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
  const Finding finding{Check::kResidualLevel, Verdict::kWithdraw, "x", 1.0, 0.0};
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
  stranger.OnFinding(At(5.0), {Check::kEmptyPlace, Verdict::kWithdraw, "log_ratio", -5.0, -4.6},
                     true);
  EXPECT_EQ(stranger.state(), TrustState::kSuspect);
  EXPECT_TRUE(stranger.TakeVerdict().has_value());
}

TEST(SenderTrust, PenaltyIsInheritedWithItsDoubling) {
  SenderTrust liar = Validated();
  liar.OnFinding(At(10.0), {Check::kResidualLevel, Verdict::kWithdraw, "x", 1.0, 0.0}, true);
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

}  // namespace
}  // namespace v2vouch
