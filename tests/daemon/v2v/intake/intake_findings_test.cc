// SPDX-License-Identifier: Apache-2.0
// Which claim carries which finding.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "daemon/v2v/intake/intake.h"
#include "tests/daemon/v2v/intake/talking_car.h"

namespace v2vouch {
namespace {

class IntakeFindings : public ::testing::Test {
 protected:
  Result<Claim> Hear(const Bsm& bsm) { return intake_.Accept(bsm, EgoAtCrossroads()); }
  void HearFor(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds * 10.0); ++i) {
      car_.Drive(0.1);
      const auto claim = Hear(car_.Say());
      ASSERT_EQ(WhyNot(claim), kTaken);
      EXPECT_FALSE(claim->finding) << NameOf(claim->finding->check);
    }
  }

  BsmIntake intake_{IntakeConfig{}};
  TalkingCar car_;
};

TEST_F(IntakeFindings, AnHonestCarHasNone) { HearFor(30.0); }

TEST_F(IntakeFindings, ImplausibleMessagesAreRefusedAndHeldAgainstTheNextClaim) {
  HearFor(1.0);
  for (int i = 0; i < 3; ++i) {
    car_.Drive(0.1);
    Bsm bsm = car_.Say();
    bsm.accel_long_mps2 = -15.0;
    EXPECT_EQ(WhyNot(Hear(bsm)), Reason::kBsmImplausible);
  }
  car_.Drive(0.1);
  const auto claim = Hear(car_.Say());
  ASSERT_EQ(WhyNot(claim), kTaken);
  ASSERT_TRUE(claim->finding);
  EXPECT_EQ(claim->finding->check, Check::kImplausible);
}

TEST_F(IntakeFindings, ImplausibleMessagesOfStrangersLeaveNothingBehind) {
  for (int i = 0; i < 5; ++i) {
    car_.Drive(0.1);
    Bsm bsm = car_.Say();
    bsm.speed_mps = 80.0;
    EXPECT_EQ(WhyNot(Hear(bsm)), Reason::kBsmImplausible);
  }
  EXPECT_TRUE(intake_.senders().empty());
  HearFor(1.0);
}

TEST_F(IntakeFindings, AFloodUnderOneIdIsAccusedOnTheClaimsThatAreTaken) {
  bool is_accused = false;
  for (int i = 0; i < 1200; ++i) {  // 400 Hz for 3 s.
    car_.Drive(0.0025);
    const auto claim = Hear(car_.Say());
    if (!claim) {
      EXPECT_EQ(claim.reason(), Reason::kBsmRate);
      continue;
    }
    if (claim->finding && claim->finding->severity == Verdict::kAccuse) {
      EXPECT_EQ(claim->finding->check, Check::kMessageRate);
      is_accused = true;
    }
  }
  EXPECT_TRUE(is_accused);
}

TEST_F(IntakeFindings, ACoreUnderTwoIdsIsHeldAgainstBothButAccusesNobody) {
  HearFor(1.0);
  Bsm copy = car_.Say();
  copy.sender = 666;
  copy.stamp += FromSeconds(0.02);
  const auto claim = Hear(copy);
  ASSERT_EQ(WhyNot(claim), kTaken);
  ASSERT_TRUE(claim->finding);
  EXPECT_EQ(claim->finding->check, Check::kContestedCore);
  EXPECT_EQ(claim->finding->severity, Verdict::kWithdraw);
  car_.Drive(0.1);
  const auto next = Hear(car_.Say());
  ASSERT_EQ(WhyNot(next), kTaken);
  ASSERT_TRUE(next->finding);
  EXPECT_EQ(next->finding->check, Check::kContestedCore);
  HearFor(1.0);  // Told once.
}

// Two kinds of honest units: in reverse one tells where it moves, the other where it looks.
TEST_F(IntakeFindings, BackingUpIsHonestWhicheverDirectionIsTold) {
  for (const bool tells_body : {false, true}) {
    BsmIntake intake{IntakeConfig{}};
    TalkingCar car;
    for (int i = 0; i < 200; ++i) {
      car.speed_mps = i < 50 ? 0.0 : std::max(-3.0, -0.15 * (i - 50));  // Looks east.
      car.Drive(0.1);
      Bsm bsm = car.Say();
      if (i >= 45) {  // The gear goes in while it still stands.
        bsm.transmission = Transmission::kReverse;
        bsm.course_rad = tells_body ? 0.0 : kPi;
      }
      const auto claim = intake.Accept(bsm, EgoAtCrossroads());
      ASSERT_EQ(WhyNot(claim), kTaken);
      EXPECT_FALSE(claim->finding) << NameOf(claim->finding->check) << " at " << i;
      EXPECT_LE(claim->speed_mps, 0.0);
      EXPECT_GT(claim->course_E.dot(EgoAtCrossroads().course_E), 0.99) << i;
    }
  }
}

// What a unit means by heading is settled by where it goes, whatever its first message was like.
TEST_F(IntakeFindings, BackingUpIsReadByDisplacementWhateverTheUnitTells) {
  const auto east = EgoAtCrossroads().course_E;
  for (const Transmission gear : {Transmission::kReverse, Transmission::kUnavailable,
                                  Transmission::kNeutral, Transmission::kPark}) {
    for (const bool tells_body : {false, true}) {
      for (const double parked_s : {0.0, 3.0}) {  // Heard while it stands, or backing at once.
        BsmIntake intake{IntakeConfig{}};
        TalkingCar car;
        int wrong = 0;
        int findings = 0;
        for (int i = 0; i < 120; ++i) {
          const double t = 0.1 * i - parked_s;
          car.speed_mps = t < 0.0 ? 0.0 : parked_s > 0.0 ? std::max(-3.0, -1.5 * t) : -3.0;
          car.Drive(0.1);
          Bsm bsm = car.Say();
          bsm.transmission = t < 0.0 && gear == Transmission::kReverse ? Transmission::kPark : gear;
          bsm.course_rad = tells_body || t < 0.0 ? 0.0 : kPi;
          const auto claim = intake.Accept(bsm, EgoAtCrossroads());
          ASSERT_EQ(WhyNot(claim), kTaken);
          if (claim->finding) ++findings;
          const Eigen::Vector3d velocity = claim->speed_mps * claim->course_E;
          if (t > 2.0) wrong += (velocity - car.speed_mps * east).norm() > 0.1;
        }
        EXPECT_EQ(wrong, 0) << static_cast<int>(gear) << tells_body << parked_s;
        EXPECT_EQ(findings, 0) << static_cast<int>(gear) << tells_body << parked_s;
      }
    }
  }
}

TEST_F(IntakeFindings, AForwardGearIsHeldToAndSoIsAFastCar) {
  for (const double speed : {3.0, 12.0}) {
    for (const Transmission gear : {Transmission::kForward, Transmission::kUnavailable}) {
      if (speed < 6.0 && gear == Transmission::kUnavailable) continue;  // It backs, perhaps.
      BsmIntake intake{IntakeConfig{}};
      TalkingCar car;
      car.speed_mps = speed;
      int findings = 0;
      for (int i = 0; i < 150; ++i) {
        car.Drive(0.1);
        Bsm bsm = car.Say();
        bsm.transmission = gear;
        bsm.course_rad = kPi;  // Goes east.
        const auto claim = intake.Accept(bsm, EgoAtCrossroads());
        ASSERT_EQ(WhyNot(claim), kTaken);
        findings += claim->finding && claim->finding->check == Check::kCourseAgainstPath;
      }
      EXPECT_GT(findings, 50) << speed;
    }
  }
}

TEST_F(IntakeFindings, TheGravestIsTold) {
  HearFor(1.0);
  std::vector<Finding> findings;
  for (int i = 0; i < 4; ++i) {
    car_.Drive(0.1);
    Bsm bsm = car_.Say();
    bsm.length_m = 4.6 + (i % 2 == 0 ? 1.0 : 0.0);           // Withdraws with every message.
    *bsm.latitude_rad += 20.0 * (i + 1) * (i + 1) / 6.37e6;  // Accuses from the third on.
    const auto claim = Hear(bsm);
    ASSERT_EQ(WhyNot(claim), kTaken);
    ASSERT_TRUE(claim->finding);
    findings.push_back(*claim->finding);
  }
  EXPECT_EQ(findings[0].check, Check::kPositionJump);
  EXPECT_EQ(findings[0].severity, Verdict::kWithdraw);
  EXPECT_EQ(findings[3].check, Check::kPositionJump);
  EXPECT_EQ(findings[3].severity, Verdict::kAccuse);
}

TEST_F(IntakeFindings, AForgottenSenderStartsWithACleanSlate) {
  HearFor(1.0);
  car_.east_m += 30.0;
  car_.Drive(0.1);
  ASSERT_TRUE(Hear(car_.Say())->finding);
  car_.Drive(6.0);
  intake_.Expire(car_.Say().stamp);
  ASSERT_TRUE(intake_.senders().empty());
  HearFor(1.0);
}

// Where senders come and go, each keeps its own record.
TEST_F(IntakeFindings, RecordsStayWithTheirSenders) {
  IntakeConfig config;
  config.max_senders = 16;
  BsmIntake intake{config};
  std::vector<TalkingCar> cars(40);
  for (std::size_t i = 0; i < cars.size(); ++i) {
    cars[i].id = static_cast<SenderId>(1000 - 7 * i);
    cars[i].north_m = 20.0 + 8.0 * static_cast<double>(i);
  }
  for (int round = 0; round < 300; ++round) {
    const double now_s = 0.1 * round;
    for (std::size_t i = 0; i < cars.size(); ++i) {
      TalkingCar& car = cars[i];
      car.Drive(0.1);
      // Eight speak at a time; every fifth lies about its speed.
      if (static_cast<std::size_t>(round / 60) != i / 8) continue;
      Bsm bsm = car.Say();
      if (i % 5 == 0) bsm.speed_mps = 30.0;
      intake.Expire(bsm.stamp);
      const auto claim = intake.Accept(bsm, EgoAtCrossroads());
      ASSERT_EQ(WhyNot(claim), kTaken) << i << " at " << now_s;
      EXPECT_EQ(claim->finding.has_value(), i % 5 == 0 && round % 60 >= 10) << i << " at " << now_s;
    }
  }
}

}  // namespace
}  // namespace v2vouch
