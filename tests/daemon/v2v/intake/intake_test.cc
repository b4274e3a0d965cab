// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/intake/intake.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/daemon/v2v/intake/talking_car.h"

namespace v2vouch {
namespace {

TEST(BsmIntake, TakesAnHonestCarAndFollowsIt) {
  BsmIntake intake{IntakeConfig{}};
  TalkingCar car;
  for (int i = 0; i < 50; ++i) {
    car.Drive(0.1);
    const auto claim = intake.Accept(car.Say(), EgoAtCrossroads());
    ASSERT_EQ(WhyNot(claim), kTaken);
    EXPECT_EQ(claim->sender, car.id);
    EXPECT_NEAR(claim->age_s, 0.1, 1e-6);
  }
  ASSERT_NE(intake.Find(car.id), nullptr);
  EXPECT_EQ(intake.Find(car.id)->messages, 50U);
  EXPECT_EQ(intake.Find(car.id)->clean_run, 50.0);
  EXPECT_EQ(intake.Find(car.id + 1), nullptr);
}

TEST(BsmIntake, RefusesWithTheRightReason) {
  BsmIntake intake{IntakeConfig{}};
  const TalkingCar car;
  const EgoPlace ego = EgoAtCrossroads();
  const auto why = [&](auto spoil) {
    Bsm bsm = car.Say();
    spoil(bsm);
    return WhyNot(intake.Accept(bsm, ego));
  };
  EXPECT_EQ(why([](Bsm& b) { b.signature = SignatureState::kInvalid; }), Reason::kBsmSignature);
  EXPECT_EQ(why([](Bsm& b) { b.speed_mps.reset(); }), Reason::kBsmUnavailable);
  EXPECT_EQ(why([](Bsm& b) { b.stamp += FromSeconds(1.5); }), Reason::kBsmStale);
  EXPECT_EQ(why([](Bsm& b) { b.stamp -= FromSeconds(0.5); }), Reason::kBsmFuture);
  EXPECT_EQ(why([](Bsm& b) { b.generation = b.stamp - FromSeconds(60.0); }), Reason::kBsmStale);
  EXPECT_EQ(why([](Bsm& b) { *b.latitude_rad += 1100.0 / 6.37e6; }), Reason::kBsmImplausible);
  EXPECT_EQ(why([](Bsm& b) { *b.latitude_rad += 900.0 / 6.37e6; }), kTaken);
  EXPECT_EQ(WhyNot(intake.Accept(car.Say(), EgoPlace{})), Reason::kNoGnss);
}

TEST(BsmIntake, HeightDoesNotMakeASenderFar) {
  BsmIntake intake{IntakeConfig{}};
  Bsm bsm = TalkingCar{}.Say();
  bsm.elevation_m = 2000.0;  // Ours stands at 250 m, or our receiver has no height.
  EXPECT_EQ(WhyNot(intake.Accept(bsm, EgoAtCrossroads())), kTaken);
}

TEST(BsmIntake, ALittleFutureIsNoAge) {
  BsmIntake intake{IntakeConfig{}};
  TalkingCar car;
  car.latency_s = -0.2;
  const auto claim = intake.Accept(car.Say(), EgoAtCrossroads());
  ASSERT_EQ(WhyNot(claim), kTaken);
  EXPECT_EQ(claim->age_s, 0.0);
}

TEST(BsmIntake, HearsItselfByIdAndByPlace) {
  IntakeConfig config;
  config.own_id = 42;
  BsmIntake intake{config};
  TalkingCar car;
  car.id = 42;
  EXPECT_EQ(WhyNot(intake.Accept(car.Say(), EgoAtCrossroads())), Reason::kBsmOwnEcho);
  car.id = 43;
  car.east_m = 0.5;
  car.north_m = 0.5;
  car.speed_mps = 0.0;
  EXPECT_EQ(WhyNot(intake.Accept(car.Say(), EgoAtCrossroads())), Reason::kBsmOwnEcho);
  car.north_m = 5.0;
  EXPECT_EQ(WhyNot(intake.Accept(car.Say(), EgoAtCrossroads())), kTaken);
}

TEST(BsmIntake, RepeatsAreRefusedAlsoExactlyOneMinuteLater) {
  BsmIntake intake{IntakeConfig{}};
  TalkingCar car;
  Bsm bsm = car.Say();
  EXPECT_EQ(WhyNot(intake.Accept(bsm, EgoAtCrossroads())), kTaken);
  bsm.stamp += FromSeconds(0.05);
  EXPECT_EQ(WhyNot(intake.Accept(bsm, EgoAtCrossroads())), Reason::kBsmRepeat);
  bsm.stamp += FromSeconds(59.95);  // secMark fits again.
  EXPECT_EQ(WhyNot(intake.Accept(bsm, EgoAtCrossroads())), Reason::kBsmRepeat);
  EXPECT_EQ(intake.Find(car.id)->messages, 1U);
}

TEST(BsmIntake, EchoesByOthersDoNotSpendASendersBudget) {
  BsmIntake intake{IntakeConfig{}};
  TalkingCar car;
  for (int i = 0; i < 30; ++i) {
    car.Drive(0.1);
    Bsm bsm = car.Say();
    ASSERT_EQ(WhyNot(intake.Accept(bsm, EgoAtCrossroads())), kTaken);
    for (int echo = 0; echo < 20; ++echo) {
      bsm.stamp += FromMicros(1000).time_since_epoch();
      ASSERT_EQ(WhyNot(intake.Accept(bsm, EgoAtCrossroads())), Reason::kBsmRepeat);
    }
  }
}

TEST(BsmIntake, TheSameCoreUnderAnotherIdMarksBoth) {
  BsmIntake intake{IntakeConfig{}};
  TalkingCar car;
  TalkingCar bystander;
  bystander.id = 5;
  bystander.north_m = 40.0;
  ASSERT_EQ(WhyNot(intake.Accept(car.Say(), EgoAtCrossroads())), kTaken);
  ASSERT_EQ(WhyNot(intake.Accept(bystander.Say(), EgoAtCrossroads())), kTaken);
  Bsm copy = car.Say();
  copy.sender = 666;
  EXPECT_EQ(WhyNot(intake.Accept(copy, EgoAtCrossroads())), kTaken);
  EXPECT_EQ(intake.Find(666)->contested, 1U);
  EXPECT_EQ(intake.Find(car.id)->contested, 1U);
  EXPECT_EQ(intake.Find(car.id)->last_contested, copy.stamp);
  EXPECT_EQ(intake.Find(5)->contested, 0U);
}

TEST(BsmIntake, ASenderThatSpeaksTooOftenIsCutToItsRate) {
  BsmIntake intake{IntakeConfig{}};
  TalkingCar car;
  int taken = 0;
  for (int i = 0; i < 1000; ++i) {  // 100 Hz for 10 s.
    car.Drive(0.01);
    taken += intake.Accept(car.Say(), EgoAtCrossroads()) ? 1 : 0;
  }
  EXPECT_NEAR(taken, 10 + 120, 2);  // The burst and 12 Hz.
  EXPECT_EQ(intake.Find(car.id)->over_rate, static_cast<std::uint64_t>(1000 - taken));
}

TEST(BsmIntake, PairsFiftyMillisecondsApartAreHonest) {
  BsmIntake intake{IntakeConfig{}};
  TalkingCar car;
  for (int i = 0; i < 200; ++i) {  // As in real logs: 10 Hz with every tenth message doubled.
    car.Drive(0.05);
    if (i % 2 == 0 || i % 20 == 1) {
      ASSERT_EQ(WhyNot(intake.Accept(car.Say(), EgoAtCrossroads())), kTaken) << i;
    }
  }
}

TEST(BsmIntake, UnderTotalOverloadKnownSendersGoFirst) {
  IntakeConfig config;
  config.max_total_rate_hz = 100.0;
  BsmIntake intake{config};
  TalkingCar known;
  ASSERT_EQ(WhyNot(intake.Accept(known.Say(), EgoAtCrossroads())), kTaken);
  int strangers_refused = 0;
  for (int i = 1; i < 1000; ++i) {
    TalkingCar stranger;
    stranger.id = static_cast<SenderId>(1000 + i);
    stranger.time_s = known.time_s + 0.001 * (i % 100);
    stranger.north_m = 30.0 + 0.1 * i;
    strangers_refused += intake.Accept(stranger.Say(), EgoAtCrossroads()) ? 0 : 1;
    if (i % 100 == 0) {
      known.Drive(0.1);
      ASSERT_EQ(WhyNot(intake.Accept(known.Say(), EgoAtCrossroads())), kTaken) << i;
    }
  }
  EXPECT_GT(strangers_refused, 800);
}

// Fills a table of 16 with ids 100..115, one every 10 ms; afterwards it is 0.15 s past noon.
std::vector<TalkingCar> Fill(BsmIntake& intake) {
  std::vector<TalkingCar> cars(16);
  for (std::size_t i = 0; i < cars.size(); ++i) {
    cars[i].id = static_cast<SenderId>(100 + i);
    cars[i].north_m = 20.0 + 5.0 * static_cast<double>(i);
    cars[i].time_s = 0.01 * static_cast<double>(i);
    EXPECT_EQ(WhyNot(intake.Accept(cars[i].Say(), EgoAtCrossroads())), kTaken);
  }
  return cars;
}

TEST(BsmIntake, AFullTableGivesUpWhoWasUnheardForLongest) {
  IntakeConfig config;
  config.max_senders = 16;
  BsmIntake intake{config};
  Fill(intake);
  intake.Pin(100, true);
  TalkingCar newcomer;
  newcomer.id = 7;
  newcomer.time_s = 0.5;
  EXPECT_EQ(WhyNot(intake.Accept(newcomer.Say(), EgoAtCrossroads())), Reason::kBsmTableFull);
  newcomer.time_s = 2.0;
  EXPECT_EQ(WhyNot(intake.Accept(newcomer.Say(), EgoAtCrossroads())), kTaken);
  EXPECT_NE(intake.Find(100), nullptr);  // Pinned.
  EXPECT_EQ(intake.Find(101), nullptr);  // The next oldest.
  EXPECT_NE(intake.Find(102), nullptr);
  EXPECT_EQ(intake.senders().size(), 16U);
}

TEST(BsmIntake, ATableOfPinnedSendersTakesNobodyElse) {
  IntakeConfig config;
  config.max_senders = 16;
  BsmIntake intake{config};
  for (const TalkingCar& car : Fill(intake)) intake.Pin(car.id, true);
  TalkingCar newcomer;
  newcomer.id = 7;
  newcomer.time_s = 3.0;
  EXPECT_EQ(WhyNot(intake.Accept(newcomer.Say(), EgoAtCrossroads())), Reason::kBsmTableFull);
  intake.Pin(115, false);
  EXPECT_EQ(WhyNot(intake.Accept(newcomer.Say(), EgoAtCrossroads())), kTaken);
}

TEST(BsmIntake, SilentSendersExpire) {
  BsmIntake intake{IntakeConfig{}};
  TalkingCar early;
  TalkingCar late;
  late.id = 9;
  late.north_m = 40.0;
  late.time_s = 3.0;
  ASSERT_EQ(WhyNot(intake.Accept(early.Say(), EgoAtCrossroads())), kTaken);
  ASSERT_EQ(WhyNot(intake.Accept(late.Say(), EgoAtCrossroads())), kTaken);
  intake.Expire(FromMicros(kNoon_us) + FromSeconds(5.0));
  EXPECT_NE(intake.Find(early.id), nullptr);
  intake.Expire(FromMicros(kNoon_us) + FromSeconds(5.7));
  EXPECT_EQ(intake.Find(early.id), nullptr);
  EXPECT_NE(intake.Find(late.id), nullptr);
}

TEST(BsmIntake, SendersAreOrderedById) {
  BsmIntake intake{IntakeConfig{}};
  for (const SenderId id : {9U, 0xffffffffU, 3U, 0x80000000U, 5U}) {
    TalkingCar car;
    car.id = id;
    car.north_m = 10.0 + id % 97;
    ASSERT_EQ(WhyNot(intake.Accept(car.Say(), EgoAtCrossroads())), kTaken);
  }
  EXPECT_TRUE(std::is_sorted(
      intake.senders().begin(), intake.senders().end(),
      [](const SenderTrack& a, const SenderTrack& b) { return a.sender < b.sender; }));
  EXPECT_EQ(intake.senders().size(), 5U);
}

}  // namespace
}  // namespace v2vouch
