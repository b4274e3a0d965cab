// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/models/radar_outline.h"

#include <gtest/gtest.h>

#include <cmath>

#include "daemon/common/base/angle.h"

namespace v2vouch {
namespace {

constexpr double kDepth_m = 0.1;  // Mean depth of strong returns behind the outline.

RadarMeasurement Cluster(std::initializer_list<OutlineReturn> returns, double middle_rad) {
  RadarMeasurement z;
  for (const OutlineReturn& r : returns) z.outline[z.outline_count++] = r;
  z.returns = static_cast<int>(z.outline_count);
  z.range_m = returns.begin()->range_m;
  z.azimuth_rad = returns.begin()->azimuth_rad;
  z.middle_azimuth_rad = middle_rad;
  z.covariance = Eigen::Vector3d(0.01, 1e-5, 0.01).asDiagonal();
  return z;
}

RadarConfig RadarAtTheAxle() {
  RadarConfig radar;
  radar.x_m = radar.y_m = radar.yaw_rad = 0.0;
  return radar;
}

const Extent kCar{4.5, 1.8, 0.0, 0.0};

TEST(LinearizeOutline, ACarAheadIsMeasuredAtItsRearByWhateverReturnAnswers) {
  StateVector x = StateVector::Zero();
  x[kX] = 30.0;
  const double rear_m = 30.0 - 2.25;
  for (const double azimuth : {0.0, 0.02, -0.03}) {
    const auto z = Cluster({{rear_m / std::cos(azimuth) + kDepth_m, azimuth, 0.0}}, 0.0);
    const auto out = LinearizeOutline(x, kCar, EgoState{}, RadarAtTheAxle(), z);
    ASSERT_TRUE(out);
    EXPECT_NEAR(out->y[0], 0.0, 1e-9) << azimuth;
    EXPECT_NEAR(out->y[1], 0.0, 1e-9);
    // A longer car is nearer by half of it; farther away it is farther.
    EXPECT_NEAR(out->E(0, 0), -0.5 / std::cos(azimuth), 1e-6);
    EXPECT_NEAR(out->H(0, kX), 1.0 / std::cos(azimuth), 1e-6);
    EXPECT_DOUBLE_EQ(out->O(0, 0), 1.0);
    EXPECT_GT(out->O(1, 1), 0.0);
  }
}

TEST(LinearizeOutline, OneDeepReturnAmongThreeCountsLess) {
  StateVector x = StateVector::Zero();
  x[kX] = 30.0;
  const double rear_m = 27.75 + kDepth_m;
  const auto z =
      Cluster({{rear_m, 0.0, 0.0}, {rear_m, 0.01, 0.0}, {rear_m + 2.0, -0.02, 0.0}}, 0.0);
  const auto out = LinearizeOutline(x, kCar, EgoState{}, RadarAtTheAxle(), z);
  ASSERT_TRUE(out);
  EXPECT_GT(out->y[0], 0.1);
  EXPECT_LT(out->y[0], 0.3);  // The mean of all three lies 0.67 m deep.
}

TEST(LinearizeOutline, ARayBesideTheCarMeasuresTheNearFaceNotTheFarEnd) {
  StateVector x = StateVector::Zero();
  x[kX] = 58.0;
  x[kY] = 0.8;
  x[kYaw] = 0.05;
  RadarConfig radar = RadarAtTheAxle();
  radar.azimuth_sigma_rad = FromDegrees(0.7);
  // Noise has put the return half a metre beside the silhouette.
  const auto z = Cluster({{55.8, std::atan2(-0.7, 55.8), 0.0}}, 0.0);
  const auto out = LinearizeOutline(x, kCar, EgoState{}, radar, z);
  ASSERT_TRUE(out);
  EXPECT_LT(std::abs(out->y[0]), 0.3);
}

TEST(LinearizeOutline, JacobianMatchesCentralDifferencesOnAFace) {
  RadarConfig radar = RadarAtTheAxle();
  radar.yaw_rad = 0.3;
  const auto z = Cluster({{24.0, -0.05, 0.0}}, -0.06);
  EgoState ego;
  ego.speed_mps = 12.0;
  ego.yaw_rate_radps = 0.1;
  StateVector x;
  x << 25.0, 6.0, 0.9, 7.0, 0.2, 0.5;
  const auto at = LinearizeOutline(x, kCar, ego, radar, z);
  ASSERT_TRUE(at);
  for (int i = 0; i < kStateSize + 2; ++i) {
    const double h = 1e-5;
    const auto moved = [&](double by) {
      StateVector s = x;
      Extent e = kCar;
      if (i < kStateSize) s[i] += by;
      if (i == kStateSize) e.length_m += by;
      if (i == kStateSize + 1) e.width_m += by;
      return LinearizeOutline(s, e, ego, radar, z);
    };
    const Eigen::VectorXd numeric = (moved(-h)->y - moved(h)->y) / (2.0 * h);
    const Eigen::VectorXd exact =
        i < kStateSize ? Eigen::VectorXd(at->H.col(i)) : Eigen::VectorXd(at->E.col(i - kStateSize));
    EXPECT_LT((numeric - exact).cwiseAbs().maxCoeff(), 1e-4) << "column " << i;
  }
}

TEST(LinearizeOutline, TheAntennaInsideOfTheBoxIsRefused) {
  const auto z = Cluster({{1.0, 0.0, 0.0}}, 0.0);
  EXPECT_FALSE(LinearizeOutline(StateVector::Zero(), kCar, EgoState{}, RadarAtTheAxle(), z));
}

TEST(LinearizeEdges, OnlyAReturnBesideTheSilhouettePullsToItsSide) {
  StateVector x = StateVector::Zero();
  x[kX] = 30.0;
  RadarConfig radar = RadarAtTheAxle();
  radar.azimuth_sigma_rad = 0.002;
  const double half_rad = std::atan2(0.9, 27.75);
  const auto at = [&](double left_rad, double right_rad) {
    const auto z = Cluster({{27.8, left_rad, 0.0}, {27.8, right_rad, 0.0}}, 0.0);
    return LinearizeEdges(x, kCar, EgoState{}, radar, z);
  };
  EXPECT_FALSE(at(0.8 * half_rad, -0.8 * half_rad));
  const auto left = at(2.0 * half_rad, 0.0);
  ASSERT_TRUE(left);
  EXPECT_GT(left->y[0], 0.5 * half_rad);
  const auto right = at(0.0, -2.0 * half_rad);
  ASSERT_TRUE(right);
  EXPECT_LT(right->y[0], -0.5 * half_rad);
  EXPECT_FALSE(at(2.0 * half_rad, -2.0 * half_rad));
}

TEST(TemperDepth, DeepReturnsLoseWeightSoonerThanNearOnes) {
  const auto weighed = [](double sigmas) {
    Linearized outline;
    outline.R = Eigen::MatrixXd::Identity(3, 3);
    TemperDepth(sigmas, outline);
    return outline.R(0, 0);
  };
  EXPECT_DOUBLE_EQ(weighed(1.0), 1.0);
  EXPECT_DOUBLE_EQ(weighed(-2.5), 1.0);
  EXPECT_DOUBLE_EQ(weighed(3.0), 4.0);
  EXPECT_DOUBLE_EQ(weighed(-6.0), 4.0);
}

}  // namespace
}  // namespace v2vouch
