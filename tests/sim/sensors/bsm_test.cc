// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/bsm.h"

#include <gtest/gtest.h>

#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>
#include <set>

#include "tests/sim/sensors/scene.h"

namespace v2vouch::sim {
namespace {

Scenario OneSender() {
  Scenario scenario = StandingEgo();
  scenario.radio.base_loss = 0.0;
  scenario.bsm.gnss = {
      .bias_sigma_m = 0, .markov_sigma_m = 0, .white_sigma_m = 0, .height_sigma_m = 0};
  scenario.bsm.speed_markov_mps = 0.0;
  scenario.bsm.speed_white_mps = 0.0;
  scenario.bsm.heading_markov_rad = 0.0;
  scenario.bsm.heading_white_rad = 0.0;
  AddVehicle(scenario, 1, 60.0, 20.0, 2.5, 13.0);
  scenario.vehicles.back().v2v = true;
  return scenario;
}

TEST(Bsm, WithoutErrorsQuantisationIsAllThatIsLost) {
  const Scenario scenario = OneSender();
  const auto world = MakeWorld(scenario);
  BsmSender sender(*world, 0, 9);
  const GeographicLib::LocalCartesian plane(50.938, 6.957, 100.0);
  int seen = 0;
  for (int i = 0; i < 100; ++i) {
    const double time = sender.next_time_s();
    const auto bsm = sender.Next();
    if (!bsm) continue;
    ++seen;
    double x = 0.0, y = 0.0, z = 0.0;
    plane.Forward(bsm->lat * 1e-7, bsm->long_ * 1e-7, bsm->elev * 0.1, x, y, z);
    const Motion motion = world->actors()[0].trajectory.At(time);
    // Half a unit: 5.6 mm in latitude, 0.05 m in elevation.
    EXPECT_NEAR(x, motion.centre.x(), 0.006);
    EXPECT_NEAR(y, motion.centre.y(), 0.006);
    EXPECT_NEAR(z, 0.0, 0.051);
    EXPECT_NEAR(bsm->speed * 0.02, motion.speed_mps, 0.011);
    // The plane's convergence over a hundred metres is below 0.002 degrees.
    EXPECT_NEAR(bsm->heading * 0.0125, ToDegrees(HeadingOf(motion.yaw_rad)), 0.0085);
    const std::int64_t position_utime =
        static_cast<std::int64_t>(scenario.start_utc_s) * 1000000 + std::llround(time * 1e6);
    EXPECT_EQ(bsm->secMark, (position_utime / 1000) % 60000);
    const double age = 1e-6 * static_cast<double>(bsm->rx_utime - position_utime);
    EXPECT_GE(age, 0.0699);
    EXPECT_LE(age, 0.2001);
    EXPECT_LT(bsm->generation_utime, bsm->rx_utime);
    EXPECT_EQ(bsm->length, 450);
    EXPECT_EQ(bsm->width, 180);
  }
  EXPECT_GT(seen, 95);
}

TEST(Quantise, ClampsToJ2735RangesAndTurnsTheYawRateRound) {
  SenderState state;
  state.speed_mps = -200.0;
  state.heading_rad = 2.0 * kPi - 1e-6;
  state.accel_long_mps2 = 55.0;
  state.yaw_rate_radps = FromDegrees(10.0);
  state.semi_major_m = 50.0;
  bsm_t bsm{};
  Quantise(state, bsm);
  EXPECT_EQ(bsm.speed, 8190);
  EXPECT_EQ(bsm.transmission, 3);
  EXPECT_EQ(bsm.heading, 0);  // Rounds up to a full turn.
  EXPECT_EQ(bsm.accelSet_long, 2000);
  EXPECT_EQ(bsm.accelSet_yaw, -1000);
  EXPECT_EQ(bsm.semiMajor, 254);
}

TEST(BsmSender, IdentityChangesOnceAndTheCountRunsOn) {
  Scenario scenario = OneSender();
  scenario.vehicles[0].sender.identity_change_s = 3.0;
  const auto world = MakeWorld(scenario);
  BsmSender sender(*world, 0, 9);
  std::set<std::array<int, 4>> identities;
  int before = -1;
  for (int i = 0; i < 60; ++i) {
    const auto bsm = sender.Next();
    ASSERT_TRUE(bsm.has_value());
    identities.insert({bsm->id[0], bsm->id[1], bsm->id[2], bsm->id[3]});
    if (before >= 0) {
      EXPECT_EQ(bsm->msgCnt, (before + 1) % 128);
    }
    before = bsm->msgCnt;
  }
  EXPECT_EQ(identities.size(), 2u);
}

TEST(BsmSender, LossRisesWithDistanceAndBehindHouses) {
  const auto received = [](double x_m, bool with_house) {
    Scenario scenario = OneSender();
    scenario.vehicles.clear();
    AddVehicle(scenario, 2, x_m, 0.0, 0.0);
    scenario.vehicles[0].v2v = true;
    if (with_house) scenario.buildings.push_back({.x_m = 40, .y_m = 0});
    const auto world = MakeWorld(scenario);
    BsmSender sender(*world, 0, 4);
    int count = 0;
    for (int i = 0; i < 500; ++i) count += sender.Next() ? 1 : 0;
    return count / 500.0;
  };
  EXPECT_GT(received(100, false), 0.97);
  EXPECT_NEAR(received(350, false), 0.5, 0.08);
  EXPECT_LT(received(600, false), 0.05);
  EXPECT_LT(received(180, true), 0.7);
  EXPECT_GT(received(180, false), 0.93);
}

TEST(BsmSender, ErrorsHaveTheConfiguredSize) {
  Scenario scenario = OneSender();
  scenario.bsm.gnss = {.bias_sigma_m = 1.0, .markov_sigma_m = 0.0, .white_sigma_m = 0.3};
  scenario.vehicles.clear();
  for (std::uint32_t id = 1; id <= 200; ++id) {
    AddVehicle(scenario, id, 50.0, 5.0 * id - 500.0, 0.0);
    scenario.vehicles.back().v2v = true;
  }
  scenario.radio.half_range_m = 1e4;
  const auto world = MakeWorld(scenario);
  const auto plane = PlaneOf(scenario.origin);
  double bias = 0.0, white = 0.0;
  int pairs = 0;
  for (int i = 0; i < 200; ++i) {
    BsmSender sender(*world, i, 4);
    const auto a = sender.Next();
    const auto b = sender.Next();
    if (!a || !b) continue;
    Vec2 errors[2];
    for (int k = 0; k < 2; ++k) {
      const bsm_t& bsm = k == 0 ? *a : *b;
      double x = 0.0, y = 0.0, z = 0.0;
      plane.Forward(bsm.lat * 1e-7, bsm.long_ * 1e-7, bsm.elev * 0.1, x, y, z);
      errors[k] =
          Vec2(x, y) - world->actors()[static_cast<std::size_t>(i)].trajectory.At(0.0).centre;
    }
    bias += (0.5 * (errors[0] + errors[1])).squaredNorm() / 2.0;
    white += (errors[0] - errors[1]).squaredNorm() / 4.0;
    ++pairs;
  }
  ASSERT_GT(pairs, 150);
  EXPECT_NEAR(std::sqrt(white / pairs), 0.3, 0.04);
  EXPECT_NEAR(std::sqrt(bias / pairs), std::sqrt(1.0 + 0.5 * 0.09), 0.1);
}

// Conditions (BsmSpec, RadioSpec): each does what its key says, on a car without other errors.
std::vector<bsm_t> Heard(Scenario scenario, int messages) {
  scenario.radio.half_range_m = 1e4;
  const auto world = MakeWorld(scenario);
  BsmSender sender(*world, 0, 9);
  std::vector<bsm_t> heard;
  for (int i = 0; i < messages; ++i) {
    if (const auto bsm = sender.Next()) heard.push_back(*bsm);
  }
  return heard;
}

TEST(BsmSender, PairsComeFiftyMillisecondsApartAndCountOn) {
  Scenario scenario = OneSender();
  scenario.bsm.pair_share = 0.3;
  scenario.bsm.latency_spread_s = 0.0;
  scenario.bsm.period_jitter_s = 0.0;
  const auto heard = Heard(scenario, 500);
  int pairs = 0;
  for (std::size_t i = 1; i < heard.size(); ++i) {
    const auto apart = heard[i].rx_utime - heard[i - 1].rx_utime;
    EXPECT_TRUE(std::abs(apart - 50000) <= 2 || std::abs(apart - 100000) <= 2) << apart;
    EXPECT_EQ(heard[i].msgCnt, (heard[i - 1].msgCnt + 1) % 128);
    const bool is_second = apart < 60000;
    pairs += is_second ? 1 : 0;
  }
  // A pair is two gaps of 50 ms: 0.3 / 1.3 of the messages are seconds.
  EXPECT_NEAR(pairs / 500.0, 2.0 * 0.3 / 1.3, 0.12);
}

TEST(BsmSender, SilencesAreAsLongAsGivenAtMost) {
  Scenario scenario = OneSender();
  scenario.radio.gap_every_s = 5.0;
  scenario.radio.gap_max_s = 4.0;
  scenario.bsm.latency_spread_s = 0.0;
  const auto heard = Heard(scenario, 3000);
  std::int64_t longest = 0;
  for (std::size_t i = 1; i < heard.size(); ++i) {
    longest = std::max(longest, heard[i].rx_utime - heard[i - 1].rx_utime);
  }
  EXPECT_GT(longest, 1500000);
  EXPECT_LT(longest, 4200000);
  EXPECT_LT(heard.size(), 2900u);  // Mean silence 4 m / 5 of u^4: 0.8 s in 5.8 s.
  EXPECT_GT(heard.size(), 2200u);
}

TEST(BsmSender, ErrorBurstsHaveTheirSizeAndMayBeReported) {
  Scenario scenario = OneSender();
  scenario.bsm.bursts = {.every_s = 10.0, .lasts_s = 5.0, .low_m = 3.0, .high_m = 8.0};
  scenario.bsm.semi_major_m = 0.5;
  const auto world = MakeWorld(scenario);
  BsmSender sender(*world, 0, 9);
  double largest = 0.0;
  int off = 0;
  for (int i = 0; i < 3000; ++i) {
    const auto message = sender.NextMessage();
    ASSERT_TRUE(message.has_value());
    const double error = message->error.norm();
    largest = std::max(largest, error);
    off += error > 2.9 ? 1 : 0;
    EXPECT_NEAR(message->said.semi_major_m, std::hypot(0.5, error), 1e-9);
  }
  EXPECT_GT(largest, 6.0);
  EXPECT_LE(largest, 8.0);
  EXPECT_NEAR(off / 3000.0, 5.0 / 16.0, 0.12);  // 5 s in 10 s and 6 s.
}

TEST(BsmSender, LongVehiclesTellOfThePointTheyAreToldTo) {
  Scenario scenario = OneSender();
  scenario.bsm.long_reference_m = 6.0;
  scenario.vehicles[0].length_m = 18.0;
  const auto world = MakeWorld(scenario);
  BsmSender sender(*world, 0, 9);
  const auto message = sender.NextMessage();
  ASSERT_TRUE(message.has_value());
  const Motion motion = world->actors()[0].trajectory.At(message->time_s);
  EXPECT_NEAR((message->said.centre - motion.centre - 6.0 * Direction(motion.yaw_rad)).norm(), 0.0,
              1e-9);
}

TEST(BsmSender, SparseMessagesSayWhatJ2735SaysForUnavailable) {
  Scenario scenario = OneSender();
  scenario.bsm.sparse = true;
  const auto heard = Heard(scenario, 5);
  ASSERT_FALSE(heard.empty());
  EXPECT_EQ(heard[0].elev, -4096);
  EXPECT_EQ(heard[0].semiMajor, 255);
  EXPECT_EQ(heard[0].accelSet_long, 2001);
  EXPECT_EQ(heard[0].length, 0);
  EXPECT_EQ(heard[0].wheelBrakes, 16);
  EXPECT_LT(heard[0].speed, 8191);  // What nobody can do without stays.
}

TEST(BsmSender, ALeapSecondCountsOnBeyondSixtyThousand) {
  Scenario scenario = OneSender();
  scenario.start_utc_s = 1781510440;  // 20 s before a minute.
  scenario.bsm.leap_second_at_s = 20.0;
  scenario.bsm.latency_spread_s = 0.0;
  int leap = 0;
  for (const bsm_t& bsm : Heard(scenario, 300)) {
    const auto position_utime = bsm.rx_utime - 70000;
    const double into = 1e-6 * static_cast<double>(position_utime) - 1781510460.0;
    if (into >= 0.001 && into < 0.999) {
      ++leap;
      EXPECT_NEAR(bsm.secMark, 60000.0 + 1000.0 * into, 1.0);
    } else {
      EXPECT_LT(bsm.secMark, 60001);
    }
  }
  EXPECT_NEAR(leap, 10, 1);
}

}  // namespace
}  // namespace v2vouch::sim
