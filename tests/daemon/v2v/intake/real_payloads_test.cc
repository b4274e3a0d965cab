// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "daemon/v2v/intake/bsm_checks.h"
#include "tests/daemon/v2v/intake/talking_car.h"
#include "tests/support/data_folder.h"

namespace v2vouch {
namespace {

std::optional<double> Value(const nlohmann::json& si, const char* key, double factor = 1.0) {
  if (si.at(key).is_null()) return std::nullopt;
  return si.at(key).get<double>() * factor;
}

// A published payload's decoded values, received 0.2 s after its secMark.
Bsm FromPayload(const nlohmann::json& vector) {
  const nlohmann::json& si = vector.at("si");
  const nlohmann::json& core = vector.at("core");
  constexpr double kDegree = kPi / 180.0;
  Bsm bsm;
  bsm.sender = static_cast<SenderId>(std::stoul(core.at("id").get<std::string>(), nullptr, 16));
  bsm.msg_count = core.at("msgCnt").get<int>();
  if (const auto t = Value(si, "t_in_minute_s", 1000.0)) {
    bsm.sec_mark_ms = static_cast<int>(std::lround(*t));
  }
  bsm.stamp = FromMicros(kNoon_us + bsm.sec_mark_ms.value_or(0) * std::int64_t{1000} + 200'000);
  bsm.latitude_rad = Value(si, "lat_deg", kDegree);
  bsm.longitude_rad = Value(si, "lon_deg", kDegree);
  bsm.elevation_m = Value(si, "elev_m");
  bsm.semi_major_m = Value(si, "semi_major_m");
  bsm.speed_mps = Value(si, "speed_mps");
  if (const auto heading = Value(si, "heading_deg", kDegree)) {
    bsm.course_rad = WrapAngle(kPi / 2.0 - *heading);
  }
  bsm.accel_long_mps2 = Value(si, "accel_long_mps2");
  bsm.accel_lat_mps2 = Value(si, "accel_lat_mps2");
  if (const auto rate = Value(si, "yaw_rate_dps", kDegree)) bsm.yaw_rate_radps = -*rate;
  bsm.length_m = Value(si, "length_m");
  bsm.width_m = Value(si, "width_m");
  const std::string gear = core.at("transmission").get<std::string>();
  bsm.transmission = gear == "reverseGears"   ? Transmission::kReverse
                     : gear == "forwardGears" ? Transmission::kForward
                                              : Transmission::kUnavailable;
  return bsm;
}

TEST(RealPayloads, EveryOneIsJudgedByItsContent) {
  std::ifstream file(DataFolder() / "j2735_bsm_vectors.json");
  if (!file) {
    GTEST_SKIP() << "SKIPPED: no J2735 payloads in " << DataFolder();
  }
  const nlohmann::json data = nlohmann::json::parse(file);
  int taken = 0;
  int without_course = 0;
  int in_reverse = 0;
  for (const auto& vector : data.at("vectors")) {
    const Bsm bsm = FromPayload(vector);
    const bool is_usable = bsm.latitude_rad && bsm.longitude_rad && bsm.speed_mps;
    EgoPlace ego;
    ego.is_known = true;
    if (is_usable) {  // 50 m beside it.
      const Wgs84 place{*bsm.latitude_rad, *bsm.longitude_rad, bsm.elevation_m.value_or(0.0)};
      ego.p_E = LocalPlane(place).ToEcefPoint(LocalPoint{{30.0, 40.0, 0.0}}).p_E;
    }
    BsmIntake intake{IntakeConfig{.repeat_memory_s = 1.0}};
    const auto claim = intake.Accept(bsm, ego);
    const int n = vector.at("n").get<int>();
    if (!is_usable) {
      EXPECT_EQ(WhyNot(claim), Reason::kBsmUnavailable) << n;
      continue;
    }
    const bool is_violent = std::abs(bsm.accel_long_mps2.value_or(0.0)) > 12.0 ||
                            std::abs(bsm.accel_lat_mps2.value_or(0.0)) > 9.0 ||
                            *bsm.speed_mps > 70.0;
    ASSERT_EQ(WhyNot(claim), is_violent ? Reason::kBsmImplausible : kTaken) << n;
    if (is_violent) continue;
    ++taken;
    EXPECT_NEAR(claim->age_s, 0.2, 1e-6) << n;
    EXPECT_NEAR(HorizontalDistance(ego.p_E, claim->p_E), 50.0, 1e-3) << n;
    EXPECT_EQ(claim->has_course, bsm.course_rad.has_value());
    without_course += claim->has_course ? 0 : 1;
    EXPECT_EQ(claim->accuracy_is_poor, bsm.semi_major_m.value_or(0.0) > 6.0) << n;
    if (bsm.transmission == Transmission::kReverse) {
      ++in_reverse;
      EXPECT_LE(claim->speed_mps, 0.0) << n;
    }
    EXPECT_GE(claim->position_sigma_m, 0.5);
    EXPECT_LE(claim->position_sigma_m, 3.0);
    EXPECT_EQ(intake.senders().size(), 1U);
  }
  std::cout << taken << " taken, " << without_course << " of them without course\n";
  EXPECT_GT(taken, 150);  // Of 167 published payloads; none lacks place or speed.
  EXPECT_GT(without_course, 20);
  EXPECT_GT(in_reverse, 0);
}

}  // namespace
}  // namespace v2vouch
