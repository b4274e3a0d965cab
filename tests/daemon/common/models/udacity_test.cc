// SPDX-License-Identifier: Apache-2.0
// The EKF on the file that generations of students were measured with: radar and position
// measurements of one weaving target, 500 rows, with truth. The course's mark is an RMSE of x, y,
// vx, vy of at most 0.11, 0.11, 0.52, 0.52.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>

#include "daemon/common/models/ctra.h"
#include "daemon/common/models/measurement_model.h"
#include "tests/support/data_folder.h"

namespace v2vouch {
namespace {

std::filesystem::path DataFile() {
  return DataFolder() / "radar/udacity_ekf/obj_pose-laser-radar-synthetic-input.txt";
}

TEST(Udacity, RadarAndPositionModelsPassTheCoursesMark) {
  std::ifstream file(DataFile());
  if (!file) {
    GTEST_SKIP() << "SKIPPED: no reference data at " << DataFile();
  }
  // A target that weaves at up to 0.55 rad/s: the course's own setting of the noise is 9 m^2/s^4.
  MotionNoise noise;
  noise.jerk_psd = 1.0;
  noise.yaw_accel_psd = 0.2;
  RadarConfig radar;  // At the origin, looking along x.
  EgoState ego;
  ego.speed_sigma_mps = ego.yaw_rate_sigma_radps = 0.0;
  const Extent point{0.0, 0.0, 0.0, 0.0};

  KinematicState state;
  double last_s = 0.0;
  int rows = 0;
  Eigen::Vector4d squares = Eigen::Vector4d::Zero();
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream in(line);
    char kind = 0;
    double a = 0, b = 0, c = 0, utime = 0;
    Eigen::Vector4d truth;
    in >> kind >> a >> b;
    if (kind == 'R') in >> c;
    in >> utime >> truth[0] >> truth[1] >> truth[2] >> truth[3];
    ASSERT_TRUE(in);
    const double t = utime * 1e-6;
    if (rows == 0) {
      ASSERT_EQ(kind, 'L');
      // First row gives the place; velocity as unknown as a road vehicle's without direction.
      state.mean << a, b, 0.0, 3.0, 0.0, 0.0;
      state.covariance = StateVector(0.02, 0.02, 0.3, 9.0, 0.05, 1.0).asDiagonal();
    } else {
      PredictCtra(state, t - last_s, noise);
      if (kind == 'L') {
        const Eigen::Matrix2d R = 0.15 * 0.15 * Eigen::Matrix2d::Identity();
        ASSERT_TRUE(UpdateWith(LinearizePosition(state.mean, {a, b}, R), state));
      } else {
        RadarMeasurement z;
        z.range_m = a;
        z.azimuth_rad = b;
        z.range_rate_mps = c;
        z.covariance = Eigen::Vector3d(0.09, 0.0009, 0.09).asDiagonal();
        const auto model = LinearizeRadar(state.mean, point, ego, radar, z);
        ASSERT_TRUE(model);
        ASSERT_TRUE(UpdateWith(*model, state));
      }
    }
    last_s = t;
    ++rows;
    const Eigen::Vector4d estimate(state.mean[kX], state.mean[kY],
                                   state.mean[kSpeed] * std::cos(state.mean[kYaw]),
                                   state.mean[kSpeed] * std::sin(state.mean[kYaw]));
    squares += (estimate - truth).cwiseAbs2();
  }
  ASSERT_EQ(rows, 500);
  const Eigen::Vector4d rmse = (squares / rows).cwiseSqrt();
  std::cout << "udacity RMSE x y vx vy: " << rmse.transpose() << std::endl;
  EXPECT_LE(rmse[0], 0.11);
  EXPECT_LE(rmse[1], 0.11);
  EXPECT_LE(rmse[2], 0.52);
  EXPECT_LE(rmse[3], 0.52);
}

}  // namespace
}  // namespace v2vouch
