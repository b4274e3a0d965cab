// SPDX-License-Identifier: Apache-2.0
#include "sim/metrics/extended_filter.h"

#include <gtest/gtest.h>

#include <cmath>

namespace v2vouch::evaluation {
namespace {

constexpr double kStep_s = 0.05;

SensorSpec Radar() {
  SensorSpec radar;
  radar.range_sigma_m = 0.1;
  radar.azimuth_sigma_rad = 0.005;
  return radar;
}

/// Sigma of the centre after `seconds` of a standing vehicle 20 m ahead that is turned by
/// `yaw_rad`.
double Sigma(const SensorSpec& sensor, double yaw_rad, double seconds,
             const SizePrior& prior = {}) {
  ExtendedFilter filter({0.5, 0.3, 1.5}, prior);
  const PlanarMotion ego;
  const PlanarMotion target{20.0, 0.0, yaw_rad, 0.0, 0.0, 0.0};
  for (double t = 0.0; t < seconds; t += kStep_s) {
    filter.Predict(kStep_s, yaw_rad);
    filter.AddSensor(sensor, ego, target, 4.5, 1.8, 0.95);
    filter.Apply();
  }
  return std::sqrt(filter.position_variance_m2());
}

TEST(ExtendedFilter, SeenFromBehindTheUnknownLengthIsTheLimit) {
  const double sigma = Sigma(Radar(), 0.0, 20.0);
  EXPECT_GT(sigma, 0.5 * 0.45);  // Half of the length's spread; no time helps.
  EXPECT_LT(sigma, 0.5);
  EXPECT_NEAR(Sigma(Radar(), 0.0, 60.0), sigma, 0.03);
}

TEST(ExtendedFilter, AKnownLengthLeavesTheLastingErrors) {
  const double sigma = Sigma(Radar(), 0.0, 20.0, {0.001, 0.001});
  EXPECT_GT(sigma, 0.1);
  EXPECT_LT(sigma, 0.45);
}

TEST(ExtendedFilter, ALorrysLengthCostsMoreThanACars) {
  EXPECT_GT(Sigma(Radar(), 0.0, 20.0, SizePriorOf(3)), 1.0);
  EXPECT_GT(Sigma(Radar(), 0.0, 20.0, SizePriorOf(3)),
            1.3 * Sigma(Radar(), 0.7, 20.0, SizePriorOf(3)));  // Its side shows the length.
}

TEST(ExtendedFilter, ACameraBuysTheErrorAcross) {
  SensorSpec camera;
  camera.kind = SensorKind::kCamera;
  camera.z_m = 1.4;
  camera.azimuth_sigma_rad = 0.0015;
  ExtendedFilter radar_only({0.5, 0.3, 1.5}, {0.001, 0.001}), both({0.5, 0.3, 1.5}, {0.001, 0.001});
  const PlanarMotion ego, target{20.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  for (int k = 0; k < 100; ++k) {
    for (ExtendedFilter* filter : {&radar_only, &both}) {
      filter->Predict(kStep_s, 0.0);
      filter->AddSensor(Radar(), ego, target, 4.5, 1.8, 0.95);
      if (filter == &both) filter->AddSensor(camera, ego, target, 4.5, 1.8, 0.9);
      filter->Apply();
    }
  }
  EXPECT_LT(both.position_variance_m2(), 0.7 * radar_only.position_variance_m2());
}

}  // namespace
}  // namespace v2vouch::evaluation
