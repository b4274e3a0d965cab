// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/gps_bias/bias_problem.h"

#include <gmock/gmock.h>

#include <Eigen/LU>
#include <cmath>
#include <cstring>

#include "daemon/common/base/random.h"

namespace v2vouch {
namespace {

constexpr Timestamp kStart = FromMicros(1'700'000'000'000'000);
const Timestamp kEnd = kStart + FromSeconds(60.0);

// Senders drawn from the very model that is solved.
struct Truth {
  std::vector<SenderBlocks> senders;
  Eigen::Vector2d common;
  std::vector<Eigen::Vector2d> bias;  // Total, at kEnd.
};

Truth Draw(std::uint64_t seed, int count, const GpsBiasConfig& config) {
  Random random(seed);
  const auto draw = [&](double sigma) {
    return Eigen::Vector2d(random.Normal(0.0, sigma), random.Normal(0.0, sigma));
  };
  Truth truth;
  truth.common = draw(config.common_sigma_m);
  const double keep = std::exp(-config.knot_s / config.wander_decay_s);
  const double step = config.wander_sigma_m * std::sqrt(1.0 - keep * keep);
  for (int j = 0; j < count; ++j) {
    const Eigen::Vector2d constant = draw(config.sender_sigma_m);
    std::vector<Eigen::Vector2d> knots = {draw(config.wander_sigma_m)};
    for (int k = 1; k <= 6; ++k) knots.push_back(keep * knots.back() + draw(step));
    SenderBlocks one;
    one.sender = static_cast<SenderId>(j + 1);
    for (int second = 0; second < 60; ++second) {
      const double t_s = second + 0.5;
      const auto k = static_cast<std::size_t>(t_s / 10.0);
      const double u = t_s / 10.0 - static_cast<double>(k);
      const Eigen::Vector2d clean =
          truth.common + constant + (1.0 - u) * knots[k] + u * knots[k + 1];
      one.blocks.push_back({.stamp = kStart + FromSeconds(t_s),
                            .mean_en = clean + draw(0.4),
                            .covariance = 0.16 * Eigen::Matrix2d::Identity(),
                            .residuals = 10});
      one.residuals += 10;
    }
    truth.bias.push_back(truth.common + constant + knots.back());
    truth.senders.push_back(std::move(one));
  }
  return truth;
}

double Nees(const BiasEstimate& estimate, const Eigen::Vector2d& truth) {
  const Eigen::Vector2d error = estimate.mean_en - truth;
  return error.dot(estimate.covariance.inverse() * error);
}

// Covariances mean what they say, of every sender and of the common part; 95 % of a chi-square of
// 2 x 5 x 60 degrees of freedom lies within 0.89..1.12 per degree.
TEST(SolveBias, ErrorsAreAsLargeAsTheCovariancesSay) {
  GpsBiasConfig config;
  config.huber = 100.0;
  double sum = 0.0;
  double common = 0.0;
  double leave = 0.0;
  constexpr int kRuns = 60;
  for (int run = 0; run < kRuns; ++run) {
    const Truth truth = Draw(static_cast<std::uint64_t>(run + 1), 5, config);
    const BiasSolution solution = SolveBias(truth.senders, kEnd, config);
    ASSERT_TRUE(solution.is_usable);
    for (std::size_t j = 0; j < 5; ++j) {
      sum += Nees(solution.senders[j].bias, truth.bias[j]);
      leave += solution.senders[j].leave_one_out;
    }
    common += Nees(solution.common, truth.common);
  }
  EXPECT_NEAR(sum / (2.0 * 5 * kRuns), 1.0, 0.12);
  EXPECT_NEAR(common / (2.0 * kRuns), 1.0, 0.3);
  EXPECT_NEAR(leave / (2.0 * 5 * kRuns), 1.0, 0.3);
}

TEST(SolveBias, TheSplitOfCommonAndOwnStaysUncertainHoweverLongOneLooks) {
  const GpsBiasConfig config;
  const Truth truth = Draw(3, 8, config);
  const BiasSolution solution = SolveBias(truth.senders, kEnd, config);
  // The common part is known no better than sigma_e^2 sigma_g^2 / (sigma_g^2 + M sigma_e^2): only
  // the difference of ego and senders is observed. The wandering part comes on top.
  const double least = 1.5 * 1.5 / 9.0;
  EXPECT_GT(solution.common.covariance(0, 0), least);
  EXPECT_LT(solution.common.covariance(0, 0), 1.3 * least);
  for (const SenderSolution& one : solution.senders) {
    EXPECT_LT(one.bias.covariance(0, 0), 0.3 * 0.3);
  }
}

TEST(SolveBias, OutliersPullWithLimitedForce) {
  GpsBiasConfig config;
  Truth truth = Draw(4, 1, config);
  const BiasSolution clean = SolveBias(truth.senders, kEnd, config);
  for (std::size_t i = 0; i < 60; i += 10) truth.senders[0].blocks[i].mean_en.x() += 30.0;
  const BiasSolution robust = SolveBias(truth.senders, kEnd, config);
  config.huber = 100.0;
  const BiasSolution plain = SolveBias(truth.senders, kEnd, config);
  const auto moved = [&](const BiasSolution& solution) {
    return (solution.senders[0].bias.mean_en - clean.senders[0].bias.mean_en).norm();
  };
  EXPECT_LT(moved(robust), 0.3);
  EXPECT_GT(moved(plain), 5.0 * moved(robust));
}

TEST(SolveBias, TheSameBlocksGiveTheSameBits) {
  const GpsBiasConfig config;
  const Truth truth = Draw(5, 6, config);
  const BiasSolution a = SolveBias(truth.senders, kEnd, config);
  const BiasSolution b = SolveBias(truth.senders, kEnd, config);
  for (std::size_t j = 0; j < 6; ++j) {
    EXPECT_EQ(std::memcmp(a.senders[j].bias.mean_en.data(), b.senders[j].bias.mean_en.data(), 16),
              0);
    EXPECT_EQ(
        std::memcmp(a.senders[j].bias.covariance.data(), b.senders[j].bias.covariance.data(), 32),
        0);
  }
}

TEST(SolveBias, NobodyIsNotUsable) { EXPECT_FALSE(SolveBias({}, kEnd, {}).is_usable); }

}  // namespace
}  // namespace v2vouch
