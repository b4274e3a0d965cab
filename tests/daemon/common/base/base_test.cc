// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/random.h"
#include "daemon/common/base/reason.h"
#include "daemon/common/base/time.h"

namespace v2vouch {
namespace {

TEST(WrapAngle, StaysInTheHalfOpenCircle) {
  EXPECT_DOUBLE_EQ(WrapAngle(kPi), kPi);
  EXPECT_DOUBLE_EQ(WrapAngle(-kPi), kPi);
  EXPECT_NEAR(WrapAngle(3.0 * kPi + 0.1), -kPi + 0.1, 1e-12);
  EXPECT_NEAR(AngleDifference(-kPi + 0.01, kPi - 0.01), 0.02, 1e-12);
}

// Angles that are wrapped already take a short way.
TEST(WrapAngle, GivesWhatTheRemainderGivesBitForBit) {
  Random random(7);
  for (int i = 0; i < 20'000; ++i) {
    const double angle = i < 10'000 ? random.Uniform(-kPi, kPi) : random.Uniform(-40.0, 40.0);
    EXPECT_EQ(WrapAngle(angle), std::remainder(angle, 2.0 * kPi)) << angle;
  }
  EXPECT_TRUE(std::signbit(WrapAngle(-0.0)));
  EXPECT_TRUE(std::isnan(WrapAngle(std::nan(""))));
}

TEST(FromSeconds, RoundsToTheNearestMicrosecond) {
  EXPECT_EQ(FromSeconds(0.1).count(), 100000);
  EXPECT_EQ(FromSeconds(-1.4e-6).count(), -1);
}

TEST(ReasonName, EveryReasonHasANameOfItsOwn) {
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < kReasonCount; ++i) {
    const auto name = ReasonName(static_cast<Reason>(i));
    EXPECT_FALSE(name.empty());
    EXPECT_TRUE(names.insert(name).second) << name;
  }
}

TEST(RandomProperty, NormalHasItsMomentsAndIsRepeatable) {
  Random a(7);
  Random b(7);
  double sum = 0.0;
  double squares = 0.0;
  constexpr int kDraws = 200000;
  for (int i = 0; i < kDraws; ++i) {
    const double x = a.Normal();
    ASSERT_EQ(x, b.Normal());
    sum += x;
    squares += x * x;
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 0.01);       // 4.5 sigma of the mean.
  EXPECT_NEAR(squares / kDraws, 1.0, 0.015);  // 4.7 sigma of the variance.
}

TEST(RandomProperty, PoissonHasItsMean) {
  Random random(11);
  double sum = 0.0;
  for (int i = 0; i < 100000; ++i) sum += random.Poisson(2.5);
  EXPECT_NEAR(sum / 100000, 2.5, 0.025);  // 5 sigma.
}

TEST(Random, SubjectsAreIndependentOfEachOther) {
  Random a = Random::ForSubject(1, 1);
  Random b = Random::ForSubject(1, 2);
  Random a_again = Random::ForSubject(1, 1);
  EXPECT_NE(a.Bits(), b.Bits());
  Random first = Random::ForSubject(1, 1);
  EXPECT_EQ(first.Bits(), a_again.Bits());
}

}  // namespace
}  // namespace v2vouch
