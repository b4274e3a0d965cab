// SPDX-License-Identifier: Apache-2.0
#include "calibration/extrinsics/static_doppler.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "daemon/common/base/random.h"

namespace v2vouch {
namespace {

constexpr double kSpeed_mps = 20.0;

DopplerResidual Look(double azimuth, double rate, double azimuth_sigma) {
  return {.azimuth_rad = azimuth,
          .range_rate_mps = rate,
          .dt_s = 0.0,
          .accel_mps2 = 0.0,
          .yaw_accel_radps2 = 0.0,
          .range_rate_sigma_mps = 0.1,
          .azimuth_sigma_rad = azimuth_sigma};
}

struct Yaws {
  double errors_in_variables_deg, plain_deg;
};

// Yaw and speed of a corner radar at 45 degrees that sees a standing world over +-60 degrees, from
// both kinds of residual: what is left of each after many looks.
Yaws BiasOf(double azimuth_sigma_rad, int looks, std::uint64_t seed) {
  const double truth = FromDegrees(45.0);
  Random random(seed);
  std::vector<DopplerResidual> all;
  for (int i = 0; i < looks; ++i) {
    const double azimuth = random.Uniform(-FromDegrees(60.0), FromDegrees(60.0));
    all.push_back(Look(azimuth + random.Normal(0.0, azimuth_sigma_rad),
                       -kSpeed_mps * std::cos(truth + azimuth) + random.Normal(0.0, 0.1),
                       azimuth_sigma_rad));
  }
  const auto solve = [&](bool plain) {
    std::array<double, 3> radar = {3.45, 0.75, truth};
    std::array<double, 2> motion = {kSpeed_mps, 0.0};
    for (int iteration = 0; iteration < 8; ++iteration) {
      double h[2][2] = {}, g[2] = {};
      for (const DopplerResidual& one : all) {
        double r = 0.0;
        double d[2];
        if (plain) {
          const double t = radar[2] + one.azimuth_rad;
          r = (one.range_rate_mps + motion[0] * std::cos(t)) / 0.1;
          d[0] = -motion[0] * std::sin(t) / 0.1;
          d[1] = std::cos(t) / 0.1;
        } else {
          double d_radar[3], d_motion[2];
          r = one(radar.data(), motion.data(), 0.0, d_radar, d_motion, nullptr);
          d[0] = d_radar[2];
          d[1] = d_motion[0];
        }
        for (int i = 0; i < 2; ++i) {
          g[i] += d[i] * r;
          for (int k = 0; k < 2; ++k) h[i][k] += d[i] * d[k];
        }
      }
      const double det = h[0][0] * h[1][1] - h[0][1] * h[1][0];
      radar[2] -= (h[1][1] * g[0] - h[0][1] * g[1]) / det;
      motion[0] -= (h[0][0] * g[1] - h[1][0] * g[0]) / det;
    }
    return ToDegrees(radar[2] - truth);
  };
  return {solve(false), solve(true)};
}

TEST(DopplerResidual, ACornerRadarIsNotBiasedByItsAzimuthNoise) {
  // Six repeats: the mean of either has a standard deviation of about 0.0017 degrees.
  Yaws mean{};
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Yaws one = BiasOf(FromDegrees(1.0), 100'000, seed);
    mean.errors_in_variables_deg += one.errors_in_variables_deg / 6.0;
    mean.plain_deg += one.plain_deg / 6.0;
  }
  EXPECT_LT(std::abs(mean.errors_in_variables_deg), 0.005);
  // What it is there for: plain least squares answers with -0.0174 degrees (notes of the field).
  EXPECT_NEAR(mean.plain_deg, -0.0174, 0.006);
}

TEST(DopplerResidual, DerivativesAreThoseOfItsSquare) {
  // The azimuth correction minimises, so half the gradient of r^2 is r times the held derivative.
  const DopplerResidual look = Look(0.4, -17.0, FromDegrees(1.0));
  const std::array<double, 3> radar = {3.4, 0.7, 0.9};
  const std::array<double, 2> motion = {18.0, 0.3};
  const double slip = 4e-4;
  std::array<double, 6> d{};
  const double r = look(radar.data(), motion.data(), slip, d.data(), d.data() + 3, d.data() + 5);
  const auto square = [&](int i, double by) {
    std::array<double, 3> a = radar;
    std::array<double, 2> m = motion;
    double s = slip;
    (i < 3 ? a[static_cast<std::size_t>(i)] : i < 5 ? m[static_cast<std::size_t>(i - 3)] : s) += by;
    const double value = look(a.data(), m.data(), s, nullptr, nullptr, nullptr);
    return value * value;
  };
  for (int i = 0; i < 6; ++i) {
    const double h = i == 5 ? 1e-7 : 1e-5;
    const double numeric = (square(i, h) - square(i, -h)) / (4.0 * h);
    EXPECT_NEAR(r * d[static_cast<std::size_t>(i)] / numeric, 1.0, 2e-2) << "parameter " << i;
  }
}

TEST(DopplerResidual, AStandingReturnFitsWhateverTheCarDoes) {
  const std::array<double, 3> radar = {3.45, -0.75, FromDegrees(-55.0)};
  const std::array<double, 2> motion = {9.0, -0.4};
  for (const double azimuth : {-1.0, -0.3, 0.0, 0.5, 1.1}) {
    const double bearing = radar[2] + azimuth;
    const double rate = -((motion[0] - motion[1] * radar[1]) * std::cos(bearing) +
                          motion[1] * radar[0] * std::sin(bearing));
    EXPECT_NEAR(Look(azimuth, rate, FromDegrees(1.0))(radar.data(), motion.data(), 0.0, nullptr,
                                                      nullptr, nullptr),
                0.0, 1e-9);
  }
}

}  // namespace
}  // namespace v2vouch
