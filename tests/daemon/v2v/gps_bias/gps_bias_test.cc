// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/gps_bias/gps_bias.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "daemon/common/base/random.h"

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

// By the newest solve.
std::optional<BiasEstimate> EstimateOf(const GpsBias& bias, SenderId sender) {
  return bias.Estimate(sender, kStart + FromSeconds(1000.0));
}

BiasVerdict VerdictOf(const GpsBias& bias, SenderId sender) {
  for (const GpsBias::Sender& one : bias.report().senders) {
    if (one.sender == sender) return one.verdict;
  }
  ADD_FAILURE() << "no sender " << sender;
  return BiasVerdict::kTooFew;
}

TEST(GpsBias, ConstantBiasesAreFoundOnceThereAreTenResiduals) {
  GpsBias bias{GpsBiasConfig{}};
  Feed(bias, {Constant(1.5, -0.5)}, 0.9);
  EXPECT_FALSE(EstimateOf(bias, 1));
  Feed(bias, {Constant(1.5, -0.5)}, 30.0);
  const auto estimate = EstimateOf(bias, 1);
  ASSERT_TRUE(estimate);
  EXPECT_LT((estimate->mean_en - Eigen::Vector2d(1.5, -0.5)).norm(), 0.3);
  EXPECT_LT(std::sqrt(estimate->covariance(0, 0)), 0.35);
  EXPECT_FALSE(bias.report().common);  // One sender says nothing of the others ...
  EXPECT_FALSE(EstimateOf(bias, 99));  // ... and nothing of strangers.
}

TEST(GpsBias, WhatAllAreOffByIsTheStrangersPrior) {
  GpsBias bias{GpsBiasConfig{}};
  Feed(bias, {Constant(2.4, 1.0), Constant(1.6, 1.2), Constant(2.1, 0.7), Constant(1.9, 1.1)},
       40.0);
  ASSERT_TRUE(bias.report().common);
  EXPECT_LT((bias.report().common->mean_en - Eigen::Vector2d(2.0, 1.0)).norm(), 0.6);
  const auto stranger = EstimateOf(bias, 99);
  ASSERT_TRUE(stranger);
  EXPECT_GT(std::sqrt(stranger->covariance(0, 0)), 1.5);
}

TEST(GpsBias, HowOftenItIsAskedChangesNothing) {
  const std::vector<Bias> senders = {Constant(1.0, 0.3), Constant(0.4, -0.8)};
  GpsBias often{GpsBiasConfig{}};
  GpsBias seldom{GpsBiasConfig{}};
  Feed(often, senders, 40.0);
  Feed(seldom, senders, 40.0, 1, {17.3, 40.0});
  ASSERT_TRUE(EstimateOf(often, 1));
  ASSERT_TRUE(EstimateOf(seldom, 1));
  EXPECT_EQ(EstimateOf(often, 1)->mean_en, EstimateOf(seldom, 1)->mean_en);
  EXPECT_EQ(EstimateOf(often, 2)->covariance, EstimateOf(seldom, 2)->covariance);
}

TEST(GpsBias, WhatIsNoReceiversBiasIsPutInQuarantineAndTheRestStays) {
  GpsBias bias{GpsBiasConfig{}};
  const Bias large = Constant(7.0, 0.0);
  const Bias ramp = [](double t) { return Eigen::Vector2d(0.0, 0.06 * t); };
  Feed(bias, {Constant(0.5, 0.2), large, Constant(0.1, -0.4), ramp, Constant(0.3, 0.1)}, 60.0);
  EXPECT_EQ(VerdictOf(bias, 2), BiasVerdict::kTooLarge);
  EXPECT_EQ(VerdictOf(bias, 4), BiasVerdict::kChanges);
  EXPECT_FALSE(EstimateOf(bias, 2));
  EXPECT_FALSE(EstimateOf(bias, 4));
  for (const SenderId honest : {1u, 3u, 5u}) {
    EXPECT_EQ(VerdictOf(bias, honest), BiasVerdict::kUsed) << honest;
  }
  ASSERT_TRUE(bias.report().common);
  EXPECT_LT(bias.report().common->mean_en.norm(), 0.8);
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
    for (const GpsBias::Sender& one : bias.report().senders) {
      quarantined += one.verdict == BiasVerdict::kUsed ? 0 : 1;
    }
  }
  EXPECT_EQ(quarantined, 0);
}

// A message must find the same estimate whether it comes early or late, that is, however much newer
// data has been settled meanwhile.
TEST(GpsBias, AMessageOfAnInstantFindsTheSameEstimateForSeconds) {
  GpsBias bias{GpsBiasConfig{}};
  Feed(bias, {Constant(1.0, -1.0), Constant(0.2, 0.4)}, 30.0);
  const Timestamp at = kStart + FromSeconds(31.7);
  const auto early = bias.Estimate(1, at);
  ASSERT_TRUE(early);
  for (int second = 31; second <= 34; ++second) {
    for (int i = 0; i < 10; ++i) {
      bias.Observe({1,
                    kStart + FromSeconds(second - 1 + 0.1 * i),
                    {1.4, -0.6},
                    0.25 * Eigen::Matrix2d::Identity()});
    }
    bias.AdvanceTo(kStart + FromSeconds(second));
    ASSERT_EQ(bias.Estimate(1, at)->mean_en, early->mean_en);
    ASSERT_EQ(bias.Estimate(1, at)->covariance, early->covariance);
  }
  const auto later = bias.Estimate(1, at + FromSeconds(3.0));
  ASSERT_TRUE(later);
  EXPECT_NE(later->mean_en, early->mean_en);
}

TEST(GpsBias, ManyLiarsCostABoundedNumberOfSolvesAndAllAreFound) {
  GpsBiasConfig config;
  config.max_senders = 64;
  GpsBias bias{config};
  std::vector<Bias> senders;
  for (int j = 0; j < 30; ++j) senders.push_back(Constant(0.2 * (j % 3), -0.3));
  for (int j = 0; j < 20; ++j) senders.push_back(Constant(9.0, 9.0 + j));
  Feed(bias, senders, 20.0, 1, {20.0});
  int used = 0;
  for (SenderId sender = 1; sender <= 50; ++sender) {
    const bool is_liar = sender > 30;
    const bool is_used = VerdictOf(bias, sender) == BiasVerdict::kUsed;
    EXPECT_FALSE(is_liar && is_used) << sender;
    used += is_used ? 1 : 0;
  }
  EXPECT_GE(used, 28);  // A crowd that leads the common part astray may take one or two along.
}

TEST(GpsBias, MessageTimeThatStartsAgainFindsNothing) {
  GpsBias bias{GpsBiasConfig{}};
  Feed(bias, {Constant(1.0, 1.0)}, 20.0);
  bias.Restart();
  EXPECT_FALSE(EstimateOf(bias, 1));
  EXPECT_FALSE(bias.report().solved_at);
  Feed(bias, {Constant(-1.0, 1.0)}, 10.0);
  ASSERT_TRUE(EstimateOf(bias, 1));
  EXPECT_NEAR(EstimateOf(bias, 1)->mean_en.x(), -1.0, 0.5);
}

TEST(GpsBias, WhoFallsSilentIsForgottenWithTheWindow) {
  GpsBias bias{GpsBiasConfig{}};
  Feed(bias, {Constant(1.0, 1.0)}, 20.0);
  ASSERT_TRUE(EstimateOf(bias, 1));
  bias.AdvanceTo(kStart + FromSeconds(100.0));
  EXPECT_FALSE(EstimateOf(bias, 1));
}

}  // namespace
}  // namespace v2vouch
