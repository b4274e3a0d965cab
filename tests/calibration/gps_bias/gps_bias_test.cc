// SPDX-License-Identifier: Apache-2.0
#include "calibration/gps_bias/gps_bias.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "daemon/base/random.h"

namespace v2vouch {
namespace {

constexpr Timestamp kStart = FromMicros(1'700'000'000'000'000);

using Bias = std::function<Eigen::Vector2d(double)>;

// Residuals at 10 Hz with white noise, all senders in step.
void Feed(GpsBias& bias, const std::vector<Bias>& senders, double to_s, std::uint64_t seed = 1,
          const std::vector<double>& advance_s = {}) {
  Random random(seed);
  std::size_t next = 0;
  for (int i = 1; i <= std::lround(10.0 * to_s); ++i) {
    const double t = 0.1 * i;
    for (std::size_t j = 0; j < senders.size(); ++j) {
      bias.Observe(
          {static_cast<SenderId>(j + 1), kStart + FromSeconds(t),
           senders[j](t) + Eigen::Vector2d(random.Normal(0.0, 0.5), random.Normal(0.0, 0.5)),
           0.25 * Eigen::Matrix2d::Identity()});
    }
    if (advance_s.empty()) bias.AdvanceTo(kStart + FromSeconds(t));
    while (next < advance_s.size() && t >= advance_s[next]) {
      bias.AdvanceTo(kStart + FromSeconds(advance_s[next++]));
    }
  }
}

Bias Constant(double east_m, double north_m) {
  return [=](double) { return Eigen::Vector2d(east_m, north_m); };
}

BiasVerdict VerdictOf(const GpsBias& bias, SenderId sender) {
  for (const GpsBias::Sender& one : bias.senders()) {
    if (one.sender == sender) return one.verdict;
  }
  ADD_FAILURE() << "no sender " << sender;
  return BiasVerdict::kTooFew;
}

TEST(GpsBias, ConstantBiasesAreFoundOnceThereAreTenResiduals) {
  GpsBias bias{GpsBiasConfig{}};
  Feed(bias, {Constant(1.5, -0.5)}, 0.9);
  EXPECT_FALSE(bias.Estimate(1));
  Feed(bias, {Constant(1.5, -0.5)}, 30.0);
  const auto estimate = bias.Estimate(1);
  ASSERT_TRUE(estimate);
  EXPECT_LT((estimate->mean_en - Eigen::Vector2d(1.5, -0.5)).norm(), 0.3);
  EXPECT_LT(std::sqrt(estimate->covariance(0, 0)), 0.35);
  EXPECT_FALSE(bias.common());      // One sender says nothing of the others ...
  EXPECT_FALSE(bias.Estimate(99));  // ... and nothing of strangers.
}

TEST(GpsBias, WhatAllAreOffByIsTheStrangersPrior) {
  GpsBias bias{GpsBiasConfig{}};
  Feed(bias, {Constant(2.4, 1.0), Constant(1.6, 1.2), Constant(2.1, 0.7), Constant(1.9, 1.1)},
       40.0);
  ASSERT_TRUE(bias.common());
  EXPECT_LT((bias.common()->mean_en - Eigen::Vector2d(2.0, 1.0)).norm(), 0.6);
  const auto stranger = bias.Estimate(99);
  ASSERT_TRUE(stranger);
  EXPECT_GT(std::sqrt(stranger->covariance(0, 0)), 1.5);
}

TEST(GpsBias, HowOftenItIsAskedChangesNothing) {
  const std::vector<Bias> senders = {Constant(1.0, 0.3), Constant(0.4, -0.8)};
  GpsBias often{GpsBiasConfig{}};
  GpsBias seldom{GpsBiasConfig{}};
  Feed(often, senders, 40.0);
  Feed(seldom, senders, 40.0, 1, {17.3, 40.0});
  ASSERT_TRUE(often.Estimate(1));
  ASSERT_TRUE(seldom.Estimate(1));
  EXPECT_EQ(often.Estimate(1)->mean_en, seldom.Estimate(1)->mean_en);
  EXPECT_EQ(often.Estimate(2)->covariance, seldom.Estimate(2)->covariance);
}

TEST(GpsBias, WhatIsNoReceiversBiasIsPutInQuarantineAndTheRestStays) {
  GpsBias bias{GpsBiasConfig{}};
  const Bias large = Constant(7.0, 0.0);
  const Bias ramp = [](double t) { return Eigen::Vector2d(0.0, 0.06 * t); };
  Feed(bias, {Constant(0.5, 0.2), large, Constant(0.1, -0.4), ramp, Constant(0.3, 0.1)}, 60.0);
  EXPECT_EQ(VerdictOf(bias, 2), BiasVerdict::kTooLarge);
  EXPECT_EQ(VerdictOf(bias, 4), BiasVerdict::kChanges);
  EXPECT_FALSE(bias.Estimate(2));
  EXPECT_FALSE(bias.Estimate(4));
  for (const SenderId honest : {1u, 3u, 5u}) {
    EXPECT_EQ(VerdictOf(bias, honest), BiasVerdict::kUsed) << honest;
  }
  ASSERT_TRUE(bias.common());
  EXPECT_LT(bias.common()->mean_en.norm(), 0.8);
}

// Honest receivers wander as the model says: 0.5 m, 45 s.
TEST(GpsBias, NoHonestReceiverIsPutInQuarantineInAHundredRuns) {
  int quarantined = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    Random random(seed);
    std::vector<std::vector<Eigen::Vector2d>> paths(4);
    for (auto& path : paths) {
      const Eigen::Vector2d constant(random.Normal(0.0, 1.0), random.Normal(0.0, 1.0));
      Eigen::Vector2d wander(random.Normal(0.0, 0.5), random.Normal(0.0, 0.5));
      const double keep = std::exp(-0.1 / 45.0);
      for (int i = 0; i <= 600; ++i) {
        path.push_back(constant + wander);
        const double step = 0.5 * std::sqrt(1.0 - keep * keep);
        wander =
            keep * wander + Eigen::Vector2d(random.Normal(0.0, step), random.Normal(0.0, step));
      }
    }
    std::vector<Bias> senders;
    for (const auto& path : paths) {
      senders.emplace_back(
          [&path](double t) { return path[static_cast<std::size_t>(std::lround(10.0 * t))]; });
    }
    GpsBias bias{GpsBiasConfig{}};
    Feed(bias, senders, 60.0, seed + 1000, {60.0});
    for (const GpsBias::Sender& one : bias.senders()) {
      quarantined += one.verdict == BiasVerdict::kUsed ? 0 : 1;
    }
  }
  EXPECT_EQ(quarantined, 0);
}

TEST(GpsBias, WhoFallsSilentIsForgottenWithTheWindow) {
  GpsBias bias{GpsBiasConfig{}};
  Feed(bias, {Constant(1.0, 1.0)}, 20.0);
  ASSERT_TRUE(bias.Estimate(1));
  bias.AdvanceTo(kStart + FromSeconds(100.0));
  EXPECT_FALSE(bias.Estimate(1));
}

}  // namespace
}  // namespace v2vouch
