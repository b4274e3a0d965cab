// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/models/measurement_model.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "daemon/common/models/radar_outline.h"
#include "tests/daemon/common/models/random_scene.h"

namespace v2vouch {
namespace {

RadarConfig TurnedRadar() {
  RadarConfig radar;
  radar.x_m = 3.4;
  radar.y_m = 0.7;
  radar.yaw_rad = FromDegrees(55.0);
  return radar;
}

RadarMeasurement AnyRadarMeasurement() {
  RadarMeasurement z;
  z.returns = 4;
  z.range_m = 30.0;
  z.covariance = Eigen::Vector3d(0.04, 1e-4, 0.01).asDiagonal();
  return z;
}

CameraMeasurement AnyCameraMeasurement() {
  CameraMeasurement z;
  z.azimuth_left_rad = 0.06;
  z.azimuth_right_rad = 0.0;
  z.depression_rad = 0.05;
  z.azimuth_sigma_rad = 0.002;
  z.depression_sigma_rad = 0.004;
  return z;
}

// dh/d(state, extent) is minus the derivative of the innovation.
template <class Model>
void ExpectJacobian(const Model& model, const StateVector& x, const Extent& extent,
                    double tolerance) {
  const auto at = model(x, extent);
  if (!at) return;
  for (int i = 0; i < kStateSize + 2; ++i) {
    const double step = 1e-6;
    StateVector high = x, low = x;
    Extent wide = extent, narrow = extent;
    if (i < kStateSize) {
      high[i] += step;
      low[i] -= step;
    } else {
      (i == kStateSize ? wide.length_m : wide.width_m) += step;
      (i == kStateSize ? narrow.length_m : narrow.width_m) -= step;
    }
    const auto up = model(high, wide);
    const auto down = model(low, narrow);
    ASSERT_TRUE(up && down);
    const Eigen::VectorXd numeric = (down->y - up->y) / (2.0 * step);
    const Eigen::VectorXd exact =
        i < kStateSize ? Eigen::VectorXd(at->H.col(i)) : Eigen::VectorXd(at->E.col(i - kStateSize));
    EXPECT_LT((numeric - exact).cwiseAbs().maxCoeff(), tolerance)
        << "column " << i << ", x = " << x.transpose();
  }
}

TEST(LinearizeRadarProperty, JacobianMatchesCentralDifferences) {
  Random random(21);
  const RadarConfig radar = TurnedRadar();
  const RadarMeasurement z = AnyRadarMeasurement();
  for (int trial = 0; trial < 500; ++trial) {
    const StateVector x = RandomState(random);
    const EgoState ego = RandomEgo(random);
    const Extent extent{random.Uniform(2.0, 12.0), random.Uniform(0.8, 2.5), 0.0, 0.0};
    ExpectJacobian(
        [&](const StateVector& s, const Extent& e) { return LinearizeRadar(s, e, ego, radar, z); },
        x, extent, 2e-5);
  }
}

TEST(LinearizeCameraProperty, JacobianMatchesCentralDifferences) {
  Random random(22);
  const CameraConfig camera;
  const CameraMeasurement z = AnyCameraMeasurement();
  for (int trial = 0; trial < 500; ++trial) {
    const StateVector x = RandomState(random);
    const EgoState ego = RandomEgo(random);
    const Extent extent{random.Uniform(2.0, 12.0), random.Uniform(0.8, 2.5), 0.0, 0.0};
    ExpectJacobian([&](const StateVector& s,
                       const Extent& e) { return LinearizeCamera(s, e, ego, camera, z); },
                   x, extent, 1e-4);
  }
}

TEST(LinearizeRadar, PointTargetIsExact) {
  const RadarConfig radar = TurnedRadar();
  EgoState ego;
  ego.X_OB = {10.0, -4.0, 0.4};
  ego.speed_mps = 12.0;
  ego.yaw_rate_radps = 0.3;
  StateVector x;
  x << 30.0, 15.0, -2.0, 8.0, 0.3, 0.0;
  // By hand: antenna in O and its velocity, then plain geometry.
  const Point<Odometry> antenna = ego.X_OB * Point<Body>{radar.x_m, radar.y_m};
  const Eigen::Vector2d v_antenna =
      ego.X_OB.rotation() * Eigen::Vector2d(12.0 - 0.3 * 0.7, 0.3 * 3.4);
  const Eigen::Vector2d line = x.head<2>() - antenna.vector();
  const Eigen::Vector2d v(8.0 * std::cos(-2.0), 8.0 * std::sin(-2.0));
  RadarMeasurement z = AnyRadarMeasurement();
  z.range_m = line.norm();
  z.azimuth_rad = std::atan2(line.y(), line.x()) - 0.4 - radar.yaw_rad;
  z.range_rate_mps = line.normalized().dot(v - v_antenna);
  ego.speed_sigma_mps = ego.yaw_rate_sigma_radps = 0.0;
  const auto out = LinearizeRadar(x, Extent{0, 0, 0, 0}, ego, radar, z);
  ASSERT_TRUE(out);
  EXPECT_LT(out->y.norm(), 1e-12);
  EXPECT_LT((out->R - z.covariance).norm(), 1e-15);
  EXPECT_EQ(out->E.norm(), 0.0);
}

TEST(LinearizeRadar, LeadCarIsMeasuredAtItsRearBumper) {
  StateVector x;
  x << 42.25, 0.0, 0.0, 20.0, 0.0, 0.0;
  RadarConfig radar;
  RadarMeasurement z = AnyRadarMeasurement();
  z.range_m = 40.0;
  z.range_rate_mps = 20.0;
  const auto out = LinearizeRadar(x, Extent{4.5, 1.8, 0, 0}, EgoState{}, radar, z);
  ASSERT_TRUE(out);
  EXPECT_NEAR(out->y[0], 0.0, 0.06);
  EXPECT_NEAR(out->y[1], 0.0, 1e-9);
  EXPECT_NEAR(out->E(0, 0), -0.5, 0.05);  // A longer car's centre is farther away.
}

TEST(LinearizeRadar, AnObjectsPlaceMayBeAnyPointOfTheVehicle) {
  // From a bumper over the centre to the far corner: within what lasting offset and noise explain.
  StateVector x;
  x << 42.25, 0.0, 0.0, 20.0, 0.0, 0.0;
  const Extent extent{4.5, 1.8, 0, 0};
  RadarMeasurement z = AnyRadarMeasurement();
  z.is_object = true;
  z.range_rate_mps = 20.0;
  for (const double along : {-1.0, 0.0, 1.0}) {
    for (const double across : {-1.0, 0.0, 1.0}) {
      const Eigen::Vector2d p(x[0] + along * 2.25, across * 0.9);
      z.range_m = p.norm();
      z.azimuth_rad = std::atan2(p.y(), p.x());
      const auto out = LinearizeRadar(x, extent, EgoState{}, RadarConfig{}, z);
      ASSERT_TRUE(out);
      ASSERT_EQ(out->O.rows(), 3);
      const Eigen::Vector2d lasting(out->O(0, 0) * kDepthOffsetSigma_m,
                                    out->O(1, 1) * kAsideOffsetSigma);
      const Eigen::Vector2d sigma =
          (lasting.array().square() + Eigen::Array2d(out->R(0, 0), out->R(1, 1))).sqrt();
      EXPECT_LT(std::abs(out->y[0]), 2.5 * sigma[0]);
      EXPECT_LT(std::abs(out->y[1]), 2.5 * sigma[1]);
      EXPECT_LT(sigma[0], 4.5);
      EXPECT_LT(sigma[1] * 42.0, 1.8);
    }
  }
}

TEST(LinearizeRadar, CrossingCarIsMeasuredAtItsSide) {
  StateVector x;
  x << 30.9, 0.0, 0.5 * kPi, 10.0, 0.0, 0.0;
  RadarMeasurement z = AnyRadarMeasurement();
  const auto out = LinearizeRadar(x, Extent{4.5, 1.8, 0, 0}, EgoState{}, RadarConfig{}, z);
  ASSERT_TRUE(out);
  EXPECT_NEAR(out->y[0], 0.0, 0.03);
  // Reflections scatter along the side: the bearing's noise grows, the range's hardly.
  EXPECT_GT(out->R(1, 1), 1.5 * z.covariance(1, 1));
  EXPECT_LT(out->R(0, 0), 1.3 * z.covariance(0, 0));
}

TEST(LinearizeRadar, ReflectionsDrawnOnVisibleFacesAverageToThePrediction) {
  // Independent of the model: rays at even angular steps from the antenna, each ends on the first
  // face it meets.
  Random random(23);
  const Extent extent{4.5, 1.8, 0, 0};
  for (int trial = 0; trial < 40; ++trial) {
    const double yaw = random.Uniform(-kPi, kPi);
    const double range = random.Uniform(12.0, 60.0);
    const Eigen::Rotation2Dd R_TO(-yaw);
    const Eigen::Vector2d sensor = R_TO * Eigen::Vector2d(-range, 0.0);
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    int hits = 0;
    for (int ray = -2000; ray <= 2000; ++ray) {
      const double angle = ray * 0.3 / 2000.0;
      const Eigen::Vector2d d = R_TO * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      double near = 0.0, far = 1e9;
      for (int axis = 0; axis < 2; ++axis) {
        const double half = 0.5 * (axis == 0 ? extent.length_m : extent.width_m);
        const double a = (-half - sensor[axis]) / d[axis];
        const double b = (half - sensor[axis]) / d[axis];
        near = std::max(near, std::min(a, b));
        far = std::min(far, std::max(a, b));
      }
      if (near >= far) continue;
      sum += sensor + near * d;
      ++hits;
    }
    const Eigen::Vector2d mean = sum / hits;
    const Eigen::Vector2d offset = ReflectionOffset(Eigen::Vector2d(-range, 0.0), yaw, extent);
    EXPECT_LT((mean - offset).norm(), 0.12) << "yaw " << yaw << " range " << range;
  }
}

// A car that leaves the field of view beside the ego: only its nose still reflects.
TEST(LinearizeRadar, ReflectionsInsideTheFieldOfViewAverageToThePrediction) {
  EgoState ego;
  RadarConfig radar;
  radar.x_m = 3.45;
  radar.y_m = -0.75;
  radar.yaw_rad = FromDegrees(-55.0);
  radar.half_fov_rad = FromDegrees(70.0);
  const Extent extent{4.5, 1.8, 0.0, 0.0};
  for (const double x_m : {4.0, 2.5, 2.0, 1.5}) {
    const StateVector state = (StateVector() << x_m, -3.8, 0.0, 26.0, 0.0, 0.0).finished();
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    int count = 0;
    for (int k = 0; k < 4000; ++k) {  // Its left flank, the one face that is turned to the radar.
      const Eigen::Vector2d q(x_m - 2.25 + 4.5 * (k + 0.5) / 4000, -3.8 + 0.9);
      const Eigen::Vector2d d = q - Eigen::Vector2d(radar.x_m, radar.y_m);
      if (std::abs(WrapAngle(std::atan2(d.y(), d.x()) - radar.yaw_rad)) > radar.half_fov_rad) {
        continue;
      }
      mean += d;
      ++count;
    }
    mean /= count;
    RadarMeasurement z = AnyRadarMeasurement();
    z.range_m = mean.norm();
    z.azimuth_rad = WrapAngle(std::atan2(mean.y(), mean.x()) - radar.yaw_rad);
    z.visible_share = count / 4000.0;
    const auto model = LinearizeRadar(state, extent, ego, radar, z);
    ASSERT_TRUE(model);
    EXPECT_NEAR(model->y[0], 0.0, 0.1) << x_m;
    EXPECT_NEAR(model->y[1] * z.range_m, 0.0, 0.1) << x_m;
  }
  ExpectJacobian(
      [&](const StateVector& at, const Extent& size) {
        return LinearizeRadar(at, size, ego, radar, AnyRadarMeasurement());
      },
      (StateVector() << 1.5, -3.8, 0.1, 26.0, 0.1, 0.5).finished(), extent, 1e-5);
}

TEST(LinearizeRadar, TargetAtTheAntennaIsRefused) {
  StateVector x = StateVector::Zero();
  x[kX] = 0.05;
  EXPECT_FALSE(
      LinearizeRadar(x, Extent{0, 0, 0, 0}, EgoState{}, RadarConfig{}, AnyRadarMeasurement()));
}

TEST(LinearizeCamera, SilhouetteOfALeadCarGivesItsCornersAndRearContact) {
  StateVector x;
  x << 1.8 + 20.0 + 2.25, 0.0, 0.0, 10.0, 0.0, 0.0;  // Rear bumper 20 m ahead of the camera.
  CameraMeasurement z = AnyCameraMeasurement();
  z.azimuth_left_rad = std::atan2(0.9, 20.0);
  z.azimuth_right_rad = -z.azimuth_left_rad;
  z.depression_rad = std::atan2(1.4, 20.0);
  const auto out = LinearizeCamera(x, Extent{4.5, 1.8, 0, 0}, EgoState{}, CameraConfig{}, z);
  ASSERT_TRUE(out);
  ASSERT_EQ(out->y.size(), 3);
  EXPECT_LT(out->y.norm(), 1e-9);
}

TEST(LinearizeCamera, CutEdgesDropTheirRows) {
  StateVector x;
  x << 20.0, 0.0, 0.0, 10.0, 0.0, 0.0;
  CameraMeasurement z = AnyCameraMeasurement();
  z.left_is_cut = true;
  const auto two = LinearizeCamera(x, Extent{4.5, 1.8, 0, 0}, EgoState{}, CameraConfig{}, z);
  ASSERT_TRUE(two);
  EXPECT_EQ(two->y.size(), 2);
  z.right_is_cut = z.bottom_is_cut = true;
  EXPECT_FALSE(LinearizeCamera(x, Extent{4.5, 1.8, 0, 0}, EgoState{}, CameraConfig{}, z));
  x[kX] = -20.0;
  EXPECT_FALSE(LinearizeCamera(x, Extent{4.5, 1.8, 0, 0}, EgoState{}, CameraConfig{},
                               AnyCameraMeasurement()));
}

TEST(UpdateWithProperty, CovarianceStaysPositiveAndNeverGrows) {
  Random random(24);
  const RadarConfig radar = TurnedRadar();
  for (int trial = 0; trial < 200; ++trial) {
    KinematicState state{RandomState(random), RandomCovariance<kStateSize>(random, 2.0)};
    const StateMatrix before = state.covariance;
    const auto z =
        LinearizeRadar(state.mean, Extent{}, RandomEgo(random), radar, AnyRadarMeasurement());
    ASSERT_TRUE(z);
    ASSERT_TRUE(UpdateWith(*z, state));
    const Eigen::SelfAdjointEigenSolver<StateMatrix> after(state.covariance);
    EXPECT_GT(after.eigenvalues().minCoeff(), 0.0);
    const Eigen::SelfAdjointEigenSolver<StateMatrix> gain(before - state.covariance);
    EXPECT_GT(gain.eigenvalues().minCoeff(), -1e-9);
  }
}

TEST(UpdateWith, RefusesWhatIsNotPositiveDefinite) {
  KinematicState state;
  const StateVector before = state.mean;
  Linearized z = LinearizePosition(state.mean, {1.0, 1.0}, Eigen::Matrix2d::Identity());
  z.R = -5.0 * Eigen::Matrix2d::Identity();
  EXPECT_FALSE(UpdateWith(z, state));
  EXPECT_EQ(state.mean, before);
  EXPECT_FALSE(Evaluate(z, state.covariance));
}

TEST(Evaluate, GivesMahalanobisDistanceAndLogDeterminant) {
  KinematicState state;
  state.covariance = 3.0 * StateMatrix::Identity();
  const Linearized z = LinearizePosition(state.mean, {2.0, 4.0}, Eigen::Matrix2d::Identity());
  const auto likelihood = Evaluate(z, state.covariance);
  ASSERT_TRUE(likelihood);
  EXPECT_NEAR(likelihood->distance_squared, 20.0 / 4.0, 1e-12);
  EXPECT_NEAR(likelihood->log_det, std::log(16.0), 1e-12);
  EXPECT_EQ(likelihood->rows, 2);
}

}  // namespace
}  // namespace v2vouch
