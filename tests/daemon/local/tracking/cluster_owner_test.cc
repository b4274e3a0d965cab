// SPDX-License-Identifier: Apache-2.0
// Clusters of one vehicle are joined as one measurement of it.
#include "daemon/local/tracking/cluster_owner.h"

#include <gtest/gtest.h>

#include <cmath>

namespace v2vouch {
namespace {

RadarMeasurement ClusterAt(double range_m, double azimuth_rad, const Eigen::Vector2d& v_TA_R) {
  RadarMeasurement z;
  z.returns = 3;
  z.range_m = z.near_range_m = range_m;
  z.azimuth_rad = z.middle_azimuth_rad = azimuth_rad;
  z.outline[z.outline_count++] = {range_m, azimuth_rad, 40.0};
  z.range_rate_mps = v_TA_R.dot(Eigen::Vector2d(std::cos(azimuth_rad), std::sin(azimuth_rad)));
  return z;
}

// Nose and tail of a car beside a sensor that passes it at 50 km/h, of one that drives along with
// it, and of one that crosses: what it does shows no other speed than its own at the joint azimuth.
TEST(JoinClusters, GiveTheRangeRateOfTheVehicleAtTheJointAzimuth) {
  for (const Eigen::Vector2d& v_TA_R :
       {Eigen::Vector2d(-13.9, 0.0), Eigen::Vector2d(1.5, 0.0), Eigen::Vector2d(-13.9, 6.0)}) {
    const RadarMeasurement a = ClusterAt(4.0, -0.5, v_TA_R);
    const RadarMeasurement b = ClusterAt(2.2, -1.3, v_TA_R);
    const RadarMeasurement joint = JoinClusters(a, b, v_TA_R);
    EXPECT_LT(joint.azimuth_rad, -0.5);
    EXPECT_GT(joint.azimuth_rad, -1.3);
    const Eigen::Vector2d ray(std::cos(joint.azimuth_rad), std::sin(joint.azimuth_rad));
    EXPECT_NEAR(joint.range_rate_mps, v_TA_R.dot(ray), 1e-9);
  }
}

// Where the vehicle's velocity is not what was thought, the clusters say so.
TEST(JoinClusters, KeepWhatTheClustersHaveMeasured) {
  const Eigen::Vector2d true_mps(-10.0, 0.0);
  const RadarMeasurement joint =
      JoinClusters(ClusterAt(20.0, 0.05, true_mps), ClusterAt(20.0, -0.05, true_mps), {-14.0, 0.0});
  EXPECT_NEAR(joint.range_rate_mps, -10.0, 0.02);
}

}  // namespace
}  // namespace v2vouch
