// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/radar/radar_preprocessing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/random.h"

namespace v2vouch {
namespace {

const VehicleConfig kVehicle;
const RadarConfig& kFront = kVehicle.radars[0];
const RadarConfig& kLeft = kVehicle.radars[1];

EgoState Ego(double speed_mps, double yaw_rate_radps = 0.0) {
  EgoState ego;
  ego.speed_mps = speed_mps;
  ego.yaw_rate_radps = yaw_rate_radps;
  return ego;
}

// A rectangle in B moving over ground; the ego is at B's origin.
struct Car {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
  double speed_mps = 0.0;
  double length_m = 4.5;
  double width_m = 1.8;
};

// What a radar would say of a point at p_B that moves with v_B over ground.
RadarDetection Ideal(const RadarConfig& radar, const EgoState& ego, const Eigen::Vector2d& p_B,
                     const Eigen::Vector2d& v_B) {
  const Eigen::Vector2d antenna(radar.x_m, radar.y_m);
  // Velocity of the antenna by definition: v + w x r.
  const Eigen::Vector2d antenna_v(ego.speed_mps - ego.yaw_rate_radps * antenna.y(),
                                  ego.yaw_rate_radps * antenna.x());
  const Eigen::Vector2d q = p_B - antenna;
  RadarDetection d;
  d.range_m = q.norm();
  d.azimuth_rad = WrapAngle(std::atan2(q.y(), q.x()) - radar.yaw_rad);
  d.range_rate_mps = (v_B - antenna_v).dot(q.normalized());
  return d;
}

void AddNoise(const RadarConfig& radar, Random& random, RadarDetection& d) {
  d.range_m += random.Normal(0.0, radar.range_sigma_m);
  d.azimuth_rad += random.Normal(0.0, radar.azimuth_sigma_rad);
  d.range_rate_mps += random.Normal(0.0, radar.range_rate_sigma_mps);
}

// `count` reflections spread evenly at random over the faces that look at the radar.
void Reflect(const Car& car, const RadarConfig& radar, const EgoState& ego, int count,
             Random& random, std::vector<RadarDetection>& detections) {
  const Eigen::Vector2d centre(car.x_m, car.y_m);
  const Eigen::Vector2d ahead(std::cos(car.yaw_rad), std::sin(car.yaw_rad));
  const Eigen::Vector2d aside(-ahead.y(), ahead.x());
  const Eigen::Vector2d to_radar = Eigen::Vector2d(radar.x_m, radar.y_m) - centre;
  const double front = to_radar.dot(ahead);
  const double side = to_radar.dot(aside);
  const bool sees_end = std::abs(front) > 0.5 * car.length_m;
  const bool sees_side = std::abs(side) > 0.5 * car.width_m;
  for (int i = 0; i < count; ++i) {
    const double share = car.length_m / (car.length_m + car.width_m);
    const bool on_side = sees_side && (!sees_end || random.Bernoulli(share));
    double along = std::copysign(0.5 * car.length_m, front);
    double across = std::copysign(0.5 * car.width_m, side);
    (on_side ? along : across) = random.Uniform(-0.5, 0.5) * (on_side ? car.length_m : car.width_m);
    RadarDetection d =
        Ideal(radar, ego, centre + along * ahead + across * aside, car.speed_mps * ahead);
    AddNoise(radar, random, d);
    detections.push_back(d);
  }
}

std::vector<RadarMeasurement> Process(const RadarConfig& radar, const EgoState& ego,
                                      std::vector<RadarDetection> detections,
                                      const RadarPreprocessingConfig& config = {}) {
  RadarScan scan;
  scan.radar = 2;
  scan.detections = std::move(detections);
  RadarPreprocessor preprocessor(config);
  std::vector<RadarMeasurement> measurements(3);  // Left-overs must go.
  preprocessor.Process(scan, radar, ego, measurements);
  return measurements;
}

RadarDetection Plain(double range_m, double azimuth_rad, double range_rate_mps = 0.0) {
  RadarDetection d;
  d.range_m = range_m;
  d.azimuth_rad = azimuth_rad;
  d.range_rate_mps = range_rate_mps;
  return d;
}

TEST(RadarPreprocessor, DropsWeakReturnsButNotWhatTheSensorDoesNotMeasure) {
  RadarPreprocessingConfig config;
  config.rcs_slope_db = 3.0;  // -15 dBsm at 10 m, -9 at 40 m.
  const auto survivors = [&](double range_m, double snr_db, double rcs_dbsm) {
    RadarDetection d = Plain(range_m, 0.0);
    d.snr_db = snr_db;
    d.rcs_dbsm = rcs_dbsm;
    return Process(kFront, Ego(0.0), {d}, config).size();
  };
  EXPECT_EQ(survivors(40.0, kNaN, kNaN), 1U);
  EXPECT_EQ(survivors(40.0, 6.1, kNaN), 1U);
  EXPECT_EQ(survivors(40.0, 5.9, kNaN), 0U);
  EXPECT_EQ(survivors(40.0, kNaN, -8.9), 1U);
  EXPECT_EQ(survivors(40.0, kNaN, -9.1), 0U);
  EXPECT_EQ(survivors(10.0, kNaN, -14.9), 1U);
  EXPECT_EQ(survivors(5.0, kNaN, -15.1), 0U);  // No relief below 10 m.
}

TEST(RadarPreprocessor, DropsWhatIsOutsideTheSensorsLimitsOrNotFinite) {
  const double edge = kFront.half_fov_rad + 3.0 * kFront.azimuth_sigma_rad;
  EXPECT_EQ(Process(kFront, Ego(0.0), {Plain(50.0, edge - 1e-6), Plain(50.0, -edge + 1e-6)}).size(),
            2U);
  EXPECT_TRUE(Process(kFront, Ego(0.0),
                      {Plain(50.0, edge + 1e-6), Plain(0.4, 0.0), Plain(160.1, 0.0), Plain(-5.0, 0),
                       Plain(kNaN, 0.0), Plain(50.0, kNaN), Plain(50.0, 0.0, kNaN)})
                  .empty());
}

TEST(RadarPreprocessor, TakesTheAntennasMotionOutLeverArmIncluded) {
  // Turning left at 0.4 rad/s the corner radar's antenna moves sideways at 3.45 * 0.4 = 1.4 m/s,
  // which alone would make poles look like walking people.
  const EgoState ego = Ego(8.0, 0.4);
  for (const double bearing : {-10.0, 20.0, 55.0, 90.0, 120.0}) {
    const double b = FromDegrees(bearing);
    const Eigen::Vector2d pole(3.45 + 20.0 * std::cos(b), 0.75 + 20.0 * std::sin(b));
    const auto m = Process(kLeft, ego, {Ideal(kLeft, ego, pole, Eigen::Vector2d::Zero())}).at(0);
    EXPECT_NEAR(m.ground_range_rate_mps, 0.0, 1e-9);
    EXPECT_TRUE(m.is_static);
    const auto walker = Process(kLeft, ego, {Ideal(kLeft, ego, pole, 1.9 * pole.normalized())});
    EXPECT_NEAR(walker.at(0).ground_range_rate_mps, 1.9, 0.05);
    EXPECT_FALSE(walker.at(0).is_static);
  }
}

// The share of standing reflections that pass as standing follows the stated 3 sigma, whatever the
// speed: with a fixed tolerance a fast ego would see walls move.
TEST(RadarPreprocessor, ToleranceOfStandingGrowsWithSpeedAcrossTheRay) {
  Random random(5);
  for (const double speed_mps : {0.0, 15.0, 35.0}) {
    int moving = 0;
    const int trials = 3000;
    for (int i = 0; i < trials; ++i) {
      EgoState ego = Ego(speed_mps);
      const double b = random.Uniform(-0.2, 2.1);
      const Eigen::Vector2d pole(3.45 + 40.0 * std::cos(b), 0.75 + 40.0 * std::sin(b));
      RadarDetection d = Ideal(kLeft, ego, pole, Eigen::Vector2d::Zero());
      AddNoise(kLeft, random, d);
      ego.speed_mps += random.Normal(0.0, ego.speed_sigma_mps);
      for (const auto& m : Process(kLeft, ego, {d})) moving += m.is_static ? 0 : 1;
    }
    EXPECT_LT(moving, 0.006 * trials) << speed_mps << " m/s";
  }
}

TEST(RadarPreprocessor, ReferencePointIsTheMeanOfTheReflections) {
  const auto m = Process(kFront, Ego(0.0),
                         {Plain(20.0, 0.03, 5.0), Plain(21.0, 0.0, 5.2), Plain(20.4, -0.03, 5.1)});
  ASSERT_EQ(m.size(), 1U);
  const double x = (20.0 * std::cos(0.03) + 21.0 + 20.4 * std::cos(0.03)) / 3.0;
  const double y = (20.0 - 20.4) * std::sin(0.03) / 3.0;
  EXPECT_EQ(m[0].radar, 2);
  EXPECT_EQ(m[0].returns, 3);
  EXPECT_NEAR(m[0].range_m, std::hypot(x, y), 1e-12);
  EXPECT_NEAR(m[0].azimuth_rad, std::atan2(y, x), 1e-12);
  EXPECT_NEAR(m[0].range_rate_mps, 5.1, 1e-12);
  EXPECT_DOUBLE_EQ(m[0].near_range_m, 20.0);
  EXPECT_DOUBLE_EQ(m[0].radial_extent_m, 1.0);
  EXPECT_DOUBLE_EQ(m[0].azimuth_min_rad, -0.03);
  EXPECT_DOUBLE_EQ(m[0].azimuth_max_rad, 0.03);
  EXPECT_EQ(m[0].object_id, -1);
  EXPECT_FALSE(m[0].is_object);
}

TEST(RadarPreprocessor, CovarianceIsThatOfASampleMean) {
  // One reflection: the sensor's own noise. n on one spot: the same over n.
  const auto one = Process(kFront, Ego(0.0), {Plain(20.0, 0.0, 5.0)}).at(0);
  const auto four = Process(kFront, Ego(0.0), std::vector(4, Plain(20.0, 0.0, 5.0))).at(0);
  const Eigen::Vector3d noise(std::pow(kFront.range_sigma_m, 2),
                              std::pow(kFront.azimuth_sigma_rad, 2),
                              std::pow(kFront.range_rate_sigma_mps, 2));
  EXPECT_TRUE(one.covariance.diagonal().isApprox(noise));
  EXPECT_TRUE(four.covariance.diagonal().isApprox(noise / 4.0));
  // Two on one outline, 0.6 m apart along the ray: of their mean 0.6^2 / 4.
  const auto two = Process(kFront, Ego(0.0), {Plain(20.0, 0.0, 5.0), Plain(20.6, 0.0, 5.0)}).at(0);
  EXPECT_NEAR(two.covariance(0, 0), 0.6 * 0.6 / 4.0, 1e-12);
}

TEST(RadarPreprocessor, WeakReturnsFromInsideACarDoNotMoveItsReference) {
  // As other simulators and real radars have it: the bumper, and what lies under the car.
  const auto strong = [](double range_m, double azimuth_rad, double snr_db) {
    RadarDetection d = Plain(range_m, azimuth_rad, 5.0);
    d.snr_db = snr_db;
    return d;
  };
  const auto m = Process(kFront, Ego(0.0),
                         {strong(20.0, 0.01, 45.0), strong(20.1, -0.01, 41.0),
                          strong(20.9, 0.02, 24.0), strong(21.7, -0.02, 19.0)});
  ASSERT_EQ(m.size(), 1U);
  EXPECT_NEAR(m[0].range_m, 20.05, 0.01);
  EXPECT_EQ(m[0].outline_count, 2U);
  EXPECT_EQ(m[0].returns, 4);
  EXPECT_NEAR(m[0].radial_extent_m, 1.7, 1e-9);
  EXPECT_NEAR(m[0].middle_azimuth_rad, 0.0, 1e-9);
  EXPECT_DOUBLE_EQ(m[0].azimuth_max_rad, 0.02);
}

TEST(RadarPreprocessor, RangeRateIsThatOfTheReferencePointForAWideClusterToo) {
  // A wall piece 3 m off, seen under a wide angle while passing: every reflection has its own
  // range rate, and their plain mean would belong to no point at all.
  const EgoState ego = Ego(15.0);
  std::vector<RadarDetection> wall;
  for (double x = 4.0; x <= 9.0; x += 0.5) {
    wall.push_back(Ideal(kLeft, ego, {x, 3.75}, Eigen::Vector2d::Zero()));
  }
  const auto m = Process(kLeft, ego, wall);
  ASSERT_EQ(m.size(), 1U);
  EXPECT_NEAR(m[0].ground_range_rate_mps, 0.0, 1e-9);
  const double bearing = m[0].azimuth_rad + kLeft.yaw_rad;
  EXPECT_NEAR(m[0].range_rate_mps, -15.0 * std::cos(bearing), 1e-9);
}

TEST(RadarPreprocessor, ObjectsOfATrackingSensorAreNotClustered) {
  RadarConfig tracking = kFront;
  tracking.output = RadarOutput::kObjects;
  auto a = Plain(30.0, 0.01, 3.0);
  a.track_id = 7;
  auto b = Plain(30.5, 0.0, 3.0);
  b.track_id = 9;
  const auto m = Process(tracking, Ego(0.0), {a, b});
  ASSERT_EQ(m.size(), 2U);
  EXPECT_EQ(m[0].object_id, 9);
  EXPECT_EQ(m[1].object_id, 7);
  EXPECT_TRUE(m[0].is_object);
  EXPECT_DOUBLE_EQ(m[0].radial_extent_m, 0.0);
  EXPECT_DOUBLE_EQ(m[0].near_range_m, 30.5);
}

TEST(RadarPreprocessor, OrderOfDetectionsSaysNothing) {
  Random random(8);
  const EgoState ego = Ego(12.0, 0.1);
  std::vector<RadarDetection> detections;
  for (int i = 0; i < 12; ++i) {
    const Car car{random.Uniform(8.0, 60.0), random.Uniform(-5.0, 30.0), random.Uniform(-3.0, 3.0),
                  random.Uniform(0.0, 20.0)};
    Reflect(car, kLeft, ego, 4, random, detections);
  }
  const auto a = Process(kLeft, ego, detections);
  std::reverse(detections.begin(), detections.end());
  std::rotate(detections.begin(), detections.begin() + 17, detections.end());
  const auto b = Process(kLeft, ego, detections);
  ASSERT_EQ(a.size(), b.size());
  ASSERT_GT(a.size(), 5U);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].range_m, b[i].range_m);
    EXPECT_EQ(a[i].azimuth_rad, b[i].azimuth_rad);
    EXPECT_EQ(a[i].covariance, b[i].covariance);
    EXPECT_LE(a[i == 0 ? 0 : i - 1].azimuth_rad, a[i].azimuth_rad);
  }
}

TEST(RadarPreprocessor, ACopyGivesTheSameAnswers) {
  RadarPreprocessingConfig config;
  config.vehicle_gap_m = 0.0;
  RadarPreprocessor original(config);
  RadarScan scan;
  scan.detections = {Plain(30.0, 0.0, 5.0), Plain(33.0, 0.0, 5.0)};  // Two, where none may join.
  std::vector<RadarMeasurement> a;
  std::vector<RadarMeasurement> b;
  original.Process(scan, kFront, Ego(0.0), a);
  RadarPreprocessor copy(RadarPreprocessingConfig{});
  copy.Process(scan, kFront, Ego(0.0), b);
  EXPECT_EQ(a.size(), 2U);
  EXPECT_EQ(b.size(), 1U);
  copy = original;
  copy.Process(scan, kFront, Ego(0.0), b);
  EXPECT_EQ(b.size(), 2U);
}

TEST(RadarPreprocessor, AStandingCarBesideAWallIsFoundAndAMovingOneNeverJoinsIt) {
  Random random(21);
  const EgoState ego = Ego(10.0);
  int found_standing = 0;
  const int trials = 200;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<RadarDetection> detections;
    for (double x = 15.0; x < 75.0; x += random.Uniform(0.5, 2.2)) {  // Facade at y = 6 m.
      auto d = Ideal(kFront, ego, {x, 6.0}, Eigen::Vector2d::Zero());
      AddNoise(kFront, random, d);
      detections.push_back(d);
    }
    const Car parked{40.0, 3.6, 0.0, 0.0};
    const Car moving{25.0, 3.6, 0.0, 6.0};
    Reflect(parked, kFront, ego, 5, random, detections);
    Reflect(moving, kFront, ego, 5, random, detections);
    const auto measurements = Process(kFront, ego, detections);
    int moving_returns = 0;
    bool standing = false;
    for (const auto& m : measurements) {
      const double x = kFront.x_m + m.range_m * std::cos(m.azimuth_rad);
      const double y = m.range_m * std::sin(m.azimuth_rad);
      const double extent_m =
          std::hypot(m.radial_extent_m, m.range_m * (m.azimuth_max_rad - m.azimuth_min_rad));
      if (m.is_static) {
        EXPECT_LE(extent_m, 8.5);
        standing |= std::abs(x - 40.0) < 3.0 && std::abs(y - 3.6) < 1.6;
      } else {
        moving_returns += m.returns;
        EXPECT_NEAR(x, 25.0, 4.0);
      }
    }
    EXPECT_EQ(moving_returns, 5);
    found_standing += standing ? 1 : 0;
  }
  EXPECT_GE(found_standing, 0.85 * trials);
}

// How well cars come out as one cluster each. The bounds lie a little below what was measured when
// they were set; they catch a clustering that got worse.
double ShareInOneCluster(const RadarConfig& radar, const Car& shape, double near_m, double far_m) {
  Random random(17);
  const EgoState ego = Ego(10.0);
  const int trials = 1000;
  int whole = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const double r = random.Uniform(near_m, far_m);
    const double a = radar.yaw_rad + random.Uniform(-0.4, 0.4);
    Car car = shape;
    car.x_m = radar.x_m + r * std::cos(a);
    car.y_m = radar.y_m + r * std::sin(a);
    std::vector<RadarDetection> detections;
    Reflect(car, radar, ego, 3 + trial % 4, random, detections);
    whole += Process(radar, ego, detections).size() == 1 ? 1 : 0;
  }
  return whole / static_cast<double>(trials);
}

TEST(RadarClusterQuality, ASingleCarIsMostlyOneCluster) {
  const Car same_way{0, 0, 0.0, 15.0};
  const Car oncoming{0, 0, kPi, 12.0};
  const Car crossing{0, 0, FromDegrees(90.0), 10.0};
  const Car truck{0, 0, 0.0, 15.0, 12.0, 2.5};
  EXPECT_GE(ShareInOneCluster(kFront, same_way, 15.0, 100.0), 0.95);
  EXPECT_GE(ShareInOneCluster(kFront, oncoming, 15.0, 100.0), 0.91);
  EXPECT_GE(ShareInOneCluster(kLeft, same_way, 10.0, 60.0), 0.94);
  // Its middle shows no Doppler and passes as standing.
  EXPECT_GE(ShareInOneCluster(kFront, crossing, 25.0, 80.0), 0.68);
  EXPECT_GE(ShareInOneCluster(kLeft, crossing, 10.0, 60.0), 0.80);
  // Three to six reflections on twelve metres leave gaps that two cars may leave too.
  EXPECT_GE(ShareInOneCluster(kFront, truck, 20.0, 100.0), 0.42);
}

// Standing reflections have no motion to be told apart by. Joining them is the tracker's work,
// which knows where a vehicle stands; here a car must not be mixed up with the post at the kerb.
TEST(RadarClusterQuality, AParkedCarAndAPostBesideItStayApart) {
  Random random(23);
  const EgoState ego = Ego(10.0);
  const int trials = 1000;
  int apart = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const double x = random.Uniform(15.0, 60.0);
    std::vector<RadarDetection> detections;
    Reflect({x, 8.4, 0.0, 0.0}, kFront, ego, 4, random, detections);
    const Eigen::Vector2d post(x + random.Uniform(-4.0, 4.0), 10.6);
    detections.push_back(Ideal(kFront, ego, post, Eigen::Vector2d::Zero()));
    const auto m = Process(kFront, ego, detections);
    apart += std::any_of(m.begin(), m.end(), [&](const RadarMeasurement& c) {
      const double y = c.range_m * std::sin(c.azimuth_rad);
      const double at = c.range_m * std::cos(c.azimuth_rad) + kFront.x_m;
      return c.returns == 1 && std::hypot(at - post.x(), y - post.y()) < 0.1;
    });
  }
  EXPECT_GE(apart / static_cast<double>(trials), 0.82);
}

// Two cars side by side at about the same speed, lanes 3.5 m apart.
double ShareApart(const RadarConfig& radar, double near_m, double far_m) {
  Random random(9);
  const EgoState ego = Ego(20.0);
  const int trials = 1000;
  int apart = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const double x = random.Uniform(near_m, far_m);
    std::vector<RadarDetection> detections;
    Reflect({x, 0.0, 0.0, 18.0}, radar, ego, 4, random, detections);
    Reflect({x + random.Uniform(-2.0, 2.0), 3.5, 0.0, 18.0 + random.Normal()}, radar, ego, 4,
            random, detections);
    const auto m = Process(radar, ego, detections);
    const bool mixed = std::any_of(m.begin(), m.end(), [](const auto& c) { return c.returns > 4; });
    apart += mixed ? 0 : 1;
  }
  return apart / static_cast<double>(trials);
}

TEST(RadarClusterQuality, NeighboursMostlyStayApart) {
  EXPECT_GE(ShareApart(kFront, 15.0, 60.0), 0.90);
  EXPECT_GE(ShareApart(kFront, 60.0, 120.0), 0.74);
  EXPECT_GE(ShareApart(kLeft, 8.0, 40.0), 0.79);
}

TEST(RadarPreprocessor, TwoPiecesOfOneFlankJoinTwoCarsDoNot) {
  const EgoState ego = Ego(10.0);
  const auto clusters = [&](const std::vector<Eigen::Vector2d>& points, const Eigen::Vector2d& v) {
    std::vector<RadarDetection> detections;
    for (const auto& p : points) detections.push_back(Ideal(kFront, ego, p, v));
    return Process(kFront, ego, detections).size();
  };
  // 3.5 m apart along the motion: front and rear of one flank. Across it: two cars abreast.
  const std::vector<Eigen::Vector2d> along = {{30.0, 4.0}, {30.4, 4.0}, {33.9, 4.0}, {34.2, 4.0}};
  const std::vector<Eigen::Vector2d> abreast = {{30.0, 0.0}, {30.0, 0.4}, {30.0, 3.9}, {30.0, 4.2}};
  EXPECT_EQ(clusters(along, {15.0, 0.0}), 1U);
  EXPECT_EQ(clusters(abreast, {15.0, 0.0}), 2U);
  // The same places, driving the other way round: crossing from the right.
  EXPECT_EQ(clusters(abreast, {6.0, 15.0}), 1U);
  EXPECT_EQ(clusters(along, {6.0, 15.0}), 2U);
}

}  // namespace
}  // namespace v2vouch
