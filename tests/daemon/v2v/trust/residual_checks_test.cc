// SPDX-License-Identifier: Apache-2.0
// What a sender that the sensors see is withdrawn or accused for.
#include "daemon/common/base/random.h"
#include "tests/daemon/v2v/trust/sender_evidence.h"

namespace v2vouch {
namespace {

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

// Leaves its vehicle at `moved_mps` and says that it does so at `said_mps`.
bool WalksOff(double moved_mps, double said_mps, double for_s) {
  SenderTrust trust = Validated();
  const auto residual = [](double moved_m, double said) {
    CoObservation observation = Residual(0.0, 1.0 + moved_m);
    observation.velocity_residual_O = Eigen::Vector2d(0.0, said);
    return observation;
  };
  RunUntilVerdict(
      trust, 0.0, 5.0, [&](double) { return residual(0.0, 0.0); }, Verdict::kWithdraw);
  const double withdrawn_s = RunUntilVerdict(
      trust, 5.0, for_s, [&](double s) { return residual(moved_mps * s, said_mps); },
      Verdict::kWithdraw);
  EXPECT_TRUE(std::isnan(withdrawn_s));
  return IsWalkingOff(trust.history(), kConfig);
}

TEST(Checks, ASenderThatWalksOffIsKnownBeforeItIsWithdrawn) {
  EXPECT_FALSE(WalksOff(0.0, 0.0, 3.0));
  EXPECT_TRUE(WalksOff(1.0, 1.0, 2.2));
  EXPECT_TRUE(WalksOff(0.5, 0.5, 4.5));
}

TEST(Checks, AReceiverThatWandersOrErrsInItsHeadingDoesNotWalkOff) {
  EXPECT_FALSE(WalksOff(0.5, 0.0, 4.5)) << "a bias that wanders";
  EXPECT_FALSE(WalksOff(0.0, 0.5, 4.5)) << "a heading that is off";
  EXPECT_FALSE(WalksOff(0.5, -0.5, 4.5));
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
