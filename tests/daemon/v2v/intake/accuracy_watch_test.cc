// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/intake/accuracy_watch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "daemon/v2v/intake/intake.h"
#include "tests/daemon/v2v/intake/talking_car.h"

namespace v2vouch {
namespace {

constexpr double kBelieved_m = 3.0;

struct Receiver {
  AccuracyWatch watch;
  double time_s = 0.0;

  bool IsBad(std::optional<double> reported_m, double dt_s = 0.1) {
    time_s += dt_s;
    return watch.IsBadNow(Timestamp{} + FromSeconds(time_s), reported_m, kBelieved_m);
  }
  int BadOf(double reported_m, double for_s) {
    int bad = 0;
    for (int i = 0; i < static_cast<int>(for_s * 10.0); ++i) bad += IsBad(reported_m) ? 1 : 0;
    return bad;
  }
};

TEST(AccuracyWatch, AGoodReceiverThatReportsFourMetresIsBadUntilItIsGoodAgain) {
  Receiver receiver;
  EXPECT_EQ(receiver.BadOf(0.8, 5.0), 0);
  EXPECT_EQ(receiver.BadOf(4.0, 5.0), 50);
  EXPECT_EQ(receiver.BadOf(0.8, 5.0), 0);
}

TEST(AccuracyWatch, APhoneIsUsedAsItIs) {
  Receiver receiver;
  for (int i = 0; i < 600; ++i) EXPECT_FALSE(receiver.IsBad(4.25 + 0.75 * std::sin(0.1 * i))) << i;
}

TEST(AccuracyWatch, WhatIsBelievedAndWhatIsUnavailableIsNeverBad) {
  Receiver receiver;
  EXPECT_EQ(receiver.BadOf(0.5, 1.0), 0);
  EXPECT_EQ(receiver.BadOf(3.0, 1.0), 0);
  EXPECT_FALSE(receiver.IsBad(std::nullopt));
}

// The usual 0.8 m has grown to 2.5 m, half of what is reported, after 20 s * log2(2.5 / 0.8) = 33
// s.
TEST(AccuracyWatch, WhatLastsIsUsual) {
  Receiver receiver;
  receiver.BadOf(0.8, 1.0);
  const int bad = receiver.BadOf(5.0, 60.0);
  EXPECT_GE(bad, 325);
  EXPECT_LE(bad, 335);
  EXPECT_EQ(receiver.BadOf(5.0, 10.0), 0);
}

TEST(AccuracyWatch, OneFirstHeardWhileItIsBadIsBadUntilItsAccuracySettles) {
  Receiver receiver;
  EXPECT_EQ(receiver.BadOf(5.0, 1.0), 0);  // May be a phone.
  for (const double reported_m : {4.1, 3.2, 2.4, 1.6, 1.0}) EXPECT_TRUE(receiver.IsBad(reported_m));
  EXPECT_EQ(receiver.BadOf(1.0, 1.0), 0);
  EXPECT_TRUE(receiver.IsBad(5.0));
}

// A liar that reports a spell of poor accuracy ever and again does not escape the path check.
TEST(AccuracyWatch, ShortSpellsDoNotHideAFalseSpeed) {
  BsmIntake intake{IntakeConfig{}};
  TalkingCar car;
  int findings = 0;
  for (int i = 0; i < 200; ++i) {
    car.Drive(0.1);
    Bsm bsm = car.Say();
    bsm.semi_major_m = i % 10 == 9 ? 5.0 : 0.8;
    bsm.speed_mps = 15.0;  // It drives 10 m/s.
    const auto claim = intake.Accept(bsm, EgoAtCrossroads());
    ASSERT_EQ(WhyNot(claim), kTaken);
    EXPECT_EQ(claim->accuracy_is_poor, i % 10 == 9) << i;
    findings += claim->finding && claim->finding->check == Check::kSpeedAgainstPath;
  }
  EXPECT_GT(findings, 50);
}

}  // namespace
}  // namespace v2vouch
