// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/gps_bias/residual_window.h"

#include <gmock/gmock.h>

#include <limits>

namespace v2vouch {
namespace {

constexpr Timestamp kStart = FromMicros(1'700'000'000'000'000);

BiasResidual At(double t_s, SenderId sender = 1, double east_m = 1.0) {
  return {sender, kStart + FromSeconds(t_s), {east_m, -0.5}, 0.25 * Eigen::Matrix2d::Identity()};
}

TEST(ResidualWindow, ASecondIsOneBlockWhoseMeanIsNoBetterThanItsIndependentResiduals) {
  GpsBiasConfig config;
  config.white_hz = 2.0;
  ResidualWindow window(config);
  for (int i = 1; i <= 20; ++i) window.Add(At(0.1 * i, 1, i <= 10 ? 1.0 : 2.0));
  const auto senders = window.At(kStart + FromSeconds(2.0));
  ASSERT_EQ(senders.size(), 1u);
  ASSERT_EQ(senders[0].blocks.size(), 2u);
  EXPECT_EQ(senders[0].residuals, 20);
  EXPECT_NEAR(senders[0].blocks[0].mean_en.x(), 1.0, 1e-12);
  EXPECT_NEAR(senders[0].blocks[1].mean_en.x(), 2.0, 1e-12);
  EXPECT_NEAR(senders[0].blocks[0].covariance(0, 0), 0.125, 1e-12);
  EXPECT_NEAR(ToSeconds(senders[0].blocks[0].stamp - kStart), 0.55, 1e-5);
}

TEST(ResidualWindow, WhatLiesAheadOfTheSecondOrBeforeTheWindowIsNotInIt) {
  GpsBiasConfig config;
  config.window_s = 5.0;
  ResidualWindow window(config);
  for (int i = 1; i <= 100; ++i) window.Add(At(0.1 * i));
  const auto now = kStart + FromSeconds(8.0);
  const auto before = window.At(now);
  ASSERT_EQ(before.size(), 1u);
  EXPECT_EQ(before[0].residuals, 50);
  window.Forget(now);
  EXPECT_EQ(window.At(now)[0].residuals, 50);
  window.Forget(now + FromSeconds(60.0));
  EXPECT_TRUE(window.At(now).empty());
}

TEST(ResidualWindow, NonsenseIsNobodysAndTheTableIsBounded) {
  GpsBiasConfig config;
  config.max_senders = 3;
  ResidualWindow window(config);
  BiasResidual bad = At(0.1);
  bad.claimed_minus_sensed_en.x() = std::numeric_limits<double>::quiet_NaN();
  window.Add(bad);
  bad = At(0.1);
  bad.covariance.setZero();
  window.Add(bad);
  EXPECT_TRUE(window.At(kStart + FromSeconds(1.0)).empty());
  for (SenderId sender = 1; sender <= 5; ++sender) {
    window.Add(At(0.1 * static_cast<double>(sender), sender));
  }
  const auto senders = window.At(kStart + FromSeconds(1.0));
  ASSERT_EQ(senders.size(), 3u);
  EXPECT_EQ(senders[0].sender, 3u);  // Whoever was silent longest made room.
}

}  // namespace
}  // namespace v2vouch
