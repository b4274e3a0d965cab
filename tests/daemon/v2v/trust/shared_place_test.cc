// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/trust/shared_place.h"

#include <gmock/gmock.h>

namespace v2vouch {
namespace {

constexpr Timestamp kStart = FromMicros(1'700'000'000'000'000);

Timestamp At(double t_s) { return kStart + FromSeconds(t_s); }

TEST(SharedPlace, WithdrawsOnceItHasLastedAndNeverAccuses) {
  const SharedPlaceConfig config;
  SharedPlace place;
  double found_s = -1.0;
  for (double t = 0.0; t < 4.0 && found_s < 0.0; t += 0.05) {
    place.OnLook(At(t), true);
    if (const auto finding = place.Judge(config)) {
      EXPECT_EQ(finding->severity, Verdict::kWithdraw);
      EXPECT_EQ(finding->check, Check::kSharedPlace);
      EXPECT_GE(finding->value, config.withdraw_s);
      found_s = t;
    }
  }
  EXPECT_NEAR(found_s, config.withdraw_s, 0.1);
}

TEST(SharedPlace, NoiseThatPartsThemNowAndThenDoesNotSaveThemAndPassingCarsAreLeftAlone) {
  SharedPlace noisy, passing;
  for (int k = 0; k <= 80; ++k) {
    noisy.OnLook(At(0.05 * k), k % 5 != 0);
    passing.OnLook(At(0.05 * k), k % 40 < 15);  // 0.75 s together, 1.25 s apart.
    EXPECT_FALSE(passing.Judge({}));
  }
  EXPECT_TRUE(noisy.Judge({}));
}

TEST(SharedPlace, APauseOfTheLooksCountsLittle) {
  SharedPlace place;
  place.OnLook(At(0.0), true);
  place.OnLook(At(30.0), true);
  EXPECT_FALSE(place.Judge({}));
}

}  // namespace
}  // namespace v2vouch
