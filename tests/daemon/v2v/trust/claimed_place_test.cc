// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/trust/claimed_place.h"

#include <gtest/gtest.h>

#include <numeric>

namespace v2vouch {
namespace {

const ClaimedPlaceConfig kConfig;
using Look = ClaimedPlace::Look;
using Seen = ClaimedPlace::Seen;

Timestamp At(double time_s) { return FromMicros(1'000'000'000) + FromSeconds(time_s); }

std::array<Look, ClaimedPlace::kPlaces> All(Look look) {
  std::array<Look, ClaimedPlace::kPlaces> looks;
  looks.fill(look);
  return looks;
}

// Looks every 0.3 s; @return when it withdraws, or NaN.
double RunUntilWithdrawn(ClaimedPlace& place, const std::array<Look, ClaimedPlace::kPlaces>& looks,
                         double for_s) {
  for (int i = 0; 0.3 * i < for_s; ++i) {
    place.OnLook(At(0.3 * i), looks, kConfig);
    if (place.Judge(5.0, kConfig)) return 0.3 * i;
  }
  return std::nan("");
}

TEST(ClaimedPlace, WeightsAreADistributionOfUnitVariance) {
  double weight = 0.0, along = 0.0, across = 0.0;
  for (const ClaimedPlace::Place& place : ClaimedPlace::Places()) {
    weight += place.weight;
    along += place.weight * place.along * place.along;
    across += place.weight * place.across * place.across;
  }
  EXPECT_NEAR(weight, 1.0, 1e-9);
  EXPECT_NEAR(along, 1.0, 1e-6);
  EXPECT_NEAR(across, 1.0, 1e-6);
}

TEST(ClaimedPlace, EmptyInClearViewIsWithdrawnInAboutASecondAndAccusedAfterTheHold) {
  ClaimedPlace place;
  const double t = RunUntilWithdrawn(place, All({Seen::kEmpty, 0.95}), 5.0);
  EXPECT_GE(t, 0.6) << "one missed detection is nothing";
  EXPECT_LE(t, 1.2);
  EXPECT_EQ(place.Judge(5.0, kConfig)->severity, Verdict::kWithdraw);
  double accused = 0.0;
  for (int i = 1; accused == 0.0 && i < 60; ++i) {
    place.OnLook(At(t + 0.3 * i), All({Seen::kEmpty, 0.95}), kConfig);
    if (place.Judge(5.0, kConfig)->severity == Verdict::kAccuse) accused = t + 0.3 * i;
  }
  EXPECT_GE(accused, 5.0);
  EXPECT_LE(accused, 8.0);
}

TEST(ClaimedPlace, HiddenOrUnknownLosesNothing) {
  ClaimedPlace place;
  EXPECT_TRUE(std::isnan(RunUntilWithdrawn(place, All({Seen::kUnknown, 0.0}), 30.0)));
  EXPECT_NEAR(place.log_ratio(), 0.0, 1e-12);
}

// A bias of a few metres may have put an honest car behind what covers one of the places.
TEST(ClaimedPlace, OneSideThatCannotBeSeenIsEnough) {
  for (std::size_t hidden = 0; hidden < 5; ++hidden) {
    auto looks = All({Seen::kEmpty, 0.95});
    looks[hidden] = {Seen::kUnknown, 0.0};
    ClaimedPlace place;
    EXPECT_TRUE(std::isnan(RunUntilWithdrawn(place, looks, 30.0))) << hidden;
    looks[hidden] = {Seen::kOccupied, 0.0};
    ClaimedPlace beside;
    EXPECT_TRUE(std::isnan(RunUntilWithdrawn(beside, looks, 30.0))) << hidden;
  }
}

TEST(ClaimedPlace, OneHiddenCornerOnlyTakesLonger) {
  auto looks = All({Seen::kEmpty, 0.95});
  looks[8] = {Seen::kUnknown, 0.0};
  ClaimedPlace place;
  const double t = RunUntilWithdrawn(place, looks, 10.0);
  EXPECT_GE(t, kConfig.lasting_s);
  EXPECT_LE(t, kConfig.lasting_s + 3.0);
}

TEST(ClaimedPlace, SomebodyDrivingPastClearsOnlyForAMoment) {
  ClaimedPlace place;
  double withdrawn = 0.0;
  for (int i = 0; i < 40 && withdrawn == 0.0; ++i) {
    const bool passes = i % 8 == 3;  // For 0.3 s in every 2.4 s.
    place.OnLook(At(0.3 * i), All({passes ? Seen::kOccupied : Seen::kEmpty, 0.9}), kConfig);
    if (place.Judge(5.0, kConfig)) withdrawn = 0.3 * i;
  }
  EXPECT_GT(withdrawn, 0.0);
  EXPECT_LT(withdrawn, 5.0);
}

TEST(ClaimedPlace, DoubtFadesWhileNobodyCanLookAndEndsWhereTheSensorsVouch) {
  ClaimedPlace place;
  for (int i = 0; i < 2; ++i) place.OnLook(At(0.3 * i), All({Seen::kEmpty, 0.95}), kConfig);
  const double before = place.log_ratio();
  EXPECT_TRUE(place.has_doubt());
  for (int i = 0; i < 17; ++i) place.OnLook(At(0.6 + 0.3 * i), All({}), kConfig);
  EXPECT_NEAR(place.log_ratio(), before * std::exp(-5.1 / kConfig.recovery_s), 0.05);
  place.OnVouched();
  EXPECT_FALSE(place.has_doubt());
}

TEST(ClaimedPlace, LooksAreSpaced) {
  ClaimedPlace place;
  EXPECT_TRUE(place.IsDue(At(0.0), kConfig));
  place.OnLook(At(0.0), All({}), kConfig);
  EXPECT_FALSE(place.IsDue(At(0.25), kConfig));
  EXPECT_TRUE(place.IsDue(At(0.3), kConfig));
}

}  // namespace
}  // namespace v2vouch
