// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/intake/bsm_checks.h"

#include <gtest/gtest.h>

#include "tests/daemon/v2v/intake/talking_car.h"

namespace v2vouch {
namespace {

Bsm ReceivedAt(double seconds_after_noon, std::optional<int> sec_mark_ms) {
  Bsm bsm = TalkingCar{}.Say();
  bsm.stamp = FromMicros(kNoon_us) + FromSeconds(seconds_after_noon);
  bsm.sec_mark_ms = sec_mark_ms;
  return bsm;
}

TEST(ContentProblem, AnHonestMessageHasNone) {
  EXPECT_EQ(ContentProblem(TalkingCar{}.Say()), std::nullopt);
}

TEST(ContentProblem, NamesWhatIsMissingOrCannotBe) {
  const auto problem = [](auto spoil) {
    Bsm bsm = TalkingCar{}.Say();
    spoil(bsm);
    return ContentProblem(bsm);
  };
  EXPECT_EQ(problem([](Bsm& b) { b.signature = SignatureState::kInvalid; }), Reason::kBsmSignature);
  EXPECT_EQ(problem([](Bsm& b) { b.signature = SignatureState::kValid; }), std::nullopt);
  EXPECT_EQ(problem([](Bsm& b) { b.latitude_rad.reset(); }), Reason::kBsmUnavailable);
  EXPECT_EQ(problem([](Bsm& b) { b.longitude_rad.reset(); }), Reason::kBsmUnavailable);
  EXPECT_EQ(problem([](Bsm& b) { b.speed_mps.reset(); }), Reason::kBsmUnavailable);
  EXPECT_EQ(problem([](Bsm& b) { b.course_rad.reset(); }), std::nullopt);
  EXPECT_EQ(problem([](Bsm& b) { b.elevation_m.reset(); }), std::nullopt);
  EXPECT_EQ(problem([](Bsm& b) { b.latitude_rad = kNaN; }), Reason::kNotFinite);
  EXPECT_EQ(problem([](Bsm& b) { b.yaw_rate_radps = INFINITY; }), Reason::kNotFinite);
  EXPECT_EQ(problem([](Bsm& b) { b.latitude_rad = 1.6; }), Reason::kBsmRange);
  EXPECT_EQ(problem([](Bsm& b) { b.speed_mps = 70.1; }), Reason::kBsmImplausible);
  EXPECT_EQ(problem([](Bsm& b) { b.speed_mps = 69.9; }), std::nullopt);
  EXPECT_EQ(problem([](Bsm& b) { b.accel_long_mps2 = -12.5; }), Reason::kBsmImplausible);
  EXPECT_EQ(problem([](Bsm& b) { b.accel_lat_mps2 = 9.5; }), Reason::kBsmImplausible);
}

TEST(ClaimedAge, ComesFromSecMark) {
  EXPECT_NEAR(ClaimedAge(ReceivedAt(12.345, 12200), {}), 0.145, 1e-9);
  EXPECT_NEAR(ClaimedAge(ReceivedAt(12.345, 12400), {}), -0.055, 1e-9);
}

TEST(ClaimedAge, CrossesTheMinuteBothWays) {
  EXPECT_NEAR(ClaimedAge(ReceivedAt(60.08, 59950), {}), 0.13, 1e-9);
  EXPECT_NEAR(ClaimedAge(ReceivedAt(59.95, 20), {}), -0.07, 1e-9);
}

TEST(ClaimedAge, TheLeapSecondSharesItsCountWithTheNextMinutesFirst) {
  EXPECT_NEAR(ClaimedAge(ReceivedAt(60.6, 60500), {}), 0.1, 1e-9);
  EXPECT_NEAR(ClaimedAge(ReceivedAt(61.1, 60999), {}), 0.101, 1e-9);
}

// Signed 30 ms before reception, of a place 110 ms older.
TEST(ClaimedAge, IsThatOfThePlaceNotOfTheSignature) {
  Bsm bsm = ReceivedAt(12.345, 12205);
  bsm.generation = bsm.stamp - FromSeconds(0.03);
  EXPECT_NEAR(ClaimedAge(bsm, {}), 0.14, 1e-9);
}

TEST(ClaimedAge, GenerationTimeTellsTheMinute) {
  Bsm bsm = ReceivedAt(12.3, 12200);
  bsm.generation = bsm.stamp - FromSeconds(60.03);
  EXPECT_NEAR(ClaimedAge(bsm, {}), 60.1, 1e-9);
}

TEST(ClaimedAge, WithoutSecMarkItIsThatOfTheSignature) {
  Bsm bsm = ReceivedAt(12.3, std::nullopt);
  bsm.generation = bsm.stamp - FromSeconds(0.25);
  EXPECT_NEAR(ClaimedAge(bsm, {}), 0.25, 1e-9);
}

TEST(ClaimedAge, IsTheDefaultWhereNoTimeIsTold) {
  EXPECT_EQ(ClaimedAge(ReceivedAt(12.3, std::nullopt), {}), IntakeConfig{}.default_age_s);
}

TEST(ToClaim, CarriesPlaceCourseAndSpeed) {
  TalkingCar car;
  car.yaw_rad = 0.8;
  const Claim claim = ToClaim(car.Say(), 0.1, {});
  const Eigen::Vector3d p_L = LocalPlane(kCrossroads).ToLocal(EcefPoint{claim.p_E}).p_L;
  EXPECT_LT((p_L - Eigen::Vector3d(60.0, -20.0, 0.0)).norm(), 1e-6);
  const Eigen::Vector3d course_L = LocalPlane(kCrossroads).R_LE() * claim.course_E;
  EXPECT_NEAR(std::atan2(course_L.y(), course_L.x()), 0.8, 1e-4);
  EXPECT_NEAR(course_L.norm(), 1.0, 1e-12);
  EXPECT_EQ(claim.speed_mps, 10.0);
  EXPECT_TRUE(claim.has_elevation);
  EXPECT_EQ(claim.age_s, 0.1);
  EXPECT_EQ(ToClaim(car.Say(), -0.2, {}).age_s, 0.0);
}

TEST(ToClaim, InReverseTheVehicleLooksTheOtherWay) {
  TalkingCar car;
  Bsm bsm = car.Say();
  bsm.transmission = Transmission::kReverse;
  const Claim claim = ToClaim(bsm, 0.1, {});
  const Claim forward = ToClaim(car.Say(), 0.1, {});
  EXPECT_EQ(claim.speed_mps, -10.0);
  EXPECT_LT((claim.course_E + forward.course_E).norm(), 1e-12);
  // The same motion over ground.
  EXPECT_LT((claim.speed_mps * claim.course_E - forward.speed_mps * forward.course_E).norm(), 1e-9);
}

TEST(ToClaim, AnUnknownElevationIsZeroAndMovesNothingSideways) {
  Bsm bsm = TalkingCar{}.Say();
  bsm.elevation_m.reset();
  const Claim claim = ToClaim(bsm, 0.1, {});
  EXPECT_FALSE(claim.has_elevation);
  EXPECT_NEAR(ToWgs84({claim.p_E}).height_m, 0.0, 1e-6);
  EXPECT_NEAR(HorizontalDistance(EgoAtCrossroads().p_E, claim.p_E), std::hypot(60.0, 20.0), 0.01);
}

TEST(ToClaim, ReportedAccuracyIsClampedAndNeverWidensTheGate) {
  const auto claim = [](std::optional<double> semi_major_m) {
    Bsm bsm = TalkingCar{}.Say();
    bsm.semi_major_m = semi_major_m;
    return ToClaim(bsm, 0.1, {});
  };
  EXPECT_EQ(claim(0.05).position_sigma_m, 0.5);
  EXPECT_EQ(claim(1.45).position_sigma_m, 1.45);
  EXPECT_EQ(claim(12.7).position_sigma_m, 3.0);
  EXPECT_EQ(claim(std::nullopt).position_sigma_m, 2.0);
  EXPECT_FALSE(claim(2.95).accuracy_is_poor);
  EXPECT_FALSE(claim(5.9).accuracy_is_poor);  // Phones and plain receivers: residuals show.
  EXPECT_TRUE(claim(6.1).accuracy_is_poor);
  EXPECT_TRUE(claim(9.3).accuracy_is_poor);  // Two parked cars in the real logs say so.
  EXPECT_FALSE(claim(std::nullopt).accuracy_is_poor);
}

TEST(ToClaim, AnImpossibleYawRateIsTakenForNone) {
  Bsm bsm = TalkingCar{}.Say();
  bsm.yaw_rate_radps = 0.5;
  EXPECT_EQ(ToClaim(bsm, 0.1, {}).yaw_rate_radps, 0.5);
  bsm.yaw_rate_radps = 2.1;  // 120 deg/s, as in real payloads.
  EXPECT_EQ(ToClaim(bsm, 0.1, {}).yaw_rate_radps, 0.0);
  bsm.speed_mps = 40.0;
  bsm.yaw_rate_radps = 0.5;
  EXPECT_EQ(ToClaim(bsm, 0.1, {}).yaw_rate_radps, 0.0);
}

TEST(IsOwnEcho, IsOurPlaceSpeedAndCourse) {
  EgoPlace ego = EgoAtCrossroads();
  ego.speed_mps = 10.0;
  const auto is_echo = [&ego](double east, double north, double yaw, double speed) {
    TalkingCar car;
    car.east_m = east;
    car.north_m = north;
    car.yaw_rad = yaw;
    car.speed_mps = speed;
    return IsOwnEcho(ToClaim(car.Say(), 0.3, {}), ego, {});
  };
  EXPECT_TRUE(is_echo(-3.0, 0.3, 0.05, 10.2));      // Where we were 0.3 s ago.
  EXPECT_FALSE(is_echo(-8.0, 0.0, 0.0, 10.0));      // The one behind us.
  EXPECT_FALSE(is_echo(-3.0, 3.5, 0.0, 10.0));      // The one in the next lane.
  EXPECT_FALSE(is_echo(-3.0, 0.0, 0.0, 6.0));       // Another speed.
  EXPECT_FALSE(is_echo(0.0, -3.0, kPi / 2, 10.0));  // Across.
}

}  // namespace
}  // namespace v2vouch
