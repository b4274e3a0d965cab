// SPDX-License-Identifier: Apache-2.0
#include "calibration/extrinsics/verdicts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace v2vouch {
namespace {

using testing::HasSubstr;

VehicleConfig OneRadar() {
  VehicleConfig vehicle;
  vehicle.radars.resize(1);
  vehicle.cameras.clear();
  return vehicle;
}

TEST(HoldWeakDirections, WhatNothingMeasuresStaysAtThePriorTogether) {
  MountingParameters parameters(OneRadar(), {});
  const auto n = parameters.size();
  // Radar y and antenna y are known against each other only.
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(n, n);
  const int radar_y = parameters.RadarAt(0) + 1;
  const int antenna_y = parameters.EgoAt() + MountingParameters::kAntennaY;
  const double information = 1.0 / (0.001 * 0.001);
  S(radar_y, radar_y) = S(antenna_y, antenna_y) = information;
  S(radar_y, antenna_y) = S(antenna_y, radar_y) = -information;
  parameters.values()[static_cast<std::size_t>(radar_y)] += 0.10;  // Both moved by the solver.
  parameters.values()[static_cast<std::size_t>(antenna_y)] += 0.10;

  const HeldPosterior held = HoldWeakDirections(S, Eigen::MatrixXd::Zero(S.rows(), 0), parameters);
  EXPECT_NEAR(held.values[static_cast<std::size_t>(radar_y)], 0.0, 1e-4);
  EXPECT_NEAR(held.values[static_cast<std::size_t>(antenna_y)], 0.0, 1e-4);
  // Data alone say nothing of either ...
  EXPECT_GT(held.data_std(radar_y), 0.05);
  EXPECT_GT(held.data_std(antenna_y), 0.3);
  // ... but their difference is known: the antenna is as good as the radar's tape measure.
  EXPECT_NEAR(std::sqrt(held.covariance(antenna_y, antenna_y)), 0.05, 0.002);
  const double difference = held.covariance(radar_y, radar_y) +
                            held.covariance(antenna_y, antenna_y) -
                            2.0 * held.covariance(radar_y, antenna_y);
  EXPECT_NEAR(std::sqrt(difference), 0.001, 2e-4);
  const auto together = std::ranges::find_if(held.weak, [](const WeakDirection& weak) {
    return weak.description.find("radar_front.y_m") != std::string::npos &&
           weak.description.find("ego.antenna_y_m") != std::string::npos;
  });
  EXPECT_NE(together, held.weak.end());
}

struct Measured {
  MountingParameters parameters{OneRadar(), {}};
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(parameters.size(), parameters.size());
  int yaw = parameters.RadarAt(0) + 2;
};

// The radar's yaw is 0.01, known to 1e-4; nothing else is.
Measured YawMeasuredWell() {
  Measured m;
  m.S(m.yaw, m.yaw) = 1.0 / (1e-4 * 1e-4);
  m.parameters.values()[static_cast<std::size_t>(m.yaw)] = 0.01;
  return m;
}

TEST(HoldWeakDirections, WhatIsMeasuredWellIsLeftAlone) {
  const auto [parameters, S, yaw] = YawMeasuredWell();
  const HeldPosterior held = HoldWeakDirections(S, Eigen::MatrixXd::Zero(S.rows(), 0), parameters);
  EXPECT_NEAR(held.values[static_cast<std::size_t>(yaw)], 0.01, 1e-12);
  EXPECT_NEAR(held.data_std(yaw), 1e-4, 1e-7);
  EXPECT_NEAR(held.crlb(yaw), 1e-4, 1e-7);
}

TEST(HoldWeakDirections, WhatIsConsideredOnlyIsInTheDoubtAndNotInTheValue) {
  const auto [parameters, S, yaw] = YawMeasuredWell();
  Eigen::MatrixXd doubts = Eigen::MatrixXd::Zero(S.rows(), 1);
  doubts(yaw, 0) = S(yaw, yaw) * 0.003;  // One sigma of it turns the radar by 0.003.
  const HeldPosterior held = HoldWeakDirections(S, doubts, parameters);
  EXPECT_NEAR(held.values[static_cast<std::size_t>(yaw)], 0.01, 1e-12);
  EXPECT_NEAR(held.data_std(yaw), std::hypot(1e-4, 0.003), 1e-6);
  EXPECT_NEAR(std::sqrt(held.covariance(yaw, yaw)), std::hypot(1e-4, 0.003), 1e-6);
}

TEST(VerdictOf, FollowsWhatTheDataAloneKnow) {
  using enum CalibrationVerdict;
  EXPECT_EQ(VerdictOf(0.01, 0.016, 0.0, 0.05, true), kEstimated);
  EXPECT_EQ(VerdictOf(0.01, 0.017, 0.0, 0.05, true), kWeak);
  EXPECT_EQ(VerdictOf(0.01, 0.051, 0.0, 0.05, true), kPrior);
  EXPECT_EQ(VerdictOf(0.01, std::numeric_limits<double>::quiet_NaN(), 0.0, 0.05, true), kPrior);
  EXPECT_EQ(VerdictOf(0.16, 0.001, 0.0, 0.05, true), kAtBound);
  EXPECT_EQ(VerdictOf(0.01, 0.001, 0.0, 0.05, false), kRejected);
}

TEST(HintFor, SaysWhatDrivingWouldHelp) {
  using enum CalibrationVerdict;
  Excitation straight;
  straight.moving_s = 300.0;
  straight.yaw_rate_rms_radps = 0.002;
  straight.static_returns = 100'000;
  straight.target_windows = 1000;
  EXPECT_THAT(HintFor("radar_front.x_m", kPrior, straight), HasSubstr("no turns"));
  EXPECT_THAT(HintFor("ego.antenna_x_m", kWeak, straight), HasSubstr("no turns"));
  EXPECT_EQ(HintFor("radar_front.yaw_deg", kEstimated, straight), "");
  Excitation parked;
  EXPECT_THAT(HintFor("radar_front.yaw_deg", kPrior, parked), HasSubstr("hardly moved"));
  Excitation brief = straight;
  brief.duration_s = 18.0;
  brief.moving_s = 15.0;
  EXPECT_THAT(HintFor("radar_front.x_m", kPrior, brief), HasSubstr("only 15 s of driving"));
  EXPECT_THAT(HintFor("ego.slip_s2pm", kPrior, brief), HasSubstr("only a reference outside it"));
  Excitation deaf = straight;
  deaf.messages = {{"radar_front", 900}, {"camera_front", 0}, {"gnss", 20}, {"gnss_heading", 0}};
  EXPECT_EQ(HintFor("camera_front.yaw_deg", kPrior, deaf),
            "no message of camera_front in the logs");
  EXPECT_EQ(HintFor("ego.heading_bias_deg", kPrior, deaf), "no fix in the logs has a heading");
  EXPECT_THAT(HintFor("ego.antenna_x_m", kPrior, deaf), HasSubstr("no turns"));
  deaf.messages["gnss"] = 0;
  EXPECT_EQ(HintFor("ego.antenna_x_m", kPrior, deaf), "no GNSS fix in the logs");
  Excitation alone = straight;
  alone.target_windows = 3;
  EXPECT_THAT(HintFor("camera_front.pitch_deg", kPrior, alone), HasSubstr("drive in traffic"));
}

}  // namespace
}  // namespace v2vouch
